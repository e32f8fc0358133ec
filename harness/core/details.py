"""Typed parts of what is recorded about a step: why it failed, what its motion reached."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any, TypeVar, cast


@dataclass(frozen=True)
class Detail:
    """One part, a frozen dataclass of numbers, texts and further details."""

    def plain(self) -> dict[str, Any]:
        """The part as plain data for a step's record, without optional fields that are None."""
        return {
            entry.name: _plain(value)
            for entry in fields(self)
            if (value := getattr(self, entry.name)) is not None or entry.default is MISSING
        }


D = TypeVar("D", bound=Detail)


@dataclass(frozen=True)
class Details:
    """The parts of one explanation; the values of later parts replace those of earlier ones."""

    parts: tuple[Detail, ...] = ()

    @classmethod
    def of(cls, *parts: Detail | None) -> Details:
        """The parts that are not None."""
        return cls(tuple(part for part in parts if part is not None))

    def __iter__(self) -> Iterator[Detail]:
        return iter(self.parts)

    def __add__(self, more: Details) -> Details:
        return Details((*self.parts, *more.parts))

    def find(self, kind: type[D]) -> D | None:
        """The last part of a kind; None where there is none."""
        return next((part for part in reversed(self.parts) if isinstance(part, kind)), None)

    def replaced(self, part: Detail) -> Details:
        """The details with one part in place of those of its kind."""
        kept = (each for each in self.parts if type(each) is not type(part))
        return Details((*kept, part))

    def plain(self) -> dict[str, Any]:
        """Every part as plain data in one mapping."""
        merged: dict[str, Any] = {}
        for part in self.parts:
            merged |= part.plain()
        return merged


def _plain(value: Any) -> Any:
    match value:
        case Detail():
            return value.plain()
        case tuple() | list():
            return [_plain(item) for item in cast("tuple[Any, ...]", value)]
        case Mapping():
            mapping = cast("Mapping[str, Any]", value)
            return {name: _plain(item) for name, item in mapping.items()}
        case _:
            return value
