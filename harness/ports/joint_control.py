"""Joint controllers as plug-ins: they move the arm's joints in the physics."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

from harness.core.registry import Plugin
from harness.core.spatial import SE3
from harness.core.types import FloatArray


@dataclass(frozen=True, eq=False)
class LinkMotion:
    """Where a link is at some joint positions, and how the joints move it there.

    Attributes:
        pose: The pose T_world_link of the link.
        jacobian: Its velocity by those of the joints: linear, then angular, in world axes, (6, m).
    """

    pose: SE3
    jacobian: FloatArray


@dataclass(frozen=True, eq=False)
class ControlRequest:
    """What a joint controller must follow until its next call.

    Joints are those of the robot that have a motor, without the gripper's, m in number. Set points
    have a row for each physics step, the first of them for now.

    Attributes:
        joint_names: The joints, in the order of all columns.
        time: The simulated time now [s].
        timestep: The time from one row to the next [s].
        positions: Measured joint positions [rad or m], shape (m,).
        velocities: Measured joint velocities, shape (m,).
        set_positions: Commanded positions, shape (N + 1, m).
        set_velocities: Commanded velocities, shape (N + 1, m).
        set_accelerations: Commanded accelerations, shape (N + 1, m).
        stiffness: Stiffness of a critically damped servo of this arm [N m/rad or N/m], shape (m,).
        damping: Its damping [N m s/rad or N s/m], shape (m,).
        effort_limits: The largest efforts [N m or N], shape (m,); the physics enforces them.
        feed_forward: Efforts that the set points take, of the robot without payload, (N + 1, m).
        inverse_dynamics: The same for other positions, velocities and accelerations, (k, m) each.
        link_motion: Where a link is at joint positions, shape (m,), and how the joints move it.
        inertia: The inertia of the robot without payload at the measured positions, (m, m).
        gravity: The gravitational acceleration in the world [m/s^2], shape (3,).
    """

    joint_names: tuple[str, ...]
    time: float
    timestep: float
    positions: FloatArray
    velocities: FloatArray
    set_positions: FloatArray
    set_velocities: FloatArray
    set_accelerations: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    effort_limits: FloatArray
    feed_forward: Callable[[], FloatArray]
    inverse_dynamics: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
    link_motion: Callable[[str, FloatArray], LinkMotion]
    inertia: Callable[[], FloatArray]
    gravity: FloatArray


@dataclass(frozen=True, eq=False)
class ControlResult:
    """The efforts of the motors until the next call: a constant part, and a servo around it.

    At every physics step a motor's effort is `efforts + stiffness * (set position - position) +
    damping * (set velocity - velocity)`, within the limits of its joint.

    Attributes:
        efforts: The efforts at each row of the set points, shape (N + 1, m), or at all, (m,).
        stiffness: The stiffness of the servos, shape (m,); None for none.
        damping: Their damping, shape (m,); None for none.
    """

    efforts: FloatArray
    stiffness: FloatArray | None = None
    damping: FloatArray | None = None


class JointController(Plugin, ABC):
    """A joint controller, selected by `robot: {joint_controller: NAME}`.

    It moves the joints of the arm; the gripper keeps a servo of its own. Effort limits, tolerances
    and faults apply to every controller alike. One object of the class lasts for a whole run, so it
    may have a state.

    Attributes:
        period: Simulated time between two calls [s]; None: one call for each stretch of set points,
            of a controller that needs no measurement.
        is_compliant: Whether joints may stray from their set points, which else ends a motion.
        link: The link that it moves, of a controller that moves the robot of this link alone.
    """

    link: str = ""
    plugin_kind: ClassVar[str] = "controller"
    period: ClassVar[float | None] = None
    is_compliant: ClassVar[bool] = False

    @abstractmethod
    def control(self, request: ControlRequest) -> ControlResult:
        """The efforts of the motors until the next call."""
