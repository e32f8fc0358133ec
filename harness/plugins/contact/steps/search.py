"""search: the link goes round a growing spiral until it drops into a hole."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field, model_validator

from harness.cell.cell import Cell
from harness.cell.goals import group_of
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.details import Detail
from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.language.base import LinearVelocity, Name, PositiveLength
from harness.language.poses import Direction
from harness.plugins.contact.guarded import LOOK, STOPS_AT_CONTACT, follow_until
from harness.ports.motions import TimedLinkMotion

SHORTEST_RAMP = 0.1  # [s], in which the link gets to its speed along the spiral, and to rest
TURNING = 0.2  # [m/s^2], across the spiral's narrow first turns: joints of 1 rad/s^2 follow it
LONGEST = 120.0  # [s], of a search
PRESSED = 0.1  # [N] along the direction or across it; less is no contact, as of `move_until`
UNTOUCHED = 10.0  # times `drop`, by which it goes on while it has touched nothing


@dataclass(frozen=True)
class Found(Detail):
    """Where a search dropped: the offset from its centre across the direction, and how deep [m]."""

    offset: float
    drop: float


class Walls:
    """What pushed a link across the direction of its search: walls around it, or on one side."""

    def __init__(self) -> None:
        self._first: FloatArray | None = None
        self.are_around = False

    def push(self, force: FloatArray) -> None:
        """Take a force of the link [N], shape (3,); one against the first makes walls around it."""
        if self._first is None and np.linalg.norm(force) >= PRESSED:
            self._first = force / np.linalg.norm(force)
        elif self._first is not None:
            self.are_around |= bool(self._first @ force <= -PRESSED)


class Search(Step):
    """Search a hole: go round a growing spiral until the link drops.

    The link is commanded along an Archimedean spiral across the direction, while something else
    presses it: `comply` with a `wrench` along the direction, around this step. Every 4 ms its
    measured place is looked at; where it has advanced by `drop` since it began to press, it stops.
    A link that begins in the hole presses nothing that way: it is found where walls push it from
    opposite sides. The step fails where it advances otherwise, as along a side wall, and when the
    spiral has grown to `radius`. Over an edge it drops as into a hole; `inserted` expects the hole.
    """

    verb: ClassVar[str] = "search"
    synonyms = ("spiral", "spiral_search", "find_hole")
    simulated_only = STOPS_AT_CONTACT
    moves_arm: ClassVar[bool] = True
    results = (Found,)

    direction: Direction = Field(description="The direction into the hole.")
    radius: PositiveLength = Field(description="The radius of the last turn of the spiral [m].")
    pitch: PositiveLength = Field(
        description="The distance between two turns [m]; less than twice the clearance of the hole"
        " misses nothing."
    )
    speed: Annotated[LinearVelocity, Field(gt=0)] = Field(
        default=0.005, description="The speed along the spiral [m/s]."
    )
    drop: PositiveLength = Field(
        default=0.001, description="How far the link advances where it has found the hole [m]."
    )
    link: Name | None = Field(
        default=None, description="The link that moves; the default is the TCP."
    )

    @model_validator(mode="after")
    def _bounded_time(self) -> Search:
        if self.pitch > self.radius:
            raise ValueError("the `pitch` is more than the `radius`: there is no whole turn")
        if self._duration > LONGEST:
            raise ValueError(
                f"the spiral takes {self._duration:.0f} s, at most {LONGEST:g} s are searched: use"
                " a smaller `radius`, a larger `pitch` or a higher `speed`"
            )
        return self

    @property
    def _length(self) -> float:
        """The length of the spiral, pi r^2 / pitch [m]."""
        return math.pi * self.radius**2 / self.pitch

    @property
    def _duration(self) -> float:
        return self._length / self.speed + self._ramp

    @property
    def _ramp(self) -> float:
        """The time to the full speed, which it has where that turns with `TURNING` [s]."""
        radius = self.speed**2 / TURNING
        reached = 2 * math.pi * radius**2 / self.pitch / self.speed
        return min(max(reached, SHORTEST_RAMP), self._length / self.speed)

    def summary(self) -> str:
        return f"within {1e3 * self.radius:g} mm"

    def check(self, at: At) -> None:
        at.scope.check_group(self.group, at.key("group"))
        at.scope.check_link(self.link, at.key("link"))
        at.scope.check_frame(self.direction.frame, at.key("direction", "frame"))
        at.scope.take_time(self._duration, at.key("radius"))

    def execute(self, cell: Cell) -> None:
        """Follow the spiral until the link drops, and report where."""
        cell.sync_scene()
        group, link = group_of(cell, self.group), self.link or cell.description.tcp_link
        axis = cell.world_direction(self.direction)
        centre = cell.frame(link)
        motion = TimedLinkMotion(link, lambda time: self._pose(centre, axis, time), self._duration)
        plan = cell.planner.plan(cell.motion(group, motion))
        cell.carry_out(plan, lambda planned: self._follow(planned, axis, link, cell))

    def _follow(
        self, planned: JointTrajectory, axis: FloatArray, link: str, cell: Cell
    ) -> JointTrajectory:
        """Follow the spiral until the link drops.

        Returns:
            The trajectory that was commanded, up to the stop.

        Raises:
            StepFailed: CONTROL_FAILED; it did not drop from where it pressed.
        """
        begin = surface = _measured(cell, link)
        advances, forces, walls = [0.0], [0.0], Walls()

        def notices() -> bool:
            nonlocal surface
            total, push = cell.simulator.force_on_robot(LOOK, cell.held_objects)
            if math.isinf(total):  # without physics
                forces.append(total)
                return True
            force = float(push @ axis)
            walls.push(push - force * axis)
            if not is_touched():
                surface = begin if force < PRESSED else _measured(cell, link)
            forces.append(force)
            advances.append(float((_measured(cell, link) - surface) @ axis))
            enough = self.drop * (1.0 if is_touched() else UNTOUCHED)
            return advances[-1] >= enough

        def is_touched() -> bool:
            return max(forces) >= PRESSED or walls.are_around

        stopped = follow_until(planned, cell, notices)
        if stopped is None or not is_touched():
            raise StepFailed("CONTROL_FAILED", self._failure(max(advances), float(np.mean(forces))))
        way = _measured(cell, link) - begin
        offset = float(np.linalg.norm(way - (way @ axis) * axis))
        cell.report(Found(offset, float((begin + way - surface) @ axis)))
        return stopped[0]

    def _failure(self, advance: float, force: float) -> str:
        """Why the search found nothing, and what to do."""
        what = (
            f"{self.link or 'the TCP'} advanced by {1e3 * advance:.2g} mm at most within the spiral"
            f" of {1e3 * self.radius:g} mm, {1e3 * self.drop:g} mm are a hole; "
        )
        if force < PRESSED:
            return what + (
                "nothing was pressed meanwhile: put the search inside a `comply` with a `wrench`"
                " along the direction, and let it begin in contact"
            )
        return what + (
            f"it was pressed with {force:.2g} N: the hole is farther away than the `radius`, or the"
            " `pitch` is more than twice its clearance"
        )

    def _pose(self, centre: SE3, axis: FloatArray, time: float) -> SE3:
        """T_world_link at a time from the beginning [s]."""
        ramp = self._ramp
        cruise = self._duration - ramp
        begun, ended = min(time, ramp), max(time - cruise, 0.0)
        travelled = self.speed * (
            begun**2 / (2 * ramp) + max(min(time, cruise) - ramp, 0.0) + ended
            - ended**2 / (2 * ramp)
        )  # fmt: skip
        angle = math.sqrt(4 * math.pi * max(travelled, 0.0) / self.pitch)
        out = self.pitch * angle / (2 * math.pi)
        first = np.cross(axis, [1.0, 0.0, 0.0] if abs(axis[0]) < 0.9 else [0.0, 1.0, 0.0])
        first /= np.linalg.norm(first)
        second = np.cross(axis, first)
        shift = out * (math.cos(angle) * first + math.sin(angle) * second)
        return SE3(centre.rotation, centre.translation + shift)


def _measured(cell: Cell, link: str) -> FloatArray:
    """Where a link is in the world now, whatever it is commanded [m], shape (3,)."""
    return cell.kinematics.link_pose(cell.simulator.joint_positions(), link).translation
