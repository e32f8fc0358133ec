"""The base classes of expectations: how they are checked, observed and judged."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Self, cast

import numpy as np
from pydantic import BaseModel, Field

from harness.cell.scope import At
from harness.core.amounts import amount
from harness.core.errors import HarnessError
from harness.core.world import ObjectJoint, WorldObject
from harness.judging.hands import of_arm
from harness.judging.margins import Margin, MarginSignal, Part, all_of
from harness.judging.observations import ExpectationError, Observations, merged, restricted
from harness.judging.poses import present
from harness.judging.window import NotObservable, NotReached, Window, lasting, window_of
from harness.judging.words import ALREADY_TRUE, Terms, decide, terms_of
from harness.language.annotations import units_of
from harness.language.base import Name
from harness.language.expectation import (
    CHECK,
    KIND,
    ExpectationFields,
    PredicateFields,
    Quantity,
    TemporalFields,
)
from harness.language.plugin_field import PluginField
from harness.recording.run import ObjectRecord, Run
from harness.recording.verdict import Measure, Verdict, VerdictWarning
from harness.robot.description import RobotDescription

SPECIAL_BODIES = ("robot", "gripper", "any")  # stand for several bodies where two are named
BOUNDS = {"at_least": ">=", "at_most": "<="}  # bound the one quantity of a predicate


@dataclass(frozen=True, eq=False)
class Mechanisms:
    """What has joints: the robot, and the parts of fixtures by their names."""

    robot: RobotDescription
    parts: Mapping[str, ObjectJoint]

    @classmethod
    def of(cls, robot: RobotDescription, objects: Iterable[ObjectRecord | WorldObject]) -> Self:
        """The mechanisms of a run or of a program."""
        return cls(robot, {each.name: each.joint for each in objects if each.joint is not None})

    def units_of(self, joints: Iterable[str]) -> frozenset[str]:
        """The units of joints of the robot: `rad`, `m` or both."""
        units = self.robot.joint_units.by_joint
        return frozenset(units[name] for name in joints if name in units)


BASE_FIELDS = {*TemporalFields.model_fields, *PredicateFields.model_fields}  # none names an object


class Expectation(ExpectationFields):
    """What a run is judged by."""

    word: ClassVar[str] = ""

    def check(self, at: At) -> None:
        """Report what is wrong with the expectation itself for this robot and scene."""

    def stated_arm(self) -> str | None:
        """The arm that it names, of a robot with several; None where it names none."""
        return None

    def joint_units(self, mechanisms: Mechanisms) -> frozenset[str]:
        """Units of the joints that its numbers of rad or m are about; by default all joints'."""
        return mechanisms.units_of(mechanisms.robot.joint_units.by_joint)

    def looks_back(self) -> float | None:
        """How far before its window it reads the record [s]; None where it may read all of it."""
        parts = [part.looks_back() for part in self.predicates().values()]
        return None if not parts or None in parts else max(part or 0.0 for part in parts)

    def needs_step(self) -> str:
        """Why it can be judged over a step alone; empty where it can be judged over a whole run."""
        return ""

    def predicates(self) -> Mapping[str, Predicate]:
        """The predicates inside it, by their keys."""
        return {}

    def names(self) -> frozenset[str]:
        """Names of the objects and links that it is about: of its fields and their parts."""
        own = type(self).model_fields.keys() - BASE_FIELDS - self.predicates().keys()
        inner = (predicate.names() for predicate in self.predicates().values())
        return frozenset(_texts([getattr(self, key) for key in own])).union(*inner)

    def observations(self) -> Observations:
        """What must be recorded so that it can be judged."""
        return merged(inner.observations() for inner in self.predicates().values())

    def verdict(self, run: Run, step: str) -> Verdict:
        """The verdict, without the expectation's text and its place in the file.

        Args:
            step: The id of the step under which it stands; empty for the whole run.

        Raises:
            NotReached: There was nothing to judge.
            NotObservable: The record lacks what it is about.
        """
        raise NotImplementedError(f"{type(self).__name__} has no method `verdict`")

    def readable(self, run: Run) -> Run:
        """The run, restricted to what `observations` declare."""
        return restricted(run, self.observations(), type(self).__name__)


