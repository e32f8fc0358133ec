"""Applies a scenario's options to a robot: joint limits, states and start state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.core.errors import RobotOptionError
from harness.core.suggestion import did_you_mean
from harness.language.scenario import JointLimits, RobotSpec, StartState
from harness.robot.description import NamedState, RobotDescription
from harness.robot.mechanism import Joint
from harness.robot.srdf.srdf import parse_srdf, write_srdf
from harness.robot.urdf.write import write_urdf
from harness.robot.wrench_sensors import with_wrench_sensors


def with_options(description: RobotDescription, spec: RobotSpec) -> RobotDescription:
    """The robot with a scenario's joint limits, named states, start state, friction and solver.

    Raises:
        RobotError: An option refers to an unknown name, or exceeds the robot's limits.
    """
    joints = description.joints
    if spec.joint_limits:
        for name in spec.joint_limits:
            _movable(description, name, "joint_limits")
        joints = tuple(
            _narrowed(joint, spec.joint_limits[joint.name])
            if joint.name in spec.joint_limits
            else joint
            for joint in joints
        )
        urdf = write_urdf(description.name, description.links, joints)
        description = replace(description, joints=joints, urdf=urdf)
    if spec.named_states:
        states = _with_states(description, spec)
        srdf = replace(parse_srdf(description.srdf, description.name), states=states)
        text = write_srdf(description.name, srdf)
        description = replace(description, named_states=states, srdf=text)
    if spec.start_state is not None:
        start = {**description.start_state, **_start(description, spec.start_state)}
        description = replace(description, start_state=start)
    if spec.friction is not None:
        if description.gripper is None:
            raise RobotOptionError("friction", f"'{description.name}' has no gripper with pads")
        gripper = replace(description.gripper, friction=spec.friction)
        description = replace(description, gripper=gripper)
    if spec.ik_solver is not None:
        description = replace(description, ik_solver=spec.ik_solver)
    if spec.joint_controller is not None:
        description = replace(description, joint_controller=spec.joint_controller)
    if spec.wrench_sensors:
        description = with_wrench_sensors(description, spec.wrench_sensors)
    for name, position in description.start_state.items():
        _within(description, name, position, "start_state")
    return description


def _movable(description: RobotDescription, name: str, where: str) -> Joint:
    if name not in description.joint_index:
        hint = did_you_mean(name, description.joint_names, "joints")
        raise RobotOptionError(
            where,
            f"'{description.name}' has no joint '{name}'; {hint}",
        )
    return description.joint_by_name[name]


def _within(description: RobotDescription, name: str, position: float, where: str) -> None:
    joint = _movable(description, name, where)
    if not joint.lower <= position <= joint.upper:
        raise RobotOptionError(
            where,
            f"joint '{name}' at {position:.6g} is outside its limits "
            f"[{joint.lower:.6g}, {joint.upper:.6g}]",
        )


def _narrowed(joint: Joint, limits: JointLimits) -> Joint:
    """A joint with tighter limits; those that its file lacks may have any value."""
    widest_velocity = np.inf if joint.is_velocity_assumed else joint.velocity
    for key, value, widest in (
        ("max_position", limits.max_position, joint.upper),
        ("max_velocity", limits.max_velocity, widest_velocity),
        ("max_effort", limits.max_effort, joint.effort),
    ):
        if value is not None and value > widest:
            larger = ", and its file has the `effort` to correct" if key == "max_effort" else ""
            raise RobotOptionError(
                f"joint_limits.{joint.name}.{key}",
                f"{value:.6g} is more than the robot's {widest:.6g}; limits can be narrowed only"
                f"{larger}",
            )
    if limits.min_position is not None and limits.min_position < joint.lower:
        raise RobotOptionError(
            f"joint_limits.{joint.name}.min_position",
            f"{limits.min_position:.6g} is less than "
            f"the robot's {joint.lower:.6g}; limits can be narrowed only",
        )
    lower = joint.lower if limits.min_position is None else limits.min_position
    upper = joint.upper if limits.max_position is None else limits.max_position
    if lower >= upper:
        raise RobotOptionError(
            f"joint_limits.{joint.name}", f"nothing is between {lower} and {upper}"
        )
    bounded = joint.kind == "continuous" and np.isfinite([lower, upper]).all()
    return replace(
        joint,
        kind="revolute" if bounded else joint.kind,
        lower=lower,
        upper=upper,
        velocity=limits.max_velocity or joint.velocity,
        is_velocity_assumed=joint.is_velocity_assumed and limits.max_velocity is None,
        acceleration=limits.max_acceleration or joint.acceleration,
        effort=limits.max_effort or joint.effort,
        effort_source="the scenario" if limits.max_effort else joint.effort_source,
    )


def _with_states(description: RobotDescription, spec: RobotSpec) -> tuple[NamedState, ...]:
    """The robot's states and the scenario's, which replace those of the same name."""
    states = {(state.group, state.name): state for state in description.named_states}
    for group, named in spec.named_states.items():
        if group not in description.groups:
            raise RobotOptionError(
                "named_states",
                f"'{description.name}' has no group '{group}'; "
                f"groups: {', '.join(description.groups)}",
            )
        for name, positions in named.items():
            where = f"named_states.{group}.{name}"
            for joint, position in positions.items():
                _within(description, joint, position, where)
            hand = description.gripper
            if hand is not None and hand.group == group and hand.joint not in positions:
                raise RobotOptionError(where, f"it does not place '{hand.joint}' of the gripper")
            states[group, name] = NamedState(name, group, dict(positions))
    return tuple(states.values())


def _start(description: RobotDescription, start: StartState) -> dict[str, float]:
    positions: dict[str, float] = {}
    if start.named_target is not None:
        found = [s for s in description.named_states if s.name == start.named_target]
        if not found:
            names = ", ".join(state.name for state in description.named_states)
            raise RobotOptionError(
                "start_state",
                f"'{description.name}' has no state '{start.named_target}'; states: {names}",
            )
        preferred = [state for state in found if state.group == description.arm_group]
        positions |= (preferred or found)[0].positions
    return positions | dict(start.joints or {})
