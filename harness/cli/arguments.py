"""Types of arguments on the command line: text in, a value or an error message out."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from harness.core.files import is_dir, path_exists
from harness.core.printable import printable
from harness.core.suggestion import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from _typeshed import SupportsWrite


LONGEST_USAGE = 4  # lines of a usage that is printed with an error; a longer one hides the error

SYNONYMS = {
    "--report-dir": ("-o", "--out", "--output", "--output-dir", "--reports"),
    "-j": ("-n", "--jobs", "--workers", "--parallel", "--numprocesses"),
    "-k": ("--filter", "--select", "--keyword"),
    "--set": ("-D", "--param", "--override", "--define"),
    "run": ("test", "simulate", "execute", "play", "start"),
    "check": ("validate", "lint", "verify", "plan"),
    "new": ("init", "create"),
    "view": ("open", "show", "report"),
    "--help": ("help",),
    "--version": ("version",),
}
"""Options and commands, and what other programs call them."""


def _synonym(word: str, known: Iterable[str]) -> str | None:
    """The option or command that other programs call so."""
    return next((each for each in known if word in SYNONYMS.get(each, ())), None)


class Parser(argparse.ArgumentParser):
    """Parses arguments; messages about wrong ones are printable and name the nearest valid one."""

    def error(self, message: str) -> NoReturn:
        """End with the message; the usage precedes it where it is short."""
        usage = self.format_usage()
        shown = usage if usage.count("\n") <= LONGEST_USAGE else ""
        hint = "" if shown or "--help`" in message else f"; `{self.prog} --help` explains its use"
        self.exit(2, f"{shown}{self.prog}: error: {printable(message)}{hint}\n")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuse a word that is not among an argument's choices, and name the nearest one."""
        if action.choices is not None and value not in action.choices:
            from harness.core.registry import absent_plugins  # takes time

            words = [str(each) for each in action.choices]
            options = self._option_string_actions if action.nargs == argparse.PARSER else ()
            near = _synonym(str(value), (*words, *options))
            hint = did_you_mean(str(value), words, "valid words")
            hint = f"did you mean `{near}`? valid words: {', '.join(words)}" if near else hint
            hints = [hint, *absent_plugins()]
            raise argparse.ArgumentError(action, f"'{value}' is not valid; {'; '.join(hints)}")

    def _get_values(self, action: argparse.Action, arg_strings: list[str]) -> Any:
        """Refuse `--` as an option's value, which argparse drops until Python 3.12."""
        if action.option_strings and arg_strings == ["--"]:
            raise argparse.ArgumentError(action, "'--' is no value")
        return super()._get_values(action, arg_strings)  # pyright: ignore[reportAttributeAccessIssue, reportUnknownMemberType, reportUnknownVariableType]

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
        near = _synonym(name, known) or nearest(name, sorted(known))
        hint = f"did you mean {near}? " if near else ""
        return f"there is no option {name}; {hint}`{self.prog} --help` lists the options"

    def arguments(self) -> list[argparse.Action]:
        """The options and positional arguments, and last the choice of a command."""
        return self._actions

    def commands(self) -> dict[str, Parser]:
        """The parser of each command of this one; empty without commands."""
        found = [each for each in self._actions if each.nargs == argparse.PARSER]
        return dict(found[0].choices or {}) if found else {}  # pyright: ignore[reportArgumentType]

    def print_help(self, file: SupportsWrite[str] | None = None) -> None:
        """Print the help; argparse would hide that it cannot be written."""
        (file or sys.stdout).write(self.format_help())


class CommandParser(Parser):
    """The parser of one command, which learns its options when the command is used.

    Attributes:
        add_options: Adds them; imports the module of the command.
    """

    add_options: Callable[[argparse.ArgumentParser], None] | None = None

    def parse_known_args(
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> tuple[argparse.Namespace, list[str]]:
        self.learn()
        return super().parse_known_args(args, namespace)

    def learn(self) -> None:
        """Add the options of the command, once."""
        add, self.add_options = self.add_options, None
        if add is not None:
            add(self)


def folder(text: str) -> Path:
    """A folder that exists."""
    if not is_dir(Path(text)):
        raise argparse.ArgumentTypeError(f"there is no folder '{text}'")
    return Path(text)


def output_file(text: str) -> str:
    """A file that the command writes; one that cannot be written is refused before it runs."""
    from harness.suite.folders import refuse_unwritable_file

    return _writable(text, refuse_unwritable_file)


def output_folder(text: str) -> str:
    """A folder that the command writes into; refused as a file is."""
    from harness.suite.folders import refuse_unwritable

    return _writable(text, refuse_unwritable)


def output_path(text: str) -> str:
    """A new file or folder, refused as a file is; the command knows what may exist already."""
    return text if path_exists(Path(text)) else output_file(text)


def _writable(text: str, refuse: Callable[[Path], None]) -> str:
    from harness.suite.discovery import UsageError

    try:
        if text:  # the default of some options is empty
            refuse(Path(text))
    except UsageError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    return text


def override_argument(text: str) -> tuple[str, str]:
    """`PATH=VALUE` of `--set`."""
    return pair(text, "PATH=VALUE", "robot.model=ur5e")


def positive_number(what: str) -> Callable[[str], float]:
    """The type of an option that is a finite number of something above 0."""

    def number_of(text: str) -> float:
        try:
            number = float(text)
        except ValueError:
            number = float("nan")
        if not 0 < number < float("inf"):
            raise argparse.ArgumentTypeError(f"'{text}' is not a number of {what} above 0")
        return number

    return number_of


seconds = positive_number("seconds")


def share_of_one(text: str) -> float:
    """A share above 0, at most 1."""
    number = positive_number("a share")(text)
    if number > 1:
        raise argparse.ArgumentTypeError(f"'{text}' is more than 1")
    return number


def whole_number_from(
    least: int, most: int | None = None, what: str = "number"
) -> Callable[[str], int]:
    """The type of an option that is a whole number within bounds."""

    def number_of(text: str) -> int:
        if not text.isdigit() or int(text) < least or (most is not None and int(text) > most):
            to = "" if most is None else f" to {most}"
            raise argparse.ArgumentTypeError(f"'{text}' is not a {what} from {least}{to}")
        return int(text)

    return number_of


whole_number = whole_number_from(1)


def pair(text: str, form: str, example: str) -> tuple[str, str]:
    """`NAME=VALUE`, both without the spaces around them."""
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        raise argparse.ArgumentTypeError(f"'{text}' is not {form}, as in {example}")
    return name.strip(), value
