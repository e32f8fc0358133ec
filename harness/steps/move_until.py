"""move_until: a guarded move, which stops at a force."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goals import group_of
from harness.cell.scope import At
from harness.core.details import Detail
from harness.core.errors import StepFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.language.base import Force, LinearVelocity, Name, PositiveLength
from harness.language.poses import Direction
from harness.language.step import Step
from harness.ports.motion_planning import MotionRequest
from harness.ports.motions import CartesianLimits, RelativeMotion

LOOK = 0.004
"""Time between two looks at the force, which is its mean over that time [s].

Controllers of force sensors have cycles of 2 to 10 ms. Physics steps of 1, 2 and 4 ms divide it.
"""
GRID = 0.001  # [s], to which the time of braking is rounded up: a step of the physics
TOUCH = 0.1  # [N], the weight of 10 g: what `contact` notices


@dataclass(frozen=True)
class GuardedMove(Detail):
    """Where and at what force a guarded move stopped.

    Attributes:
        travelled: How far the link went [m].
        noticed_force: The force at which it began to stop [N].
        final_force: The force when it stood [N].
        stopping_time: The time from one to the other [s].
    """

    travelled: float
    noticed_force: float
    final_force: float
    stopping_time: float


class MoveUntil(Step):
    """Move the link straight until the robot presses something: a guarded move.

    Every 4 ms the force is compared with the limit: the sum of the normal forces with which the
    robot, and what it holds, presses other bodies, as its mean over these 4 ms. Then the arm stops
    along its line, as fast as its joints' acceleration limits times the scaling factor allow, and
    stays there. The step reports the distance, the force that it noticed and the force when it
    stood. It fails when nothing is met within `max_distance`. What it may meet has to be allowed,
    by `allow_collisions` around it.
    """

    verb: ClassVar[str] = "move_until"
    synonyms = ("guarded_move", "move_until_contact", "touch")
    moves_arm: ClassVar[bool] = True
    one_of = ("force", "contact")
    results = (GuardedMove,)

    direction: Direction = Field(description="The link moves straight in this direction.")
    force: Annotated[Force, Field(gt=0)] | None = Field(
        default=None, description="The move stops where the robot presses with this force [N]."
    )
    contact: bool | None = Field(
        default=None, description="With `true` the move stops at the first touch, of 0.1 N."
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
        return f"{self._limit:g} N within {self.max_distance:g} m"

    @property
    def _limit(self) -> float:
        return TOUCH if self.force is None else self.force

    def check(self, at: At) -> None:
        at.scope.check_group(self.group, at.key("group"))
        at.scope.check_link(self.link, at.key("link"))
        at.scope.check_frame(self.direction.frame, at.key("direction", "frame"))
        if self.contact is False:
            at.scope.problems.add(
                at.key("contact"), "a move until no contact never ends", "write `contact: true`"
            )

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
            StepFailed: CONTROL_FAILED; the force was not met.
        """
        strongest = 0.0
        for begin, end in _looks(planned.duration):
            cell.simulator.track(_part(planned, np.array([begin, end])))
            force = cell.simulator.force_on_robot(LOOK, cell.held_objects)
            strongest = max(strongest, force)
            if force >= self._limit:
                break
        else:
            raise StepFailed(
                "CONTROL_FAILED",
                f"nothing pressed the robot with {self._limit:g} N within"
                f" {1e3 * self.max_distance:g} mm; the largest force was {strongest:.2g} N",
            )
        stop = _braking(planned, end, cell)
        if stop.duration > 0:
            cell.simulator.track(stop)
        link = self.link or cell.description.tcp_link
        travelled = float(np.linalg.norm(cell.frame(link).translation - start))
        after = cell.simulator.force_on_robot(LOOK, cell.held_objects)
        cell.report(GuardedMove(travelled, force, after, stop.duration))
        followed = _part(planned, np.append(np.arange(0.0, end, LOOK), end))
        return _joined(followed, stop) if stop.duration > 0 else followed


def _looks(duration: float) -> Iterator[tuple[float, float]]:
    """The times from one look to the next [s]."""
    count = max(1, int(np.ceil(duration / LOOK - 1e-9)))
    for look in range(count):
        yield look * LOOK, min((look + 1) * LOOK, duration)


def _braking(planned: JointTrajectory, begin: float, cell: Cell) -> JointTrajectory:
    """The rest of a trajectory from a moment on, in which its speed falls evenly to zero.

    Its duration T is the least one in which no joint decelerates beyond its limit; the arm gets
    T / 2 further on the trajectory, or to its end where that is nearer.
    """
    description, scaling = cell.description, cell.current.options.acceleration_scaling
    speeds = np.abs(_part(planned, np.array([begin])).velocities[0])
    most = np.array([description.joint_by_name[name].acceleration for name in planned.joint_names])
    time = float((speeds / (scaling * most)).max())
    time = GRID * max(1.0, np.ceil(time / GRID))
    if begin + time / 2 > planned.duration:
        rest = planned.duration - begin
        return _part(planned, begin + np.linspace(0.0, rest, 2 if rest == 0 else 20))
    after = np.linspace(0.0, time, 20)
    path = _part(planned, begin + after - after**2 / (2 * time))
    slower = (1 - after / time)[:, None]
    return replace(path, times=after, velocities=path.velocities * slower)


def _part(planned: JointTrajectory, times: FloatArray) -> JointTrajectory:
    """The points of a trajectory's cubic splines at times, the first of them at time zero."""
    knots = planned.times
    segment = np.clip(np.searchsorted(knots, times, side="right") - 1, 0, len(knots) - 2)
    length = (knots[segment + 1] - knots[segment])[:, None]
    s = (times - knots[segment])[:, None] / length
    start, end = planned.positions[segment], planned.positions[segment + 1]
    out, into = length * planned.velocities[segment], length * planned.velocities[segment + 1]
    square, cube = 3.0 * (end - start) - 2.0 * out - into, out + into - 2.0 * (end - start)
    return JointTrajectory(
        planned.joint_names,
        times - times[0],
        start + s * (out + s * (square + s * cube)),
        (out + s * (2.0 * square + 3.0 * s * cube)) / length,
        (2.0 * square + 6.0 * s * cube) / length**2,
    )


def _joined(first: JointTrajectory, second: JointTrajectory) -> JointTrajectory:
    return JointTrajectory(
        first.joint_names,
        np.append(first.times, first.times[-1] + second.times[1:]),
        np.concatenate([first.positions, second.positions[1:]]),
        np.concatenate([first.velocities, second.velocities[1:]]),
        np.concatenate([first.accelerations, second.accelerations[1:]]),
    )