class Predicate(Expectation, PredicateFields):
    """A condition that holds or does not hold at each sample of a run.

    Attributes:
        is_opposed: Whether its measures show its violation: contacts of a collision.
        is_change: Whether it holds because something changed since the run began, so that a window
            in which it holds from the first sample on shows nothing of the change.
        needs_touch: Whether it holds only at samples at which the robot touches its `object`.
    """

    word: ClassVar[str] = ""
    is_opposed: ClassVar[bool] = False
    is_change: ClassVar[bool] = False
    needs_touch: ClassVar[bool] = False

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        if not cls.word:
            return
        if cls.signal is Predicate.signal:
            raise TypeError(f"the predicate {cls.__name__} has no method `signal`")
        if not cls.quantities:
            cls.quantities = _bounded_quantity(cls)

    def signal(self, window: Window) -> MarginSignal | Margin:
        """The margin at each sample of a window, not negative where the predicate holds.

        Returns:
            An array of margins of the predicate's one quantity, shape (n,), in its unit; or a
            signal that says more: several quantities, what a sample shows, where it applies.

        Raises:
            NotReached: There was nothing to judge.
            NotObservable: The record lacks what it is about.
        """
        raise NotImplementedError

    def margins(self, window: Window) -> MarginSignal:
        """The signal with what its samples show.

        Raises:
            ExpectationError: `signal` reads what `observations` does not declare, or goes wrong.
        """
        try:
            run = of_arm(self.readable(window.run), self.arm_in(window))
            found = self.signal(replace(window, run=run))
        except (NotReached, NotObservable, HarnessError):
            raise
        except Exception as error:
            reason = f"{type(self).__name__}.signal raised {type(error).__name__}: {error}"
            raise ExpectationError(reason) from error
        return found if isinstance(found, MarginSignal) else self._with_measures(found, window)

    def arm_in(self, window: Window) -> str:  # noqa: ARG002 - subclasses read it
        """The arm that it is about in a window, of a robot with several; empty for all of them."""
        return ""

    def unchanged(self, window: Window) -> str:  # noqa: ARG002 - subclasses read it
        """Why the run did not have to change anything for it to hold at the end of a window.

        Returns:
            One sentence; empty where something had to change, or where no change is expected.
        """
        return ""

    def verdict(self, run: Run, step: str) -> Verdict:
        terms = self.terms(step)
        window = window_of(run, terms.step)
        margins = self.margins(window)
        here = margins.present
        if terms.word == "at_end" and here is not None and here.any() and not here[-1]:
            raise NotReached("what it is about was not there any more at the end")
        answer = decide(terms, window, margins)
        if answer.status == "passed" and terms.word == "at_end":
            of_its_arm = replace(window, run=of_arm(run, self.arm_in(window)))
            if why := self.unchanged(of_its_arm):
                return replace(answer, warnings=(VerdictWarning(ALREADY_TRUE, why),))
        return answer

    def terms(self, step: str) -> Terms:
        """How the predicate is judged without a temporal word."""
        return terms_of(
            self.judged, (self,), step, is_opposed=self.is_opposed, is_change=self.is_change
        )

    def _with_measures(self, margins: Margin, window: Window) -> MarginSignal:
        """Bare margins with the measure that its class declares, against its bound."""
        if np.shape(margins) != (len(window.times),):
            raise ExpectationError(
                f"{type(self).__name__}.signal returns an array of shape {np.shape(margins)},"
                f" not one margin for each of {len(window.times)} samples"
            )
        quantity = self.quantities[0]
        bounds = {key: getattr(self, key, None) for key in BOUNDS}
        match bounds["at_least"], bounds["at_most"]:
            case (float() | int()) as limit, None:
                part = Part(quantity, limit + margins, limit, ">=")
            case None, (float() | int()) as limit:
                part = Part(quantity, limit - margins, limit, "<=")
            case _:
                part = Part(
                    quantity, margins, 0.0, ">=", measured_name=f"the margin of {quantity.name}"
                )

        def text(_: int, measure: Measure) -> str:
            value, limit = amount(measure.value, part.unit), amount(part.limit, part.unit)
            bound = "at least" if part.comparison == ">=" else "at most"
            return f"{part.name} is {value}, {bound} {limit} required"

        return all_of(window, [part], text)


