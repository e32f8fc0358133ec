"""Texts of xacro files: `${expression}`, `$(command)` and what stands around them."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from harness.core.errors import SpecError
from harness.language.files.source import Place
from harness.plugins.formats.xacro.expression import Names, Namespace, evaluate
from harness.plugins.formats.xacro.functions import BUILTINS, MATH
from harness.plugins.formats.xacro.symbols import BOOLEANS
from harness.plugins.formats.xacro.values import LONGEST_TEXT, Budget, ExpressionError, Function
from harness.robot.packages import NotFoundError, PackagePath

PIECE = re.compile(
    r"(?P<escaped>\$\$+[{(])|\$\{(?P<expression>[^}]*)\}|\$\((?P<command>[^)]*)\)"
    r"|(?P<plain>[^$]+|\$[^{($]+|\$$)"
)
FIND = re.compile(r"\$\(find +([^ )]+) *\)")
COMMANDS = "$(arg NAME), $(find PACKAGE), $(optenv NAME DEFAULT) and $(eval EXPRESSION)"
EVAL = ("list", "dict", "map", "str", "float", "int")
NOT_IN_XML = re.compile(r"[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


class Substitution:
    """Evaluates texts with the arguments and packages of one rendering."""

    def __init__(self, args: dict[str, str], packages: PackagePath, budget: Budget) -> None:
        self.args = args
        self.missing: dict[str, str] = {}
        """Packages that are not found, each with its message."""

        self._packages = packages
        self._budget = budget

    def value(self, text: str, names: Names, place: Place) -> Any:
        """The value of a text: of one expression as it is, else text.

        Args:
            text: The text as the file has it.
            names: Properties, functions and constants.
            place: Where the text stands.

        Raises:
            SpecError: Some part of it has no value; at its place.
        """
        try:
            return self._value(text, names)
        except ExpressionError as error:
            length = error.length or len(text) - error.start
            is_long = len(text) > LONGEST_TEXT
            at = place if is_long else place.part(text, error.start, length)
            raise SpecError([at.problem(error.message, error.hint)]) from error

    def text(self, text: str, names: Names, place: Place) -> str:
        """As `value`, and what is no text is written as Python writes it."""
        return text if "$" not in text else self.written(self.value(text, names, place), place)

    def written(self, value: Any, place: Place) -> str:
        """A value as Python writes it.

        Raises:
            SpecError: It is a function or a namespace.
        """
        try:
            return self._written(value)
        except ExpressionError as error:
            raise SpecError([place.problem(error.message)]) from error

    def _value(self, text: str, names: Names) -> Any:
        values: list[Any] = []
        position = 0
        while position < len(text):
            found = PIECE.match(text, position)
            if found is None:
                message = "`$` begins `${expression}` or `$(command)`, which does not end here"
                raise ExpressionError(message, position)
            values.append(self._piece(found, names))
            position = found.end()
        if len(values) == 1:
            return values[0]
        joined = "".join(map(self._written, values))
        if len(joined) > LONGEST_TEXT:
            raise ExpressionError(f"the text has more than {LONGEST_TEXT} characters")
        return joined

    def _piece(self, found: re.Match[str], names: Names) -> Any:
        kind = str(found.lastgroup)
        written = found[kind]
        if kind == "escaped":
            return written[1:]
        if kind == "plain":
            self._budget.weigh(written)
            return written
        try:
            inner = written if "$" not in written else self._written(self._value(written, names))
            if kind == "command":
                return self._command(inner)
            return evaluate(inner, names, self._budget)
        except ExpressionError as error:
            is_moved = "$" in written  # what was replaced has another length
            start = found.start(kind) + (0 if is_moved else error.start)
            length = 0 if is_moved else error.length
            hint, message = error.hint, error.message
            raise ExpressionError(message, start, length or len(written), hint) from error

    def _written(self, value: Any) -> str:
        try:
            self._budget.weigh(value)
        except TypeError as error:
            raise ExpressionError(str(error)) from error
        if found := NOT_IN_XML.search(text := str(value)):
            raise ExpressionError(f"XML has no character U+{ord(found[0]):04X}")
        return text

    def _command(self, command: str) -> str:
        if command.startswith("eval "):
            return self._written(evaluate(command[5:], self._eval_names(), self._budget))
        word, *arguments = command.split() or [""]
        match word, arguments:
            case "arg", [name]:
                return FIND.sub(lambda found: self._find(found[1]), self.argument(name))
            case "find", [name]:
                return self._find(name)
            case "optenv", [_, *default]:
                return " ".join(default)
            case "env", [name]:
                hint = "make it an argument: <xacro:arg>"
                raise ExpressionError(f"the environment variable '{name}' is not read", hint=hint)
            case _:
                message = f"`$({command})` is not a substitution that is read"
                raise ExpressionError(message, hint=f"known are {COMMANDS}")

    def argument(self, name: str) -> str:
        """The value of an argument.

        Raises:
            ExpressionError: It has none.
        """
        if name not in self.args:
            hint = f"give it: --args {name}=VALUE, or `args: {{{name}: VALUE}}` in `robot:`"
            raise ExpressionError(f"the argument '{name}' has no value here", hint=hint)
        return self.args[name]

    def _find(self, name: str) -> str:
        """The folder of a package; the text itself where the package is missing.

        Only what is read requires its packages: not the parameters of a `<gazebo>` element.
        """
        try:
            return str(self._packages.package(name))
        except NotFoundError as error:
            self.missing[name] = str(error)
            return f"$(find {name})"

    def missing_in(self, text: str) -> str:
        """Why the first missing package that a text names is missing; empty if there is none."""
        names = (found[1] for found in FIND.finditer(text))
        return next((self.missing[name] for name in names if name in self.missing), "")

    def _eval_names(self) -> Namespace:
        """Names of `$(eval ...)`: functions, constants, and arguments with their values."""
        functions = {name: BUILTINS[name] for name in EVAL}
        call: Callable[[str], Any] = lambda name: _typed(self.argument(name))  # noqa: E731
        known = {**MATH, **BOOLEANS, **functions, "arg": Function("arg", call)}
        return Namespace({name: _typed(value) for name, value in self.args.items()} | known)


def _typed(text: str) -> Any:
    for kind in (float,) if "." in text else (int,):
        try:
            return kind(text)
        except ValueError:
            pass
    return BOOLEANS.get(text.lower(), text)
