"""move_until: a guarded move, which stops at a force or a torque."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goals import group_of
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.amounts import amount
from harness.core.details import Detail
from harness.core.errors import StepFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.language.base import Force, LinearVelocity, Name, PositiveLength, Torque
from harness.language.poses import Direction
from harness.plugins.contact.guarded import LOOK, STOPS_AT_CONTACT, follow_until
from harness.plugins.contact.reach import postures_of
from harness.plugins.contact.sensors import check_sensor, sensor_of
from harness.ports.motion_planning import MotionRequest
from harness.ports.motions import CartesianLimits, RelativeMotion

TOUCH = 0.1  # [N], the weight of 10 g: what `contact` notices
MISSED = {"N": ("nothing pressed the robot with", "force"), "N m": ("no torque reached", "torque")}


@dataclass(frozen=True)
class GuardedMove(Detail):
    """Where and at what force or torque a guarded move stopped.

    Attributes:
        travelled: How far the link went [m].
        noticed_force: The force at which it began to stop [N]; of a torque [N m].
        final_force: The force when it stood [N]; of a torque [N m].
        stopping_time: The time from one to the other [s].
    """

    travelled: float
    noticed_force: float
    final_force: float
    stopping_time: float


class MoveUntil(Step):
    """Move the link straight until the robot presses something: a guarded move.

    Every 4 ms the force is compared with the limit: the sum of the normal forces with which the
    robot, and what it holds, presses other bodies, as its mean over these 4 ms. With `sensor` it is
    the magnitude of the force that a sensor of force and torque reads, and with `torque` that of
    its torque; a sensor also reads the weight of what it carries, unless `tare` came before, and
    one that reads as much before the move begins fails the step. Then the arm stops along its line,
    as fast as its joints' acceleration limits times the scaling factor allow, and stays there. The
    step reports the distance, the force that it noticed and the force when it stood. It fails when
    nothing is met within `max_distance`. What it may meet `allow_collisions` has to allow.
    """

    verb: ClassVar[str] = "move_until"
    synonyms = ("guarded_move", "move_until_contact", "touch")
    simulated_only = STOPS_AT_CONTACT
    moves_arm: ClassVar[bool] = True
    one_of = ("force", "torque", "contact")
    results = (GuardedMove,)

    direction: Direction = Field(description="The link moves straight in this direction.")
    force: Annotated[Force, Field(gt=0)] | None = Field(
        default=None, description="The move stops where the robot presses with this force [N]."
    )
    torque: Annotated[Torque, Field(gt=0)] | None = Field(
        default=None, description="The move stops where a sensor reads this torque [N m]."
    )
    contact: bool | None = Field(
        default=None, description="With `true` the move stops at the first touch, of 0.1 N."
    )
    sensor: Name | None = Field(
        default=None,
        description="The sensor that reads `force` or `torque`; the default of `torque` is the only"
        " one, and `force` is then the sum of the contact forces.",
    )
    max_distance: PositiveLength = Field(
        description="The move fails when it met nothing within this distance [m]."
    )
    speed: Annotated[LinearVelocity, Field(gt=0)] = Field(
        default=0.01, description="The speed of the link [m/s]."
    )
    link: Name | None = Field(
        default=None, description="The link that moves; the default is the TCP."
    )

    def summary(self) -> str:
        return f"{self._limit:g} {self._unit} within {amount(self.max_distance, 'm')}"

    @property
    def _limit(self) -> float:
        return self.torque or self.force or TOUCH

    @property
    def _unit(self) -> str:
        return "N" if self.torque is None else "N m"

    def check(self, at: At) -> None:
        at.scope.check_group(self.group, at.key("group"))
        at.scope.check_link(self.link, at.key("link"))
        at.scope.check_frame(self.direction.frame, at.key("direction", "frame"))
        if self.contact is False:
            at.scope.problems.add(
                at.key("contact"), "a move until no contact never ends", "write `contact: true`"
            )
        if self.torque is not None or self.sensor is not None:
            check_sensor(self.sensor, at)
        self._check_force(at)
        if self.contact is not None and self.sensor is not None:
            at.scope.problems.add(
                at.key("sensor"),
                "`contact` reads no sensor",
                "write `force`, or leave out `sensor`",
            )

    def _check_force(self, at: At) -> None:
        """Report a force with which no posture of the arm can press."""
        postures = postures_of(at, self.group, self.link, self.direction.frame)
        push = np.array([*self.direction.xyz, 0.0, 0.0, 0.0]) * (self.force or 0.0)
        said = postures and postures.overload(push / np.linalg.norm(self.direction.xyz))
        if said:
            message = f"in every posture that was tried, the force {said}"
            hint = "state less, or use a stronger arm"
            at.scope.problems.add(at.key("force"), message, hint, needs=("robot",))

    def execute(self, cell: Cell) -> None:
        """Follow the line until the force is met, stop, and report where and at what force."""
        cell.sync_scene()
        group, link = group_of(cell, self.group), self.link or cell.description.tcp_link
        twist = np.zeros(6)
        twist[:3] = cell.world_direction(self.direction)
        motion = RelativeMotion(link, twist, (self.max_distance, self.max_distance))
        limits = CartesianLimits(translation_velocity=self.speed)
        options = replace(cell.current.options, cartesian_limits=limits)
        request = MotionRequest(group, cell.planning_start(), motion, options)
        start = cell.frame(link).translation
        cell.carry_out(cell.planner.plan(request), lambda plan: self._follow(plan, start, cell))

    def _follow(self, planned: JointTrajectory, start: FloatArray, cell: Cell) -> JointTrajectory:
        """Follow a trajectory until the force is met, then stop on it.

        Returns:
            The trajectory that was commanded, up to the stop.

        Raises:
            StepFailed: CONTROL_FAILED; the force was not met, or read before anything moved.
        """
        if (self.sensor or self.torque) and (before := self._read(cell)) >= self._limit:
            reads = f"the sensor reads {before:.2g} {self._unit} before the move begins"
            raise StepFailed("CONTROL_FAILED", f"{reads}: `tare` it, or state more")
        forces: list[float] = []

        def notices() -> bool:
            forces.append(self._read(cell))
            return forces[-1] >= self._limit

        stopped = follow_until(planned, cell, notices)
        if stopped is None:
            met, kind = MISSED[self._unit]
            raise StepFailed(
                "CONTROL_FAILED",
                f"{met} {self._limit:g} {self._unit} within {1e3 * self.max_distance:g} mm; the"
                f" largest {kind} was {max(forces):.2g} {self._unit}",
            )
        followed, braking = stopped
        link = self.link or cell.description.tcp_link
        travelled = float(np.linalg.norm(cell.frame(link).translation - start))
        cell.report(GuardedMove(travelled, forces[-1], self._read(cell), braking))
        return followed

    def _read(self, cell: Cell) -> float:
        """The force [N] or torque [N m] now."""
        if self.torque is None and self.sensor is None:
            return cell.simulator.force_on_robot(LOOK, cell.held_objects)[0]
        wrench = cell.simulator.wrench(sensor_of(cell.robot, self.sensor).name, LOOK)
        return float(np.linalg.norm(wrench[:3] if self.torque is None else wrench[3:]))
