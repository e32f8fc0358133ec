"""Names of a robot's controllers on the ROS 2 graph."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import ClassVar

from harness.cell.program_part import ProgramPart
from harness.cell.scope import Problems, Scope
from harness.language.scenario import ScenarioContent
from harness.plugins.ros.keys.ros2 import ControllerKeys, Ros2Names
from harness.robot.description import RobotDescription

OWNERS = {"arm_controllers": "the arm's", "gripper_controller": "the gripper's"}


@dataclass(frozen=True)
class ArmControllers:
    """The names under which nodes reach the controllers of one arm.

    Attributes:
        arm: Names of the arm's trajectory controller, which all lead to the same one; empty without
            an arm.
        gripper: The name of the gripper's controller; empty without a gripper.
    """

    arm: tuple[str, ...] = ()
    gripper: str = ""


@dataclass(frozen=True)
class ControllerNames:
    """The names under which nodes reach the robot.

    Attributes:
        by_arm: Those of the controllers of each arm, by its name; of a robot with one arm under "".
        prefix: What nodes put before the names of joints and links.
    """

    by_arm: Mapping[str, ArmControllers] = field(default_factory=lambda: MappingProxyType({}))
    prefix: str = ""


class Controllers(ProgramPart):
    """The names under which nodes of ROS 2 reach the controllers of each arm."""

    name: ClassVar[str] = "controllers"

    def resolve(self, scenario: ScenarioContent, scope: Scope) -> ControllerNames:
        """The scenario's names, else the robot's, else `<group>_controller` as MoveIt's assistant.

        Every controller needs a name of its own.
        """
        robot, problems = scope.description, scope.problems
        names = scenario.ros2 if isinstance(scenario.ros2, Ros2Names) else Ros2Names()
        given = _given_names(robot, names, problems)
        by_arm = {
            arm: _of_arm(each, given.get(arm, ControllerKeys()))
            for arm, each in (robot.of_arm or {"": robot}).items()
        }
        _refuse_clash(by_arm, given, problems)
        return ControllerNames(by_arm, names.prefix or "")


def _given_names(
    description: RobotDescription, names: Ros2Names, problems: Problems
) -> Mapping[str, ControllerKeys]:
    """The scenario's names of controllers by arm; reports arms that the robot does not have."""
    arms = description.of_arm
    if not arms:
        if names.arms:
            problems.add(
                ("ros2", "arms"),
                "the robot has one arm, and `arms` names the controllers of several",
                "`arm_controllers` and `gripper_controller` stand under `ros2` itself",
                needs=("robot",),
            )
        return {"": names}
    for key in ("arm_controllers", "gripper_controller"):
        if getattr(names, key) is not None:
            problems.add(
                ("ros2", key),
                f"the robot has several arms: {', '.join(arms)}; this does not say which",
                f"`arms: {{{next(iter(arms))}: {{{key}: ...}}}}` names the controllers of one",
                needs=("robot",),
            )
    for arm in names.arms.keys() - arms.keys():
        problems.unknown(("ros2", "arms", arm), "arm", arm, arms, is_key=True, needs=("robot",))
    return names.arms


def _of_arm(robot: RobotDescription, given: ControllerKeys) -> ArmControllers:
    """The names of the controllers of the selected arm."""
    own = robot.controller_names
    arm = (given.arm_controllers or own["arm"]) if "arm" in own else ()
    gripper = (given.gripper_controller or own["gripper"][0]) if "gripper" in own else ""
    return ArmControllers(arm, gripper)


def _refuse_clash(
    by_arm: Mapping[str, ArmControllers], given: Mapping[str, ControllerKeys], problems: Problems
) -> None:
    """Report two controllers of one name, where the file states the name."""
    uses: dict[str, list[tuple[str, str]]] = {}
    for arm, each in by_arm.items():
        for name in dict.fromkeys(each.arm):
            uses.setdefault(name, []).append((arm, "arm_controllers"))
        if each.gripper:
            uses.setdefault(each.gripper, []).append((arm, "gripper_controller"))
    for name, places in uses.items():
        if len(places) > 1:
            stated = [
                ("ros2", "arms", arm, key) if arm else ("ros2", key)
                for arm, key in places
                if arm in given and getattr(given[arm], key) is not None
            ]
            first, *others = (
                OWNERS[key] + " controller" * (not number) + (f" ({arm})" if arm else "")
                for number, (arm, key) in enumerate(places)
            )
            problems.add(
                stated[0] if stated else ("robots" if "" not in by_arm else "robot",),
                f"'{name}' is a name of {first} and of {' and of '.join(others)}",
                "every controller needs a name of its own: state them under `ros2`",
                needs=("robot",),
            )
