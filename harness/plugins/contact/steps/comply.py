"""comply: the arm yields like springs and dampers while nested steps run."""

from __future__ import annotations

from collections.abc import Iterator
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
from harness.core.types import FloatArray, Floats
from harness.language.base import Name
from harness.language.files.source import Loc
from harness.language.step import AnyStep, Block
from harness.plugins.contact.axes import AXES, WORDS, DampingAxes, StiffnessAxes, WrenchAxes
from harness.plugins.contact.compliance import CYCLE, FASTEST, CartesianCompliance, Compliance
from harness.plugins.contact.guarded import STOPS_AT_CONTACT
from harness.plugins.contact.reach import Postures, postures_of
from harness.robot.description import RobotDescription

Beyond = tuple[tuple[str, ...], str, str]
"""The keys of what no torque gives, why none does, and what to do about it."""


@dataclass(frozen=True)
class Yielded(Detail):
    """How far the link strayed from its commanded path, and what the joints gave.

    Attributes:
        largest_deviation: Along x, y and z of the frame [m], and about them [rad].
        effort_share: The largest share of an effort limit that was commanded; more than 1 is cut.
        joint: The joint of which it is.
    """

    largest_deviation: Floats
    effort_share: float
    joint: str


class Comply(Step):
    """Let the arm yield like springs and dampers while the nested steps run.

    The joints are controlled by their torques, every millisecond and within their effort limits.
    An axis with a `stiffness` presses with stiffness times the distance from where the link is
    commanded to be; an axis with a `wrench` presses with that force or torque, ignores the
    commanded path along it, and moves at 2 cm/s or 0.2 rad/s while it meets nothing, faster where a
    cycle of 1 ms cannot damp it to that; the other axes hold with a natural frequency of 40 rad/s.
    The weight of the robot and of what it holds is compensated. Damping is critical for the inertia
    at the beginning unless `damping` is given. While the arm yields, a joint that strays from its
    set point ends no motion. Afterwards the arm holds where it is. What it may touch has to be
    allowed, by `allow_collisions` around it.
    """

    verb: ClassVar[str] = "comply"
    plans: ClassVar[bool] = False
    synonyms = ("impedance", "compliance", "force_mode")
    simulated_only = STOPS_AT_CONTACT
    some_of = ("stiffness", "wrench")
    results = (Yielded,)

    frame: Name = Field(
        default="world",
        description="The frame of the axes: `world`, an object as it stands at the beginning, or a"
        " link of the robot, whose axes turn as it is commanded.",
    )
    link: Name | None = Field(
        default=None, description="The link that yields, about its origin; the default is the TCP."
    )
    stiffness: StiffnessAxes | None = Field(
        default=None, description="The stiffness by axis [N/m, N m/rad]."
    )
    damping: DampingAxes | None = Field(
        default=None, description="The damping by axis, instead of the critical one."
    )
    wrench: WrenchAxes | None = Field(
        default=None,
        description="The force or torque by axis with which the link presses [N, N m].",
    )
    during: Annotated[tuple[AnyStep, ...], Field(min_length=1)] = Field(
        description="The steps during which the arm yields."
    )

    @model_validator(mode="after")
    def _one_law_for_each_axis(self) -> Comply:
        pressing = set(() if self.wrench is None else self.wrench.named())
        both = [axis for axis in AXES if axis in pressing and axis in self._springs()]
        if both:
            raise ValueError(
                f"`{both[0]}` has a `stiffness` and a `wrench`: its force would depend on where it"
                " is; leave out one of them"
            )
        if not pressing and not self._springs():
            raise ValueError("no axis is named: give the `stiffness` or the `wrench` of some")
        return self

    def _springs(self) -> tuple[str, ...]:
        return () if self.stiffness is None else self.stiffness.named()

    def summary(self) -> str:
        springs = ", ".join(self._springs())
        pressing = ", ".join(() if self.wrench is None else self.wrench.named())
        parts = [f"springs {springs}" if springs else "", f"wrench {pressing}" if pressing else ""]
        return ", ".join(filter(None, parts))

    def blocks(self, loc: Loc, path: str) -> Iterator[Block]:
        yield Block(self.during, (*loc, "during"), f"{path}.during")

    def check(self, at: At) -> None:
        scope = at.scope
        scope.check_group(self.group, at.key("group"))
        scope.check_link(self.link, at.key("link"))
        scope.check_frame(self.frame, at.key("frame"))
        robot = scope.description
        postures = postures_of(at, self.group, self.link, self.frame)
        if postures is None:
            return
        link = self.link or robot.tcp_link
        for keys, message, hint in [*self._rigid(postures, robot, link)] or self._beyond(postures):
            said = f"in every posture that was tried, {message}"
            scope.problems.add(at.key(*keys), said, hint, needs=("robot",))

    def _rigid(self, postures: Postures, robot: RobotDescription, link: str) -> Iterator[Beyond]:
        """Axes along which no posture lets the link yield."""
        given = (("stiffness", self.stiffness), ("damping", self.damping), ("wrench", self.wrench))
        for key, axes in given:
            for name in () if axes is None else axes.named():
                number = AXES.index(name)
                if not postures.can_yield(number):
                    yield (
                        (key, name),
                        f"the joints of {robot.name} cannot move '{link}' {WORDS[number]} of"
                        f" '{self.frame}' alone, so that no torque of theirs makes it yield there",
                        "leave out the axis, or choose another frame",
                    )

    def _beyond(self, postures: Postures) -> Iterator[Beyond]:
        """What the joints' torques cannot give in any of some postures."""
        wrench = np.zeros(6) if self.wrench is None else np.nan_to_num(self.wrench.values())
        if said := postures.overload(wrench):
            yield ("wrench",), f"the wrench {said}", "state less, or use a stronger arm"
        laws = (
            ("stiffness", self.stiffness, FASTEST**2, ("N/m", "N m/rad")),
            ("damping", self.damping, 1.0 / CYCLE, ("N s/m", "N m s/rad")),
        )
        for key, axes, most, units in laws:
            for name in () if axes is None else axes.named():
                number, stated = AXES.index(name), getattr(axes, name)
                rate = postures.least_rate(number)
                if stated * rate > most:
                    said = f"the {key} {WORDS[number]} is {stated:.3g} {units[number > 2]}, and"
                    cycle = f"torques in a cycle of {1e3 * CYCLE:g} ms hold {most / rate:.3g}"
                    yield (key, name), f"{said} {cycle} at most", "state less"

    def execute(self, cell: Cell) -> None:
        """Control the arm by torques, run the nested steps, and hold the arm where it is.

        Raises:
            StepFailed: CONTROL_FAILED; no torques give the compliance where the arm is.
        """
        law = self._law(cell)
        frame = law.frame_link if law.rotation is None else law.rotation
        at = cell.simulator.joint_positions()
        here = Postures(cell.description, group_of(cell, self.group), law.link, frame, at)
        for _, message, hint in self._beyond(here):
            raise StepFailed("CONTROL_FAILED", f"here {message}: {hint}")
        controller = CartesianCompliance(law)
        cell.simulator.use_controller(controller)
        try:
            cell.run_children()
        finally:
            cell.simulator.use_controller(None)
        deviation = tuple(controller.deviation.tolist())
        cell.report(Yielded(deviation, controller.effort_share, controller.joint))

    def _law(self, cell: Cell) -> Compliance:
        """The compliance of the link with what is held now."""
        robot = cell.description
        link = self.link or robot.tcp_link
        none = np.full(6, np.nan)
        is_link = self.frame in robot.link_names and self.frame != "world"
        return Compliance(
            link,
            none if self.stiffness is None else self.stiffness.values(),
            none if self.damping is None else self.damping.values(),
            none if self.wrench is None else self.wrench.values(),
            None if is_link else cell.frame(self.frame).rotation,
            self.frame if is_link else "",
            _load(cell, link),
        )


def _load(cell: Cell, link: str) -> tuple[float, FloatArray]:
    """Mass of what the arm holds [kg], and its place in a link [m], shape (3,)."""
    welded = {each.represents for each in cell.attachments if each.welded and each.end_time > 1e300}
    mass, moment = 0.0, np.zeros(3)
    for name in dict.fromkeys([*cell.held_objects, *sorted(welded)]):
        obj = cell.presence[name].obj
        if not obj.in_simulation:
            continue
        place = cell.frame(link).inverse() @ cell.measured_pose(name)
        mass += obj.mass
        moment += obj.mass * place.apply(obj.center_of_mass[None])[0]
    return mass, moment / mass if mass else moment
