"""Motions at full speed keep the acceleration limits at every commanded sample."""

import pytest

from tests.session.front_door import run

REST = """
planning: {max_velocity_scaling_factor: 1.0, max_acceleration_scaling_factor: 1.0}
expect:
  - always: {within_limits: {acceleration: true}}
"""


@pytest.mark.nightly(but=["line"])
@pytest.mark.parametrize(
    "steps",
    [
        "- move_to: {joints: {shoulder_pan_joint: 0.7, elbow_joint: 1.2, wrist_2_joint: 0.4}}",
        "- {ptp: {joints: {shoulder_pan_joint: 0.03, wrist_3_joint: -0.5}}}",
        "- {move_relative: {direction: {xyz: [0, 0, 1]}, distance: 0.1}}",
    ],
    ids=["move_to", "ptp", "line"],
)
def test_every_command_keeps_the_acceleration_limits(tmp_path, steps):
    robot = "{model: ur3e, start_state: test_configuration, base: {xyz: [0, 0, 1]}}"
    result, _ = run(tmp_path, steps, robot=robot, rest=REST)
    assert result.outcome == "passed", [
        *(step.message for step in result.steps),
        *(verdict.reason for verdict in result.verdicts),
    ]
