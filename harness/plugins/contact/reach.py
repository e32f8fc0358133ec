"""Whether an arm can yield along axes, and press along them, in any of its postures."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from harness.cell.scope import At
from harness.core.types import BoolArray, FloatArray
from harness.robot.description import RobotDescription

if TYPE_CHECKING:
    from harness.simulation.servo import FeedForward

SAMPLES = 32  # postures that are tried besides the named ones
REST = 0.05
"""Share of a unit motion along an axis, with 1 rad counting as 1 m, that the joints may lack."""

SINGULAR, NEARLY_SINGULAR = 1e-3, 0.05
"""Shares of the largest singular value of a Jacobian. Where a motion has less than the second, an
arm is stretched or folded, and its links bear a force that its torques do not control."""


class Posture(NamedTuple):
    """A link in one posture.

    Attributes:
        jacobian: How the joints move the link, in the axes of a frame, shape (6, joints).
        rates: Acceleration along or about each axis by a unit of force or torque, shape (6,).
    """

    jacobian: FloatArray
    rates: FloatArray

    def moves(self, axes: FloatArray, least: float) -> bool:
        """Whether the joints move the link along each of some axes alone, shape (k, 6)."""
        moved = self.jacobian @ (np.linalg.pinv(self.jacobian, least) @ axes.T)
        return bool((np.linalg.norm(moved - axes.T, axis=0) < REST).all())


class Postures:
    """An arm in its named states, at its start, and in positions within its limits."""

    def __init__(
        self,
        robot: RobotDescription,
        group: str,
        link: str,
        frame: FloatArray | str,
        at: FloatArray | None = None,
    ) -> None:
        """Compute how the joints move a link.

        Args:
            robot: The description of the robot.
            group: The planning group that moves.
            link: The link that yields.
            frame: R_world_frame of the axes, or the link in whose axes motions are given.
            at: The only posture, positions of every movable joint.
        """
        indices = list(robot.group_indices(group))
        joints = [robot.movable_joints[index] for index in indices]
        self._joint_names = tuple(joint.name for joint in joints)
        self._limits = np.array([joint.effort for joint in joints])
        starts = [robot.start_positions()] if at is None else [at]
        generator = np.random.default_rng(0)
        if at is None:
            starts += [robot.start_positions(state.positions) for state in robot.named_states]
            for _ in range(SAMPLES):
                drawn = robot.start_positions()
                for index, joint in zip(indices, joints, strict=True):
                    drawn[index] = generator.uniform(max(joint.lower, -3), min(joint.upper, 3))
                starts.append(robot.with_mimics(drawn))
        actuated = [joint.name for joint in robot.movable_joints if joint.mimic is None]
        arm = [actuated.index(name) for name in self._joint_names]
        dynamics = _dynamics(robot)
        self._all = [_posture(dynamics, arm, link, frame, each) for each in starts]

    def can_yield(self, axis: int) -> bool:
        """Whether the link can move along or about one axis alone in some posture."""
        return any(each.moves(np.eye(6)[axis : axis + 1], SINGULAR) for each in self._all)

    def overload(self, wrench: FloatArray) -> str:
        """What a wrench takes in the posture that bears it best; empty within the effort limits.

        Args:
            wrench: Force and torque along and about the axes, shape (6,) [N, N m].
        """
        loads = [
            np.abs(each.jacobian.T @ wrench) / self._limits for each in self._firm(wrench != 0)
        ]
        least = min(loads, key=lambda each: float(each.max()))
        joint = self._joint_names[int(least.argmax())]
        times = f"takes {least.max():.3g} times the effort limit of a joint, '{joint}'"
        return times if least.max() > 1 else ""

    def least_rate(self, axis: int) -> float:
        """The smallest acceleration along or about an axis by a unit of force or torque."""
        return min(each.rates[axis] for each in self._firm(np.arange(6) == axis))

    def _firm(self, axes: BoolArray) -> list[Posture]:
        """The postures in which the joints control axes, shape (6,); all where there is none."""
        chosen = np.eye(6)[axes]
        return [each for each in self._all if each.moves(chosen, NEARLY_SINGULAR)] or self._all


def postures_of(at: At, group: str | None, link: str | None, frame: str) -> Postures | None:
    """The postures of what a step moves, in the axes of a frame; None where a name is wrong."""
    robot, stands = at.scope.description, at.scope.objects.get(frame)
    group, link = group or robot.default_group, link or robot.tcp_link
    if group not in robot.groups or link not in robot.link_names:
        return None
    rotation = np.eye(3) if stands is None else stands.pose.rotation
    return Postures(robot, group, link, frame if frame in robot.link_names else rotation)


@lru_cache(maxsize=4)
def _dynamics(robot: RobotDescription) -> FeedForward:
    from harness.simulation.servo import FeedForward, design_servos  # loads MuJoCo

    return FeedForward(robot, design_servos(robot, 1e-3), (0.0, 0.0, 0.0))


def _posture(
    dynamics: FeedForward,
    arm: list[int],
    link: str,
    frame: FloatArray | str,
    positions: FloatArray,
) -> Posture:
    """A link in a posture, by the joints of an arm."""
    turn = dynamics.link_motion(frame, positions).pose.rotation if isinstance(frame, str) else frame
    jacobian = np.kron(np.eye(2), turn.T) @ dynamics.link_motion(link, positions).jacobian[:, arm]
    inertia = dynamics.inertia(positions)[np.ix_(arm, arm)]
    rates = np.einsum("ij,ji->i", jacobian, np.linalg.solve(inertia, jacobian.T))
    return Posture(jacobian, rates)
