"""Cartesian impedance control: the joints' torques make a link yield like springs and dampers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.core.pose_arrays import rotation_vector
from harness.core.spatial import SE3, quat_wxyz_from_rotation
from harness.core.types import BoolArray, FloatArray
from harness.ports.joint_control import ControlRequest, ControlResult, JointController

CYCLE = 0.001  # [s], between two torques; the interfaces of torque-controlled arms have this one
HOLDING = 40.0
"""Natural frequency with which axes hold that no number is given for [rad/s]: on a UR5e 10 to 20
N/mm along an axis. A tenth of what the cycle allows."""

FASTEST = 0.3 / CYCLE  # [rad/s]: a spring is stable below 2 / CYCLE; this keeps a margin
FREE_SPEED, FREE_TURN = 0.02, 0.2
"""Speed at which an axis moves under its stated force while it meets nothing [m/s, rad/s]."""

LEAST_WRENCH = 1.0  # [N, N m], for which the damping of an axis without force is chosen
RANK = 1e-3  # share of the largest singular value of a Jacobian below which a motion is impossible


@dataclass(frozen=True, eq=False)
class Compliance:
    """How a link yields, by the six axes of a frame.

    Attributes:
        link: The link that yields, about its origin.
        stiffness: Stiffness [N/m, N m/rad], NaN where none is given, shape (6,).
        damping: Damping [N s/m, N m s/rad], NaN where none is given, shape (6,).
        wrench: Force and torque of the link on others, NaN of axes without, shape (6,) [N, N m].
        rotation: R_world_frame of a frame that stands; None: the frame is that of `frame_link`.
        frame_link: The link in whose axes the numbers are, where it is commanded to be.
        load: Mass of what the link carries besides the robot [kg], and its place in the link [m].
    """

    link: str
    stiffness: FloatArray
    damping: FloatArray
    wrench: FloatArray
    rotation: FloatArray | None = None
    frame_link: str = ""
    load: tuple[float, FloatArray] = (0.0, np.zeros(3))

    @property
    def is_free(self) -> BoolArray:
        """Axes with a stated wrench, which ignore the commanded path, shape (6,)."""
        return ~np.isnan(self.wrench)


class CartesianCompliance(JointController):
    """Torques that give a link the stiffness, damping and wrench of a `Compliance`.

    tau = inverse dynamics + J^T (K e + D de/dt + w): e is the deviation of the link from where it
    is commanded, as a translation and a rotation vector in the axes of the frame [1]. Axes with a
    stated wrench have no spring and ignore the commanded motion. What joints can do besides (the
    elbow of seven joints) is held by springs in joint space that exert no force on the link.

    References:
        [1] N. Hogan, "Impedance Control: An Approach to Manipulation", ASME J. DSMC 107, 1985.
    """

    period: ClassVar[float | None] = CYCLE
    is_compliant: ClassVar[bool] = True

    def __init__(self, compliance: Compliance) -> None:
        self._compliance, self.link = compliance, compliance.link
        self._wrench = np.nan_to_num(compliance.wrench)
        self._bound = np.where(compliance.is_free, 0.0, 1.0)
        self._standing = None if compliance.rotation is None else _turn(compliance.rotation)
        self._gains: tuple[FloatArray, FloatArray] | None = None
        self._inertia = np.zeros(0)  # of each joint by itself, at the beginning
        self.deviation = np.zeros(6)
        self.effort_share, self.joint = 0.0, ""

    def control(self, request: ControlRequest) -> ControlResult:
        """Torques of the arm's joints for the next cycle."""
        link = self._compliance.link
        at, to = (
            request.link_motion(link, positions)
            for positions in (request.positions, request.set_positions[0])
        )
        turn = self._frame(request)
        jacobian = turn.T @ at.jacobian
        stiffness, damping = self._gains or self._design(request, jacobian)
        error = turn.T @ _deviation(at.pose, to.pose)
        left, sizes, right = np.linalg.svd(jacobian, full_matrices=False)
        rank = int((sizes > RANK * sizes[0]).sum())
        inverse = (right[:rank].T / sizes[:rank]) @ left[:, :rank].T
        commanded = self._bound * (jacobian @ request.set_velocities[0])
        speed = commanded - jacobian @ request.velocities
        force = stiffness @ error + damping @ speed + self._wrench
        efforts = self._dynamics(request, jacobian, inverse) + jacobian.T @ force
        if rank < len(efforts):
            efforts += self._posture(request, right[:rank])
        if self._compliance.load[0] > 0:
            efforts -= at.jacobian.T @ self._weight(at.pose, request.gravity)
        self._note(request, efforts, error)
        return ControlResult(efforts)

    def _frame(self, request: ControlRequest) -> FloatArray:
        """The axes of the frame in the world, for forces and torques, shape (6, 6)."""
        if self._standing is not None:
            return self._standing
        frame = self._compliance.frame_link
        return _turn(request.link_motion(frame, request.set_positions[0]).pose.rotation)

    def _design(
        self, request: ControlRequest, jacobian: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Stiffness and damping for the inertia that the link has now, shape (6, 6) each.

        Springs are damped critically in the modes that they have with this inertia [1].

        References:
            [1] A. Albu-Schäffer, C. Ott, U. Frese, G. Hirzinger, "Cartesian Impedance Control of
                Redundant Robots: Recent Results with the DLR-Light-Weight-Arms", ICRA 2003.
        """
        law, inertia = self._compliance, request.inertia()
        self._inertia = np.diag(inertia)
        mobility = jacobian @ np.linalg.solve(inertia, jacobian.T)
        values, vectors = np.linalg.eigh(mobility)
        moves = values > RANK**2 * values[-1]
        vectors, roots = vectors[:, moves], np.sqrt(values[moves])
        root = vectors * roots @ vectors.T  # of the mobility; its inverse is that of the inertia
        inverse = vectors / roots @ vectors.T
        holds = np.isnan(law.stiffness) & ~law.is_free
        stiffness = np.where(np.outer(holds, holds), HOLDING**2 * inverse @ inverse, 0.0)
        stiffness += np.diag(np.nan_to_num(law.stiffness))
        squares, modes = np.linalg.eigh(root @ stiffness @ root)
        damped = inverse @ modes
        damping = 2.0 * damped * np.sqrt(np.maximum(squares, 0.0)) @ damped.T
        slow = np.repeat([FREE_SPEED, FREE_TURN], 3)
        stated = np.maximum(np.abs(np.nan_to_num(law.wrench)), LEAST_WRENCH) / slow
        stated = np.minimum(stated, 1.0 / CYCLE / np.maximum(np.diag(mobility), 1e-12))
        stated = np.where(law.is_free & np.isnan(law.damping), stated, law.damping)
        own = ~np.isnan(stated)
        damping[own] = damping[:, own] = 0.0
        damping += np.diag(np.nan_to_num(stated))
        self._gains = stiffness, damping
        return self._gains

    def _dynamics(
        self, request: ControlRequest, jacobian: FloatArray, inverse: FloatArray
    ) -> FloatArray:
        """Torques of gravity and of the commanded motion, without that of free axes, shape (m,)."""
        velocities, accelerations = request.set_velocities[0], request.set_accelerations[0]
        if not self._bound.all() and (velocities.any() or accelerations.any()):
            free = 1.0 - self._bound
            velocities = velocities - inverse @ (free * (jacobian @ velocities))
            accelerations = accelerations - inverse @ (free * (jacobian @ accelerations))
        rows = (request.positions, velocities, accelerations)
        return request.inverse_dynamics(*(row[None] for row in rows))[0]

    def _posture(self, request: ControlRequest, moving: FloatArray) -> FloatArray:
        """Torques that hold what joints can do without moving the link, shape (m,).

        Args:
            moving: Orthonormal motions of the joints that move the link, shape (rank, m).
        """
        error = request.set_positions[0] - request.positions
        speed = request.set_velocities[0] - request.velocities
        torques = self._inertia * HOLDING * (HOLDING * error + 2 * speed)
        return torques - moving.T @ (moving @ torques)

    def _weight(self, pose: SE3, gravity: FloatArray) -> FloatArray:
        """The weight of what the link carries, about its origin, in world axes, shape (6,)."""
        mass, place = self._compliance.load
        weight = mass * gravity
        return np.concatenate([weight, np.cross(pose.rotation @ place, weight)])

    def _note(self, request: ControlRequest, efforts: FloatArray, error: FloatArray) -> None:
        """Keep the largest deviation and the largest share of an effort limit."""
        self.deviation = np.maximum(self.deviation, np.abs(error))
        shares = np.abs(efforts) / request.effort_limits
        if shares.max(initial=0.0) > self.effort_share:
            self.effort_share = float(shares.max())
            self.joint = request.joint_names[int(shares.argmax())]


def _turn(rotation: FloatArray) -> FloatArray:
    """A rotation of forces and torques alike, shape (6, 6)."""
    turn = np.zeros((6, 6))
    turn[:3, :3] = turn[3:, 3:] = rotation
    return turn


def _deviation(at: SE3, to: SE3) -> FloatArray:
    """From a pose to another: translation and rotation vector in the world, shape (6,)."""
    turn = to.rotation @ at.rotation.T
    vector = np.array(
        [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
    )  # twice the sine of the angle, along the axis
    sine, cosine = math.sqrt(vector @ vector), turn[0, 0] + turn[1, 1] + turn[2, 2] - 1
    if cosine > 0:
        vector *= math.atan2(sine, cosine) / sine if sine > 1e-9 else 0.5
    else:  # more than a quarter of a turn; the sine vanishes at half a turn
        vector = rotation_vector(quat_wxyz_from_rotation(turn))
    return np.concatenate([to.translation - at.translation, vector])
