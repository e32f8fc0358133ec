"""Drives motors as the robot's joint controller says, those of grippers by their own servos."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from functools import cache

import mujoco
import numpy as np

from harness.core.errors import StepFailed
from harness.core.registry import described, raised, registry
from harness.core.types import FloatArray
from harness.ports.joint_control import ControlRequest, ControlResult, JointController, LinkMotion
from harness.simulation.model import PhysicsModel
from harness.simulation.robot_mjcf import coupling
from harness.simulation.servo import FeedForward
from harness.simulation.set_points import SetPoints


class JointDrive:
    """The inputs of the motors for set points of all actuated joints, m in number.

    A motor's effort is `gain * (input - position) - damping * velocity` where its servo has a
    stiffness, which is the gain; without one it is `input - damping * velocity`.

    Attributes:
        position_share: 1 for a motor whose servo has a stiffness, else 0, shape (m,).
        arm: Indices of the joints that it moves among the actuated ones: all but grippers'.
    """

    def __init__(
        self,
        physics: PhysicsModel,
        data: mujoco.MjData,
        gravity: tuple[float, float, float],
        timestep: float,
    ) -> None:
        description = physics.description
        self._physics, self._data, self._timestep = physics, data, timestep
        self._gravity = np.array(gravity)
        self._feed_forward = FeedForward(description, physics.servos, gravity)
        self._coupling = coupling(description)
        self._offsets = description.with_mimics(np.zeros(len(description.joint_names)))
        names = [description.joint_names[place] for place in physics.actuated]
        hands = {gripper.joint for gripper in description.grippers}
        self._actuated, self._arms = names, set(names) - hands
        kind = registry(JointController.plugin_kind).find(description.joint_controller)
        self._stiffness = physics.servos.stiffness.copy()
        self._damping = physics.servos.damping.copy()
        self.position_share = np.ones(len(names))
        self._own: JointController = kind()
        self.use(None)

    def use(self, controller: JointController | None) -> None:
        """Let a controller move the arm's joints from now on; None: the robot's own."""
        self.controller = controller or self._own
        self._select()
        if self.cycle is not None:
            self._set_servos(ControlResult(np.zeros(len(self.arm))))

    def _select(self) -> None:
        """Find the joints of the controller; in a cell those of other robots keep their servos."""
        robot, own = self._physics.description, set(self._arms)
        name = robot.arm_of_link.get(self.controller.link, "") if robot.is_cell else ""
        if name and self._own.period is None:
            own &= {joint for arm in robot.arms if arm.name == name for joint in arm.robot_joints}
        is_own = np.array([joint in own for joint in self._actuated], dtype=bool)
        self.arm, self._hand = np.flatnonzero(is_own), np.flatnonzero(~is_own)
        self._joint_names = tuple(joint for joint in self._actuated if joint in own)

    @property
    def cycle(self) -> int | None:
        """Physics steps between two calls of the controller; None: it needs no measurement."""
        period = self.controller.period if len(self.arm) else None
        return None if period is None else max(1, round(period / self._timestep))

    def whole_positions(self, positions: FloatArray) -> FloatArray:
        """Positions of every movable joint for those of the actuated ones, shape (n,)."""
        return self._coupling @ positions + self._offsets

    def weight(self, positions: FloatArray) -> FloatArray:
        """Efforts that hold the robot still at positions of every movable joint, shape (m,)."""
        still = np.zeros((1, len(positions)))
        return self._feed_forward(positions[None], still, still)[0]

    def inputs(self, points: SetPoints, noise: FloatArray | None = None) -> FloatArray:
        """Inputs of the motors at set points, shape (N + 1, m).

        Args:
            noise: The noise of the measured positions now, shape (m,).

        Raises:
            StepFailed: CONTROL_FAILED; the controller raised an error, or its answer is unusable.
        """

        @cache  # once, and only where they are requested
        def efforts() -> FloatArray:
            return self._efforts(points.positions, points.velocities, points.accelerations)

        if len(self.arm):
            answer = self._answer(self._request(points, efforts, noise), len(points))
            self._set_servos(answer)
            whole = np.zeros_like(points.positions)
            whole[:, self.arm] = answer.efforts
            if len(self._hand):
                whole[:, self._hand] = efforts()[:, self._hand]
        else:
            whole = efforts()
        gain = np.where(self._stiffness > 0, self._stiffness, 1.0)
        lead = self._damping / gain
        return self.position_share * points.positions + lead * points.velocities + whole / gain

    def restore(self, controller: JointController) -> None:
        """Go on with a copy of a controller; the model's servos have been restored already."""
        self.controller = deepcopy(controller)
        self._select()
        model, arm = self._physics.model, self.arm
        self._stiffness[arm] = -model.actuator_biasprm[arm, 1]
        self._damping[arm] = -model.actuator_biasprm[arm, 2]
        self.position_share = np.where(self._stiffness > 0, 1.0, 0.0)

    def _efforts(
        self, positions: FloatArray, velocities: FloatArray, accelerations: FloatArray
    ) -> FloatArray:
        """Efforts of the actuated joints at positions and so on of theirs, shape (N, m)."""
        return self._feed_forward(
            positions @ self._coupling.T + self._offsets,
            velocities @ self._coupling.T,
            accelerations @ self._coupling.T,
        )

    def _request(
        self, points: SetPoints, efforts: Callable[[], FloatArray], noise: FloatArray | None
    ) -> ControlRequest:
        arm, physics = self.arm, self._physics
        measured = self._data.qpos[physics.qpos][physics.actuated]
        speeds = self._data.qvel[physics.dof][physics.actuated]
        seen = measured if noise is None else measured + noise

        def inverse_dynamics(*rows: FloatArray) -> FloatArray:
            whole = [np.zeros((len(each), len(measured))) for each in rows]
            whole[0][:] = measured
            for full, given in zip(whole, rows, strict=True):
                full[:, arm] = given
            return self._efforts(*whole)[:, arm]

        def whole_positions(positions: FloatArray) -> FloatArray:
            actuated = measured.copy()
            actuated[arm] = positions
            return self.whole_positions(actuated)

        def inertia() -> FloatArray:
            dense = self._feed_forward.inertia(whole_positions(measured[arm]))
            return dense[np.ix_(arm, arm)]

        def link_motion(link: str, positions: FloatArray) -> LinkMotion:
            found = self._feed_forward.link_motion(link, whole_positions(positions))
            return replace(found, jacobian=found.jacobian[:, arm])

        return ControlRequest(
            joint_names=self._joint_names,
            time=float(self._data.time),
            timestep=self._timestep,
            positions=seen[arm],
            velocities=speeds[arm],
            set_positions=points.positions[:, arm],
            set_velocities=points.velocities[:, arm],
            set_accelerations=points.accelerations[:, arm],
            stiffness=physics.servos.stiffness[arm],
            damping=physics.servos.damping[arm],
            effort_limits=physics.servos.effort[arm],
            feed_forward=lambda: efforts()[:, arm],
            inverse_dynamics=inverse_dynamics,
            link_motion=link_motion,
            inertia=inertia,
            gravity=self._gravity,
        )

    def _answer(self, request: ControlRequest, rows: int) -> ControlResult:
        """The answer of the controller, with arrays of the right shapes."""
        name = self.controller.name
        who = (
            described(JointController.plugin_kind, name) if name else type(self.controller).__name__
        )
        try:
            found = self.controller.control(request)
            answer = _shaped(found, rows, len(request.joint_names))
        except StepFailed:
            raise
        except Exception as error:
            raise StepFailed("CONTROL_FAILED", f"{who} failed: {raised(error)}") from error
        for name, values in vars(answer).items():
            if values is None:
                continue
            if not np.isfinite(values).all() or (name != "efforts" and np.less(values, 0).any()):
                if not np.isfinite(request.set_positions).all():
                    return answer
                message = f"{who} returned {name} that are no finite numbers, or negative"
                raise StepFailed("CONTROL_FAILED", message)
        return answer

    def _set_servos(self, answer: ControlResult) -> None:
        """Give the motors of the arm the stiffness and damping of an answer."""
        none = np.zeros(len(self.arm))
        stiffness = none if answer.stiffness is None else answer.stiffness
        damping = none if answer.damping is None else answer.damping
        arm = self.arm
        known = self._stiffness[arm], self._damping[arm]
        if np.array_equal(known[0], stiffness) and np.array_equal(known[1], damping):
            return
        self._stiffness[arm], self._damping[arm] = stiffness, damping
        self.position_share = np.where(self._stiffness > 0, 1.0, 0.0)
        model = self._physics.model
        model.actuator_gainprm[arm, 0] = np.where(stiffness > 0, stiffness, 1.0)
        model.actuator_biasprm[arm, 1] = -stiffness
        model.actuator_biasprm[arm, 2] = -damping


def _shaped(answer: ControlResult, rows: int, joints: int) -> ControlResult:
    """An answer with one row of efforts for each set point, and a number for each joint."""
    return ControlResult(
        np.broadcast_to(np.asarray(answer.efforts, dtype=float), (rows, joints)),
        None if answer.stiffness is None else np.broadcast_to(answer.stiffness, (joints,)),
        None if answer.damping is None else np.broadcast_to(answer.damping, (joints,)),
    )
