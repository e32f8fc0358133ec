"""What an expression of a xacro file may handle, and how much of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from harness.core.limits import XACRO_STEPS

LONGEST_TEXT = 100_000  # characters that an expression may make
MOST_ITEMS = 10_000  # of a list that an expression makes
MOST_BITS = 4096  # of an integer; the largest float has 1024
CHARACTERS_PER_STEP = 10  # of a text, that count as one step of an expression

LARGEST_KEY = 2**61 - 1
"""Integers from here on may share their hash with others, which makes dictionaries slow."""


class ExpressionError(Exception):
    """An expression cannot be evaluated.

    Attributes:
        start: The first character of the part at fault, from 0.
        length: Characters of that part; 0: all of the expression.
    """

    def __init__(self, message: str, start: int = 0, length: int = 0, hint: str = "") -> None:
        super().__init__(message)
        self.message, self.start, self.length, self.hint = message, start, length, hint


class Exhausted(Exception):
    """A rendering needs more steps than any robot does."""


class YamlDict(dict[str, Any]):
    """A mapping of a YAML file: `config.key` is `config['key']`."""


@dataclass(frozen=True, eq=False)
class Function:
    """A function that expressions may call; it has no attributes that they can reach.

    Attributes:
        takes_functions: Whether its arguments may be functions themselves.
    """

    name: str
    call: Callable[..., Any]
    takes_functions: bool = False


class Budget:
    """The steps that are left of a rendering."""

    def __init__(self) -> None:
        self.left = XACRO_STEPS

    def spend(self, steps: int) -> None:
        """Count steps.

        Raises:
            Exhausted: None are left.
        """
        self.left -= steps
        if self.left < 0:
            raise Exhausted

    def weigh(self, value: object) -> None:
        """Count the parts of a value, before an operation goes through all of them.

        Parts that several lists share count each time, because operations visit them each time.

        Raises:
            TypeError: It is, or contains, something other than data.
        """
        pending = [value]
        while pending:
            item = pending.pop()
            if isinstance(item, str):
                self.spend(len(item) // CHARACTERS_PER_STEP)
            elif isinstance(item, list | tuple):
                self.spend(len(item))
                pending.extend(item)
            elif isinstance(item, dict):
                self.spend(2 * len(item))
                pending.extend(item)
                pending.extend(item.values())
            elif isinstance(item, range):
                self.spend(len(item))
            elif item is not None and not isinstance(item, bool | int | float):
                raise TypeError(f"{shown(item)} is not a number, text, list or dictionary")


def bounded(value: Any) -> Any:
    """The result of an operation, if it is of a usual size and kind.

    Raises:
        ValueError: It is too large.
        TypeError: It is of a kind that expressions do not have.
    """
    if isinstance(value, bool | float | Function | dict) or value is None:
        return value
    if isinstance(value, int):
        refuse_large(value.bit_length(), MOST_BITS, "bits")
    elif isinstance(value, str):
        refuse_large(len(value), LONGEST_TEXT, "characters")
    elif isinstance(value, list | tuple | range):
        refuse_large(len(value), MOST_ITEMS, "items")
    elif isinstance(value, complex):
        raise TypeError("the result is a complex number")
    return value


def refuse_large(size: int, most: int, unit: str) -> None:
    """Refuse a result before it is computed.

    Raises:
        ValueError: It is larger than what is allowed.
    """
    if size > most:
        raise ValueError(f"the result has more than {most} {unit}")


def checked_key(key: object) -> object:
    """A key of a dictionary.

    Raises:
        TypeError: It is neither text nor an integer of usual size.
    """
    if isinstance(key, str) or (isinstance(key, int) and abs(key) < LARGEST_KEY):
        return key
    raise TypeError("keys of a dictionary are texts and integers")


def shown(value: object) -> str:
    """A value that is no data, for messages."""
    return f"'{value.name}'" if isinstance(value, Function) else "a namespace"
