"""What the arguments of commands are: text in, a value out, or a sentence why not."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from harness.core.printable import printable
from harness.core.suggestion import nearest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from _typeshed import SupportsWrite


SYNONYMS = {
    "--report-dir": ("-o", "--out", "--output", "--output-dir", "--reports"),
    "-j": ("-n", "--jobs", "--workers", "--parallel", "--numprocesses"),
    "-k": ("--filter", "--select", "--keyword"),
    "--set": ("-D", "--param", "--override", "--define"),
}
"""Options, and what other programs call them."""


class Parser(argparse.ArgumentParser):
    """Reads arguments; what it says of wrong ones is printable and names the nearest valid one."""

    def error(self, message: str) -> NoReturn:
        super().error(printable(message))

    def parse_known_args(  # pyright: ignore[reportIncompatibleMethodOverride]
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """Parse arguments; argparse would report unknown ones without the command's name."""
        parsed, unknown = super().parse_known_args(args, namespace)
        if unknown:
            self.error(self._unknown(unknown))
        return parsed, unknown

    def _unknown(self, arguments: list[str]) -> str:
        options = [each for each in arguments if each.startswith("-")]
        if not options:
            return f"unexpected argument '{arguments[0]}'"
        name = options[0].partition("=")[0]
        known = {each for action in self._actions for each in action.option_strings}
        synonym = next((each for each, others in SYNONYMS.items() if name in others), None)
        near = synonym if synonym in known else nearest(name, sorted(known))
        hint = f"did you mean {near}? " if near else ""
        return f"there is no option {name}; {hint}`{self.prog} --help` lists the options"

    def print_help(self, file: SupportsWrite[str] | None = None) -> None:
        """Print the help; argparse would hide that it cannot be written."""
        (file or sys.stdout).write(self.format_help())


def folder(text: str) -> Path:
    """A folder that exists."""
    if not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"there is no folder '{text}'")
    return Path(text)


def override_argument(text: str) -> tuple[str, str]:
    """`PATH=VALUE` of `--set`."""
    path, equals, value = text.partition("=")
    if not equals or not path.strip():
        raise argparse.ArgumentTypeError(f"'{text}' is not PATH=VALUE, as in robot.model=ur5e")
    return path.strip(), value


def names_of(text: str) -> list[str]:
    """Names with commas between them, each once."""
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not names:
        raise argparse.ArgumentTypeError("no planner is named")
    return list(dict.fromkeys(names))


def object_topic(text: str) -> tuple[str, str]:
    """`NAME=TOPIC` of an object's pose."""
    name, equals, topic = text.partition("=")
    if not equals or not name.strip() or not topic.strip():
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=TOPIC, as in red_box=/red_box/pose")
    return name.strip(), topic.strip()


def whole_number(text: str) -> int:
    """A number from 1."""
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number from 1")
    return int(text)


def port_number(text: str) -> int:
    """A TCP port; 0 is any that is free."""
    if not text.isdigit() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"'{text}' is not a port from 0 to 65535")
    return int(text)


def metres(text: str) -> float:
    """A length above 0 [m]."""
    return _positive(text, "metres")


def radians(text: str) -> float:
    """An angle above 0 [rad]."""
    return _positive(text, "radians")


def seconds(text: str) -> float:
    """A duration above 0 [s]."""
    return _positive(text, "seconds")


def factor(text: str) -> float:
    """A factor above 0."""
    return _positive(text, "simulated seconds in a second")


def share(text: str) -> float:
    """A share above 0, at most 1."""
    number = _positive(text, "a share")
    if number > 1:
        raise argparse.ArgumentTypeError(f"'{text}' is more than 1")
    return number


def rate(text: str) -> float:
    """Messages a second, above 0."""
    return _positive(text, "messages a second")


def _positive(text: str, what: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not 0 < number < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of {what} above 0")
    return number
