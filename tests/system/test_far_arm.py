"""A second arm that rests far away changes nothing of what the first one does but last digits.

Motions to what the file states are equal to the bit. MuJoCo sums the speeds of a contact over all
joints of the model, and begins its solver in the same way for all that touches: where something is
gripped, last digits differ, and so do later motions to where it was measured.
"""

import numpy as np
import pytest

from harness.recording.read_run import read_run

NEAR = "open_manipulator_x, base: {xyz: [0, 0.17, 0]}"
FAR = {
    "the same robot": "open_manipulator_x, base: {xyz: [0, -3, 0]}",
    "the same robot elsewhere": "open_manipulator_x, base: {xyz: [-5, 2, 0.4]}",
    "another robot": "ur3e, gripper: rh_p12_rn_a, base: {xyz: [4, -7, 1]}",
}
SCENARIO = """\
scenario: a can from here to there
{robot}
objects:
  - {{name: can, cylinder: {{radius: 15 mm, length: 6 cm}}, mass: 0.05,
     pose: {{xyz: [0.22, 0.17, 0.03]}}}}
steps:
  - pick: can{arm}
  - move_to: {{position: {{xyz: [0.18, 0.27, 0.12]}}}}{arm}
  - place: {{object: can, pose: {{xyz: [0.2, 0.2, 0.031]}}}}{arm}
expect:
  - lifted: {{object: can, above: 5 cm{by}}}
  - placed: {{object: can, pose: {{xyz: [0.2, 0.2, 0.03]}}}}
  - never: collision
"""
STATED = {"steps[0].reach", "steps[0].approach", "steps[0].lift", "steps[1]"}


def motions(stored):
    found = {step.path: step.trajectory for step in stored.run.steps}
    return {path: motion for path, motion in found.items() if motion is not None}


@pytest.mark.nightly(but=["the same robot"])
@pytest.mark.parametrize("far", FAR)
def test_a_far_arm_that_rests_changes_last_digits_at_most(far, recorded_run):
    robots = f"robots:\n  near: {{model: {NEAR}}}\n  far: {{model: {FAR[far]}}}"
    texts = (
        SCENARIO.format(robot=f"robot: {{model: {NEAR}}}", arm="", by=""),
        SCENARIO.format(robot=robots, arm="\n    robot: near", by=", by: near"),
    )
    one, two = (read_run(recorded_run(text) / "run") for text in texts)
    alone, with_far = motions(one), motions(two)
    assert alone.keys() == with_far.keys() > STATED
    for path, first in alone.items():
        second = with_far[path]
        for part in ("times", "positions", "velocities", "accelerations"):
            values, others = getattr(first, part), getattr(second, part)
            if path in STATED:
                assert np.array_equal(values, others), (path, part)
        assert second.duration == pytest.approx(first.duration, abs=2e-3)
        assert second.positions[-1] == pytest.approx(first.positions[-1], abs=1e-3)
    for verdict, other in zip(one.verdicts, two.verdicts, strict=True):
        assert verdict.status == other.status == "passed"
        assert verdict.margin == pytest.approx(other.margin, abs=1e-3)
