"""What an expectation says it reads of the record is all that its verdict depends on."""

from dataclasses import fields, replace

import numpy as np
import pytest

from harness.judging.expectations.joints import Joints
from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.tcp_pose import TcpPose
from harness.judging.expectations.upright import Upright
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.plugins.arms.expectations.named_target import NamedTarget
from harness.plugins.objects.expectations.in_contact import InContact
from harness.plugins.objects.expectations.on import On
from harness.recording.read_run import read_run
from harness.simulation.mujoco_simulator import MujocoSimulator
from tests.judging.expectations.test_clearance_of_arms import TOWARDS
from tests.running import run_case


@pytest.fixture
def run(recorded_run):
    return read_run(recorded_run(TOWARDS) / "run").run


def from_sample(run, skipped):
    """The run without its first samples."""
    count, parts = len(run.signals.times), {}
    for field in fields(run.signals):
        value = getattr(run.signals, field.name)
        if isinstance(value, np.ndarray) and len(value) == count:
            parts[field.name] = value[skipped:]
        elif isinstance(value, dict):
            parts[field.name] = {key: rows[skipped:] for key, rows in value.items()}
    steps = tuple(
        replace(s, start_index=s.start_index - skipped, end_index=s.end_index - skipped)
        for s in run.steps
        if s.start_index >= skipped
    )
    return replace(run, signals=replace(run.signals, **parts), steps=steps)


@pytest.mark.parametrize(
    "spec",
    [
        Joints(positions={"left_shoulder_pan_joint": -0.3}, tolerance=0.2),
        NamedTarget(state="up", group="right"),
        TcpPose(pose={"xyz": [0.3, 0.3, 0.1]}, by="left", position_only=True),
        Upright(object="a"),
        InContact(between=("left", "a")),
        InContact(between=("left", "a"), min_force=2.0, force_window=0.2),
        InContact(between=("a", "ground_plane"), min_force=0.01, force_window=0.0),
        On(object="a", support="ground_plane"),
        On(object="a", support="b"),
    ],
)
def test_the_verdict_of_a_late_step_needs_no_more(spec, run):
    last = run.steps[-1]
    back = spec.looks_back()
    skipped = last.start_index - 1 - int(np.ceil(back / run.signals.times[1]))
    assert skipped > 1000
    placed = [PlacedExpectation.of(spec, last.id, 1)]
    [whole] = judge(run, placed)
    [part] = judge(from_sample(run, skipped), placed)
    assert (part.status, part.reason) == (whole.status, whole.reason)
    assert part.margin == pytest.approx(whole.margin, rel=1e-9)


def test_what_may_read_everything_says_so():
    assert Lifted(object="a").looks_back() is None


@pytest.mark.parametrize("word", ["grasped", "lifted"])
def test_a_wait_for_what_needs_a_touch_reads_what_is_new_while_nothing_touches(
    word, tmp_path, monkeypatch
):
    read, finish = [], MujocoSimulator.finish
    monkeypatch.setattr(
        MujocoSimulator,
        "finish",
        lambda self, first=0: (read.append(first), finish(self, first))[1],
    )
    path = tmp_path / "wait.scenario.yaml"
    path.write_text(
        f"""
scenario: nothing touches
robot: {{model: open_manipulator_x}}
objects: [{{name: box, box: {{size: [3 cm, 3 cm, 5 cm]}}, pose: {{xyz: [0.2, 0, 0.025]}}}}]
steps:
  - wait: 0.5
  - wait: {{until: {{{word}: box}}, timeout: 0.5}}
    expect_error: TIMED_OUT
""",
        encoding="utf-8",
    )
    assert run_case(path).outcome == "passed"
    looks = read[:-1]  # the last one is of the whole run
    assert len(looks) > 10
    assert looks[0] == 0
    assert all(first > 450 for first in looks[1:]), "samples of 1 ms before the wait"
