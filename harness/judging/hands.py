"""The grippers of a robot with several arms: one after the other, and all of them."""

from __future__ import annotations

from dataclasses import replace

from harness.judging.window import NotObservable
from harness.recording.run import Run
from harness.robot.description import RobotDescription
from harness.robot.end_effector import Gripper


def of_arm(run: Run, arm: str) -> Run:
    """The run with an arm of the robot selected; the run itself for an empty name.

    Raises:
        NotObservable: The robot has no such arm.
    """
    if not arm:
        return run
    if arm not in run.robot.of_arm:
        raise NotObservable(f"the robot has no arm '{arm}'")
    return replace(run, robot=run.robot.of_arm[arm])


def each_hand(run: Run) -> tuple[Run, ...]:
    """The run with each arm selected that has a gripper; of one arm the run, if it has one."""
    robot = run.robot
    if robot.needs_arm:
        return tuple(of_arm(run, arm.name) for arm in robot.arms if arm.gripper is not None)
    return () if robot.gripper is None else (run,)


def own_links(robot: RobotDescription) -> frozenset[str]:
    """The links that the selected arm moves; all links of a robot where none is selected."""
    if not robot.selected_arm:
        return frozenset(robot.link_names)
    arm, found = set(robot.group_joints(robot.arm_group)), set[str]()
    for joint in robot.joints:  # parents before children
        if joint.name in arm or joint.parent in found:
            found.add(joint.child)
    return frozenset(found)


def gripper_of(run: Run) -> Gripper:
    """The gripper of the selected arm.

    Raises:
        NotObservable: It has none.
    """
    if run.robot.gripper is None:
        raise NotObservable("the robot has no gripper")
    return run.robot.gripper


def finger_links(gripper: Gripper) -> frozenset[str]:
    """Links of all finger sides."""
    return frozenset(gripper.links)


def hand_links(gripper: Gripper) -> frozenset[str]:
    """Links of all finger sides, and the palm."""
    return finger_links(gripper) | ({gripper.palm_link} - {""})


def every_hand_link(run: Run) -> frozenset[str]:
    """Links of all finger sides, and the palms, of every gripper."""
    return frozenset[str]().union(*(hand_links(gripper_of(hand)) for hand in each_hand(run)))
