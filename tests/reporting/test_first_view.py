"""What the first view of a replay holds."""

import numpy as np
import pytest

from harness.recording.read_run import read_run
from harness.reporting.html.first_view import OUTSIDE, Framing, decisive_time
from harness.reporting.html.packing import Packer
from harness.reporting.html.paths import explained_points, pack_plan
from harness.reporting.html.scene import pack_scene

TEXT = """\
scenario: a goal that fails
robot: open_manipulator_x
steps:
  - move_to: {{position: {{xyz: {xyz}, frame: link1}}}}
"""


@pytest.fixture
def views(recorded_run):
    def view(xyz):
        run = read_run(recorded_run(TEXT.format(xyz=xyz), outcome="failed") / "run").run
        explained = explained_points([pack_plan(run, run.steps[0], 0, Packer())])
        framings = (Framing(), Framing((), explained))
        views = [pack_scene(run, (), Packer(), framing)["focus"] for framing in framings]
        return np.array(explained), *(np.array(focus["points"]) for focus in views), views[0]["arm"]

    return view


def reach(points, directions):
    """How far points go in each direction."""
    return (points @ directions.T).max(axis=0)


def test_the_state_and_the_goal_that_explain_a_failure_are_held(views):
    explained, before, after, _ = views("[0.1, 0.2, -0.15]")
    around = np.random.default_rng(3).normal(size=(200, 3))
    assert len(explained) > 5
    assert (reach(explained, around) - reach(before, around)).max() > 0.05, "they are elsewhere"
    assert (reach(after, around) >= reach(before, around) - 0.03).all()
    assert (reach(after, around) >= reach(explained, around) - 0.03).all()


def test_a_goal_far_out_of_reach_does_not_make_the_arm_small(views):
    explained, before, after, arm = views("[40, 0, 0.1]")
    assert explained[:, 0].max() > 39
    assert after[:, 0].max() > before[:, 0].max()
    assert np.ptp(after, axis=0).max() < (1 + OUTSIDE) * arm + 0.05


RAISED = """\
scenario: a goal that fails far from where the arm began
robot: open_manipulator_x
steps:
  - move_to: {{joints: {{joint1: {turn}, joint2: 0.3, joint3: 0, joint4: 0}}}}
  - wait: 0.1 s
expect:
  - duration: {{at_most: 0.1 s}}
"""


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize("turn", ["90 deg", "-120 deg"])
def test_a_failed_run_opens_on_the_arm_at_that_moment(recorded_run, turn):
    stored = read_run(recorded_run(RAISED.format(turn=turn), outcome="failed") / "run")
    window = decisive_time(stored)
    packed = pack_scene(stored.run, (), Packer(), Framing((), (), window))
    opening, whole = np.array(packed["opening"]), np.array(packed["focus"]["points"])
    at = np.searchsorted(stored.run.signals.times, window[1])
    tcp = stored.run.signals.tcp_pose[at, :3]
    assert np.linalg.norm(opening - tcp, axis=1).min() < 0.1
    assert np.ptp(opening, axis=0).prod() < 0.6 * np.ptp(whole, axis=0).prod()


def test_a_run_that_passed_opens_on_all_of_it(recorded_run):
    stored = read_run(
        recorded_run("scenario: a wait\nrobot: ur3e\nsteps: [{wait: 0.1 s}]\n") / "run"
    )
    assert decisive_time(stored) is None
    assert "opening" not in pack_scene(stored.run, (), Packer(), Framing())
