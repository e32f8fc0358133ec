"""All fourteen types of Universal Robots with the gripper: to `up`, then something picked up."""

import pytest

from tests.robot.models import UR_TYPES, Arm, robot
from tests.session.front_door import failures, run

FEW = ("ur3", "ur8long", "ur30")
UP = {"shoulder_lift_joint": -1.5707, "wrist_1_joint": -1.5707}

STEPS = """
    - {{move_to: up, id: up, expect: [named_target: up]}}
    - gripper: open
    - move_to: {{pose: {{frame: base_link, xyz: [{x}, {y}, {above}], quat_xyzw: {down}}}}}
    - lin: {{pose: {{frame: base_link, xyz: [{x}, {y}, {hold}], quat_xyzw: {down}}}}}
    - grasp: {{object: part, position: 0.59}}
    - move_relative: {{direction: {{frame: world, xyz: [0, 0, 1]}}, distance: 0.1}}
      id: lift
      expect: [grasped: {{object: part}}]
    - {{move_to: up, expect: [named_target: up]}}
"""
REST = """
objects:
  - name: post
    static: true
    pose: {{xyz: [{x}, {y}, {half}]}}
    box: {{size: [0.06, 0.06, {height}]}}
  - name: part
    pose: {{xyz: [{x}, {y}, {z}]}}
    mass: 0.1
    cylinder: {{radius: 0.03, length: 0.1}}
expect:
  - lifted: {{object: part, above: 5 cm, for: 0.5 s}}
  - always: within_limits
  - never: collision
"""


def smoke(folder, model):
    """What becomes of picking a part off a post at half the arm's reach."""
    height = Arm(robot(model=model)).pose("tool0", UP).translation[2]
    top = round(0.15 * height, 3)
    words = {
        "x": round(-0.25 * height, 3), "y": round(-0.3 * height, 3), "z": top + 0.05,
        "hold": top + 0.085,
        "above": top + 0.2, "half": top / 2, "height": top, "down": "[0.924, -0.383, 0, 0]",
    }  # fmt: skip
    chosen = f"{{model: {model}, gripper: rh_p12_rn_a}}"
    return run(folder, STEPS.format(**words), robot=chosen, rest=REST.format(**words))


def check(folder, model):
    result, saved = smoke(folder, model)
    assert result.outcome == "passed", [
        *failures(result), *(step.message for step in result.steps if step.message),
    ]  # fmt: skip
    assert saved.robot.name == f"{model} + rh_p12_rn_a"


@pytest.mark.nightly
@pytest.mark.parametrize("model", FEW)
def test_an_arm_of_universal_robots_reaches_up_and_picks(tmp_path, model):
    check(tmp_path, model)


@pytest.mark.nightly
@pytest.mark.parametrize("model", [name for name in UR_TYPES if name not in FEW])
def test_every_other_arm_of_universal_robots_does_too(tmp_path, model):
    check(tmp_path, model)
