"""What every expectation of a file has; the expectations themselves are plug-ins.

A predicate stands bare, or inside a temporal word. Bare, it is judged by its `judged` word:
`at_end` at the last sample of its step or run, `always` over all of them, `eventually` at any.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from harness.core.registry import HAS_DOCSTRINGS
from harness.language.annotations import bare, branches, unit_of
from harness.language.base import Name, Number, PositiveDuration, SpecModel
from harness.language.plugin_field import PluginField

KIND = "expectation"
CHECK = "check"  # key of the word in an expectation that was brought into its model's shape

Judged = Literal["at_end", "always", "eventually"]


@dataclass(frozen=True)
class Quantity:
    """A number that a predicate measures.

    Attributes:
        name: The name of its measure in a verdict, without the names of bodies or joints.
        unit: The unit of the number and of its margin; `1` for a number without one. Where it
            depends on the joint, both are given with `or` between them.
        holds: The condition under which the predicate holds.
        plot: The plot that the report shows for it; empty where no plot has this number.
    """

    name: str
    unit: str
    holds: str
    plot: str = ""


class TimeFields(SpecModel):
    """The times that stand next to a predicate or a temporal word."""

    for_: PositiveDuration | None = Field(
        default=None,
        alias="for",
        description="The time for which the expectation must hold without a break [s].",
    )
    within: PositiveDuration | None = Field(
        default=None,
        description="The time after the window's start by which the expectation must be true [s].",
    )


class ExpectationFields(SpecModel):
    """The keys that any expectation may have.

    Attributes:
        word: The key that stands for the expectation in a file; by default the class's name in
            lower case with underscores. A base class that is no expectation itself has none.
        subject: The field that names what the expectation is about; by default that of the short
            form, unless it is a number.
        synonyms: What people call the expectation; an error suggests its word for them.
        opposite: The predicate that holds at the end where this one does not; empty without one.
        sentence: A clause with the names of fields in braces, which says what is expected:
            `[{object}|everything] is static`. Of a part in brackets the text after the bar, or
            nothing, stands where no field of it differs from its default. Fields that the clause
            does not name are appended.
        is_upper_bound: Whether it demands a small value by itself, as `slip` does.
        is_proposed: Whether the studio proposes it where it holds: it is rarely true by chance.
    """

    plugin_kind: ClassVar[str] = KIND
    word: ClassVar[str] = ""
    subject: ClassVar[str] = ""
    synonyms: ClassVar[tuple[str, ...]] = ()
    opposite: ClassVar[str] = ""
    sentence: ClassVar[str] = ""
    is_upper_bound: ClassVar[bool] = False
    is_proposed: ClassVar[bool] = False

    during: Name | None = Field(
        default=None,
        description="The id of the step over which it is judged, instead of its own window.",
    )
    points: Annotated[Number, Field(ge=0)] | None = Field(
        default=None, description="Points awarded when this expectation passes."
    )
    name: str | None = Field(
        default=None, description="A name for people; verdicts show it in front of the text."
    )

    def unit_of(self, key: str) -> str:
        """The unit of a field; empty where it has none, or depends on the robot's joint."""
        return unit_of(self, key)

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        if "word" not in cls.__dict__:
            cls.word = re.sub(r"(?<!^)(?=[A-Z])", "_", cls.__name__).lower()
        reserved = {*TemporalFields.model_fields, "for"} if cls.word else ()
        if cls.word in reserved:
            raise TypeError(f"`{cls.word}` cannot be an expectation: it is a key of expectations")
        if cls.word and not cls.__doc__ and HAS_DOCSTRINGS:
            raise TypeError(
                f"the expectation {cls.__name__} has no docstring, which is its text in the"
                " reference and in editors"
            )

    @classmethod
    def plugin_name(cls) -> str:
        """The word under which the expectation is registered; empty for a base class."""
        return cls.word

    @classmethod
    def subject_field(cls) -> str:
        """The field that names what the expectation is about; empty where there is none."""
        if cls.subject or not cls.short:
            return cls.subject
        kinds = branches(cls.model_fields[cls.short].annotation) or (
            cls.model_fields[cls.short].annotation,
        )
        return "" if any(bare(kind) is float for kind in kinds) else cls.short


class PredicateFields(ExpectationFields, TimeFields):
    """The keys that any predicate may have.

    Attributes:
        judged: When a bare predicate is judged.
    """

    word: ClassVar[str] = ""
    judged: ClassVar[Judged] = "at_end"
    quantities: ClassVar[tuple[Quantity, ...]] = ()


class TemporalFields(ExpectationFields, TimeFields):
    """The keys that stand next to a temporal word."""

    word: ClassVar[str] = ""


AnyExpectation = Annotated[ExpectationFields, PluginField(KIND, CHECK)]
