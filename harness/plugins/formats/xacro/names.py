"""The names that xacro itself gives to expressions."""

from __future__ import annotations

from typing import Any, NoReturn

from harness.plugins.formats.xacro.expression import Namespace, evaluate
from harness.plugins.formats.xacro.files import Files
from harness.plugins.formats.xacro.functions import BUILTINS, MATH, PYTHON, TEXT_TOOLS
from harness.plugins.formats.xacro.substitution import Substitution
from harness.plugins.formats.xacro.values import Budget, ExpressionError, Function


def xacro_names(texts: Substitution, files: Files, budget: Budget) -> Namespace:
    """Functions and constants, those of files and arguments included.

    Args:
        texts: The arguments of the rendering.
        files: The files that the rendering may read.
        budget: The steps that are left.
    """

    def number(text: str) -> float:
        try:
            return float(evaluate(text, names, budget))
        except (ExpressionError, TypeError) as error:
            raise ValueError(str(error)) from error

    def load_yaml(filename: str) -> Any:
        if missing := texts.missing_in(filename):
            raise ExpressionError(missing)
        return files.load_yaml(filename, number)

    of_files = {
        "load_yaml": Function("load_yaml", load_yaml),
        "abs_filename": Function("abs_filename", files.absolute),
        "dotify": TEXT_TOOLS["dotify"],
    }
    silent = ("message", "warning", "error", "print_location")
    xacro = {
        **TEXT_TOOLS,
        **of_files,
        **{name: Function(name, lambda *_, **__: "") for name in silent},
        "arg": Function("arg", texts.argument),
        "fatal": Function("fatal", _fatal),
    }
    spaces = {"xacro": xacro, "python": PYTHON, "math": MATH}
    contents = {name: Namespace(space) for name, space in spaces.items()}
    names = Namespace({**BUILTINS, **MATH, **of_files, **contents})
    return names


def _fatal(*words: Any) -> NoReturn:
    raise ExpressionError(" ".join(map(str, words)))
