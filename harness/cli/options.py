"""Options of the command line from the fields of a dataclass, and the dataclass from options."""

from __future__ import annotations

import argparse
from dataclasses import fields
from typing import Any, TypeVar, get_type_hints

from harness.cli.arguments import whole_number

T = TypeVar("T")


def add_options(command: argparse.ArgumentParser, model: type) -> None:
    """Add the options that the fields of a model declare with `harness.core.options.option`.

    A truth value is a flag, a tuple an option that may be repeated, an integer a number from 1.
    """
    hints = get_type_hints(model)
    for each in (each for each in fields(model) if "flags" in each.metadata):
        words: dict[str, Any] = {"default": each.default, **each.metadata["words"]}
        kind = hints[each.name]
        if kind is bool:
            words["action"] = "store_false" if each.default else "store_true"
        elif kind == tuple[str, ...]:
            words |= {"action": "append", "default": []}
        elif kind in (int, int | None):
            words["type"] = whole_number
        command.add_argument(*each.metadata["flags"], dest=each.name, **words)


def read_options(arguments: argparse.Namespace, model: type[T], **given: Any) -> T:
    """A model with the arguments of the same names.

    Args:
        model: A dataclass, some of whose fields may be no arguments.
        given: Values of fields that take precedence over the arguments.
    """
    parsed: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value
        for name, value in vars(arguments).items()
    }
    names = [each.name for each in fields(model)]  # pyright: ignore[reportArgumentType]
    return model(**{name: parsed[name] for name in names if name in parsed} | given)
