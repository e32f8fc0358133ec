"""What goes past a body between two samples, at which contacts are looked for, has a warning."""

import pytest

from tests.session.front_door import run

THROUGH = """
- gripper: closed
- ptp: {joints: {shoulder_pan_joint: 0, shoulder_lift_joint: -0.2, elbow_joint: 0.4,
                 wrist_1_joint: -0.2, wrist_2_joint: 0, wrist_3_joint: 0}}
"""
BEAD = """
objects:
  - {name: bead, static: true, in: simulation, sphere: {radius: 0.002},
     pose: {xyz: [%s]}}
planning: {max_velocity_scaling_factor: 1, max_acceleration_scaling_factor: 1}
expect:
  - never: {in_contact: {between: [robot, bead]}}
  - never: {collision: {between: [robot, bead]}}
"""


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(("timestep", "place", "status", "warnings"), [
    (0.02, "0.7039, 0.4510, 0.8031", "passed", ["contact may be missed"]),
    (0.001, "0.7039, 0.4510, 0.8031", "failed", []),
    (0.02, "0.7039, 0.4510, 1.1", "passed", []),
])  # fmt: skip
def test_a_hand_that_goes_through_a_bead_between_two_samples(
    tmp_path, timestep, place, status, warnings
):
    (tmp_path / "coarse.yaml").write_text(f"world: coarse\nphysics: {{timestep: {timestep}}}\n")
    robot = "{model: ur18, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 0.01]}}"
    world = "{name: coarse.yaml}"
    result, _ = run(tmp_path, THROUGH, robot=robot, world=world, rest=BEAD % place)
    for verdict in result.verdicts:
        assert verdict.status == status, verdict.reason
        assert [warning.name for warning in verdict.warnings] == warnings, verdict.warnings
        assert "no collision; -" not in verdict.reason
