"""Names of a robot's controllers on the ROS 2 graph."""

from __future__ import annotations

from dataclasses import dataclass, replace

from harness.cell.scope import Problems
from harness.language.scenario import Ros2Names
from harness.robot.description import RobotDescription


@dataclass(frozen=True)
class ControllerNames:
    """The names under which nodes reach the controllers.

    Attributes:
        arm: Names of the arm's trajectory controller, which all lead to the same one; empty without
            an arm.
        gripper: The name of the gripper's controller; empty without a gripper.
        prefix: What nodes put before the names of joints and links.
    """

    arm: tuple[str, ...] = ()
    gripper: str = ""
    prefix: str = ""


def controller_names(
    description: RobotDescription, names: Ros2Names, problems: Problems
) -> ControllerNames:
    """The scenario's names, else the robot's, else `<group>_controller` as MoveIt's assistant.

    Arm and gripper need different names.
    """
    own, group, gripper = description.controllers, description.arm_group, description.gripper
    arm = names.arm_controllers or own.get("arm") or (f"{group}_controller",)
    found = ControllerNames(arm if group else (), prefix=names.prefix or "")
    if gripper is not None:
        default = next(iter(own.get("gripper", ())), f"{gripper.group}_controller")
        found = replace(found, gripper=names.gripper_controller or default)
    if found.gripper in found.arm:
        key = "arm_controllers" if names.arm_controllers else "gripper_controller"
        is_own = not (names.arm_controllers or names.gripper_controller)
        problems.add(
            ("robot",) if is_own else ("ros2", key),
            f"'{found.gripper}' is a name of the arm's controller and of the gripper's",
            "the controllers of arm and gripper need different names: say both under `ros2`",
            needs=("robot",),
        )
    return found