class ObjectPredicate(Predicate):
    """A predicate of one object; `- lifted: red_box` is short for `{object: red_box}`."""

    word: ClassVar[str] = ""
    short = "object"

    object: Name = Field(description="The name of the object.")

    def check(self, at: At) -> None:
        at.scope.check_object(self.object, at.key("object"), simulated=True)

    def margins(self, window: Window) -> MarginSignal:
        found = super().margins(window)
        if all(record.name != self.object for record in window.run.objects):
            return found
        here = lasting(window.cut(present(window.run, self.object)))
        return replace(
            found,
            values=np.where(here, found.values, np.nan),
            present=here,
            applies=here if found.applies is None else found.applies & here,
        )


class ArmPredicate(Predicate):
    """A predicate of one arm: the one named, else that of the window's step, else the default."""

    word: ClassVar[str] = ""

    by: Name | None = Field(
        default=None,
        description="The arm that it is about, of a robot with several; the default is the arm of "
        "its step.",
    )

    def stated_arm(self) -> str | None:
        return self.by

    def arm_in(self, window: Window) -> str:
        of_step = "" if window.step is None else window.step.arm
        return self.by or of_step or window.run.robot.default_arm

    def names(self) -> frozenset[str]:
        return super().names() - {self.by or ""}


def _texts(value: Any) -> Iterator[str]:
    """Every text in a field's value and in its parts, without the keys of mappings."""
    match value:
        case str():
            yield value
        case BaseModel():
            yield from _texts([getattr(value, key) for key in type(value).model_fields])
        case Mapping():
            yield from _texts(list(cast("Mapping[Any, Any]", value).values()))
        case list() | tuple():
            for part in cast("list[Any]", value):
                yield from _texts(part)
        case _:
            pass


InnerPredicate = Annotated[Predicate, PluginField(KIND, CHECK)]


class TemporalWord(Expectation, TemporalFields):
    """A word that says at which samples of the window its predicate holds.

    Attributes:
        is_change: Whether its predicate must come true in the window.
    """

    word: ClassVar[str] = ""
    is_change: ClassVar[bool] = False

    predicate: InnerPredicate = Field(description="The predicate that is judged.")

    def predicates(self) -> Mapping[str, Predicate]:
        return {"predicate": self.predicate}

    def verdict(self, run: Run, step: str) -> Verdict:
        terms = self.terms(step)
        window = window_of(run, terms.step)
        return decide(terms, window, self.predicate.margins(window))

    def terms(self, step: str) -> Terms:
        """How its predicate is judged."""
        return terms_of(
            self.word,
            (self, self.predicate),
            step,
            is_opposed=self.predicate.is_opposed,
            is_change=self.is_change,
        )


def _bounded_quantity(cls: type[Predicate]) -> tuple[Quantity, ...]:
    """The one quantity of a predicate that has nothing but a bound.

    Raises:
        TypeError: What it measures cannot be known from its fields.
    """
    fields = [cls.model_fields[key] for key in BOUNDS if key in cls.model_fields]
    units = {units_of(field.annotation, field.metadata) or ("1",) for field in fields}
    if len(units) != 1 or len(next(iter(units))) != 1:
        raise TypeError(
            f"the predicate {cls.__name__} does not say what it measures: give it `quantities`,"
            " or a bound `at_least` or `at_most` with a unit"
        )
    ((unit,),) = units
    holds = ", ".join(
        f"{key.replace('_', ' ')} `{key}`" for key in BOUNDS if key in cls.model_fields
    )
    return (Quantity(cls.word.replace("_", " "), unit, holds),)
