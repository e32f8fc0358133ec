"""Checks a robot: limits, masses, kinematics in both libraries, self-collisions, reach, IK."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from harness.cell.approach import approach_axis
from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.planning.collision.scene import CoalScene
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.plugins.authoring import robot_findings as look_at
from harness.plugins.authoring.ik_trial import try_ik
from harness.plugins.authoring.pair_statistics import REASONS, SelfTouches, self_touches
from harness.plugins.authoring.robot_report import ArmLine, GroupLine, RobotFinding, RobotReport
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Joint
from harness.robot.random_positions import sample_robot_positions

KINEMATIC_SAMPLES = 20  # random configurations in which the libraries must agree
IK_SAMPLES = 100  # random reachable poses: a share in percent
OnProgress = Callable[[str, int, int], None]  # the check, its parts that are done, all parts
ALONG_AN_AXIS = math.cos(math.radians(5))  # least cosine of a direction with an axis


@dataclass(frozen=True, eq=False)
class Checked:
    """A robot that was checked.

    Attributes:
        report: The report for people and machines.
        touches: The links that touched at random configurations.
    """

    report: RobotReport
    touches: SelfTouches


def check_robot(
    description: RobotDescription,
    source: str,
    *,
    samples: int = 2000,
    seed: int = 0,
    propose: bool = False,
    on_progress: OnProgress = lambda *_: None,
) -> Checked:
    """Check a robot.

    Args:
        description: The description of the robot.
        source: What the report calls where it is from.
        samples: Random configurations for self-collisions and reach.
        seed: The seed of the configurations, and of numeric inverse kinematics.
        propose: Whether the report proposes pairs that need not be checked.
        on_progress: Called with the name of a long check, and how many of its parts are done.
    """
    positions = sample_robot_positions(description, samples, np.random.default_rng(seed))
    kinematics = PinocchioKinematics(description)
    touches = self_touches(
        description, positions, lambda done: on_progress("self-collisions", done, samples)
    )
    findings = tuple(_findings(description, kinematics, touches, positions, seed, on_progress))
    reported = {detail for finding in findings for detail in finding.details}
    driven = [joint for joint in description.movable_joints if joint.mimic is None]
    report = RobotReport(
        name=description.name,
        source=source,
        joints=description.movable_joints,
        followers={joint.name: _follows(joint) for joint in description.movable_joints},
        effort_sources=tuple(dict.fromkeys(j.effort_source for j in driven if j.effort_source)),
        groups=_groups(description),
        arm_group=description.arm_group,
        tcp_link=description.tcp_link,
        gripper=_gripper(description, kinematics),
        arms=tuple(
            ArmLine(name, robot.tcp_link, _gripper(robot, kinematics))
            for name, robot in description.of_arm.items()
        ),
        findings=findings,
        notes=tuple(note for note in description.notes if note not in reported),
        proposal=_proposal(touches) if propose else {},
    )
    return Checked(report, touches)


def _findings(
    description: RobotDescription,
    kinematics: PinocchioKinematics,
    touches: SelfTouches,
    positions: FloatArray,
    seed: int,
    on_progress: OnProgress,
) -> Iterator[RobotFinding]:
    yield look_at.forward_kinematics(description, kinematics, positions[:KINEMATIC_SAMPLES])
    yield look_at.masses(description)
    yield look_at.limits(description)
    yield look_at.states(description)
    for found in (look_at.sizes(description), look_at.shapes(description)):
        if found is not None:
            yield found
    yield look_at.self_collisions(touches)
    if description.arm_group and description.tcp_link:
        free = positions[touches.is_free]
        yield look_at.reach(description, kinematics, free)
        if len(free):
            try:
                some = free[:IK_SAMPLES]
                trial = try_ik(
                    kinematics, some, seed,
                    lambda done: on_progress("inverse kinematics", done, len(some)),
                )  # fmt: skip
            except PlanningFailed as error:  # joints outside the group move the TCP as well
                text = f"not tried, there are no pose goals: {error.message}"
                yield RobotFinding("inverse kinematics", text)
            else:
                yield look_at.inverse_kinematics(trial)


def _groups(description: RobotDescription) -> tuple[GroupLine, ...]:
    return tuple(
        GroupLine(
            name,
            group.joint_names,
            f"{group.base_link} to {group.tip_link}" if group.tip_link else "",
            tuple(description.states_of(name)),
        )
        for name, group in description.groups.items()
    )


def _proposal(touches: SelfTouches) -> dict[str, tuple[tuple[str, str], ...]]:
    proposed = touches.proposed()
    by_reason = {
        reason: tuple(pair for pair, other in proposed.items() if other == reason)
        for reason in REASONS
    }
    return {reason: pairs for reason, pairs in by_reason.items() if pairs}


def _follows(joint: Joint) -> str:
    if joint.mimic is None:
        return ""
    offset = f" + {joint.mimic.offset:g}" if joint.mimic.offset else ""
    return f"follows {joint.mimic.joint} times {joint.mimic.multiplier:g}{offset}"


def _gripper(description: RobotDescription, kinematics: PinocchioKinematics) -> str:
    gripper = description.gripper
    if gripper is None:
        return ""
    sides = [" and ".join(links) for links in gripper.sides.values()]
    unit = "N" if description.joint_by_name[gripper.joint].kind == "prismatic" else "N m"
    text = (
        f"{gripper.joint} closes {' against '.join(sides)},"
        f" {1e3 * gripper.widths[:, 1].max():.0f} mm apart, at most {gripper.max_effort:.4g} {unit}"
    )
    if gripper.cups:
        text = (
            f"{gripper.joint} switches {', '.join(cup.name for cup in gripper.cups)},"
            f" {len(gripper.cups)} suction cups that hold {gripper.holding_force:.1f} N"
        )
    if not description.tcp_link:
        return text
    state = description.start_positions()
    state[description.joint_index[gripper.joint]] = gripper.open_position
    opened = description.with_mimics(state)
    axis = approach_axis(description, kinematics, CoalScene(description), opened)
    return f"{text}; approaches along {_direction(axis)} of {description.tcp_link}"


def _direction(axis: FloatArray) -> str:
    """A direction as `+z`, or as the unit vector that is not along an axis."""
    unit = axis / np.linalg.norm(axis)
    largest = int(np.abs(unit).argmax())
    if abs(unit[largest]) >= ALONG_AN_AXIS:
        return f"{'+' if unit[largest] > 0 else '-'}{'xyz'[largest]}"
    return f"({', '.join(f'{value + 0.0:.2f}' for value in unit)})"
