"""What the first view of a replay holds."""

import numpy as np
import pytest

from harness.recording.read_run import read_run
from harness.reporting.html.first_view import OUTSIDE
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
        views = [pack_scene(run, (), Packer(), (), points)["focus"] for points in ((), explained)]
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
