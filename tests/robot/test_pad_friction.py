"""The friction of a gripper's pads: of <gazebo> in its URDF, or of the scenario."""

import pytest

from harness.core.errors import RobotError
from harness.simulation.robot_mjcf import link_friction
from tests.robot.arm_files import load_arm, write_arm
from tests.robot.hands import GROUP, HAND, write
from tests.session.front_door import problems, run

SURFACE = '<gazebo reference="{}">{}</gazebo>'


def with_surfaces(folder, *surfaces):
    """The arm with a hand, with `<gazebo>` elements."""
    text = "".join(SURFACE.format(*each) for each in surfaces)
    write(folder, hand=HAND + text)
    return load_arm(folder)


@pytest.mark.parametrize(
    ("surfaces", "expected"),
    [
        ([], 1.0),
        ([("left", "<mu1>0.2</mu1>"), ("right", "<mu1>0.2</mu1>")], 0.2),
        ([("left", "<mu1>15</mu1><mu2>12</mu2>"), ("right", "<mu1>15</mu1>")], 12.0),
        ([("left", "<mu1>15</mu1>")], 1.0),
        ([("left", '<mu1 value="0.3"/>'), ("right", "<mu2>0.4</mu2>")], 0.3),
        ([("left", "<mu1>${mu}</mu1>"), ("right", "<mu1>-1</mu1>")], 1.0),
        ([("upper", "<mu1>0.1</mu1>")], 1.0),
        ([("left", "<material>Gazebo/Red</material>")], 1.0),
    ],
)
def test_the_pads_have_the_smaller_friction_of_gazebo(tmp_path, surfaces, expected):
    arm = with_surfaces(tmp_path, *surfaces)
    assert arm.gripper.friction == expected
    assert link_friction(arm, "left").sliding == link_friction(arm, "right").sliding == expected


def test_the_friction_of_the_pads_is_in_the_notes(tmp_path):
    arm = with_surfaces(tmp_path, ("left", "<mu1>0.2</mu1>"), ("right", "<mu1>0.3</mu1>"))
    assert "gripper 'hand': its pads have the friction 0.2 of the file" in arm.notes


def test_the_note_on_ignored_elements_names_what_is_read(tmp_path):
    arm = with_surfaces(tmp_path, ("left", "<mu1>1</mu1>"), ("upper", "<gravity>0</gravity>"))
    assert "2 <gazebo> elements ignored, except mu1 and mu2 of a gripper's pads" in arm.notes


def test_the_scenario_states_another_friction(tmp_path):
    with_surfaces(tmp_path, ("left", "<mu1>0.2</mu1>"))
    assert load_arm(tmp_path, friction=0.7).gripper.friction == 0.7


def test_an_arm_without_a_gripper_has_no_pads(tmp_path):
    write_arm(tmp_path)
    with pytest.raises(RobotError, match="has no gripper with pads"):
        load_arm(tmp_path, friction=0.7)


def test_a_friction_below_zero_is_a_mistake(tmp_path):
    robot = "{model: open_manipulator_x, friction: -1}"
    [(_, message)] = problems(tmp_path, "- wait: 0.1", robot=robot)
    assert "0" in message


STEPS = """
    - gripper: open
    - move_to: {joints: {turn: 0, bend: 0, reach: 0.11}}
    - gripper: close
    - move_to: {joints: {reach: 0.02}}
"""


@pytest.mark.nightly
@pytest.mark.parametrize(("friction", "outcome"), [(0.001, "failed"), (1.0, "passed")])
def test_an_object_slips_out_of_slick_pads(tmp_path, friction, outcome):
    write(tmp_path, group=GROUP)
    base = "base: {xyz: [0, 0, 1], rpy: [180 deg, 0, 0]}"
    rest = """
        objects:
          - name: block
            pose: {xyz: [0, 0, 0.13]}
            box: {size: [0.03, 0.03, 0.06]}
            mass: 0.05
          - {name: stand, static: true, pose: {xyz: [0, 0, 0.05]}, box: {size: [0.1, 0.1, 0.1]}}
        expect:
          - lifted: {object: block, above: 2 cm}
    """
    robot = f"{{urdf: arm.urdf, srdf: arm.srdf, friction: {friction}, {base}}}"
    result, _ = run(tmp_path, STEPS, robot=robot, rest=rest)
    assert result.outcome == outcome
