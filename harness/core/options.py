"""Options of a command, declared once as fields of a dataclass."""

from __future__ import annotations

from dataclasses import field, fields
from typing import Any


def option(*flags: str, default: Any, text: str, **words: Any) -> Any:
    """A field of a dataclass that an option of the command line sets.

    Args:
        flags: The names of the option, such as `-j`.
        default: The value without the option; of a flag, the option gives the other one.
        text: The help text of the option.
        words: Further arguments of `ArgumentParser.add_argument`, such as `metavar`.
    """
    return field(default=default, metadata={"flags": flags, "words": {"help": text, **words}})


def values_of(model: type, whole: Any) -> dict[str, Any]:
    """The values of a model's fields, from an object that has these fields and others."""
    return {each.name: getattr(whole, each.name) for each in fields(model)}
