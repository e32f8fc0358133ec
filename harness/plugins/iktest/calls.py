"""One call of a function under test, and its possible outcomes."""

from __future__ import annotations

import builtins
import sys
import traceback
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, Literal

import numpy as np

from harness.core.types import FloatArray
from harness.planning.ik.third_party import UnusableIkResult
from harness.plugins.iktest.contract import Value

HARNESS = Path(__file__).parents[1]

OutcomeKind = Literal["answered", "refused", "raised", "unreadable", "hung", "died"]


@dataclass(frozen=True, eq=False)
class CallOutcome:
    """The outcome of a call.

    Attributes:
        answers: Joint positions, shape (dof,) each; they may hold anything, NaN too.
        text: The text of an exception, a signal, or what was returned instead of joint positions.
        place: File and line where an exception was raised, in the function's own code.
    """

    kind: OutcomeKind
    answers: tuple[FloatArray, ...] = ()
    seconds: float = 0.0
    text: str = ""
    place: str = ""


def call(function: Callable[..., Any], arguments: Mapping[str, Value], dof: int) -> CallOutcome:
    """Call a function and read what it returns; never raises but for Ctrl-C."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a NaN is found where it is returned
        start = perf_counter()
        try:
            returned = function(**arguments)
        except KeyboardInterrupt:
            raise
        except UnusableIkResult as error:
            return CallOutcome("unreadable", seconds=perf_counter() - start, text=str(error))
        except BaseException as error:  # noqa: BLE001 - whatever it raises is a result
            return _raised(error, perf_counter() - start)
        seconds = perf_counter() - start
        return read_answers(returned, dof, seconds)


def read_answers(returned: Any, dof: int, seconds: float = 0.0) -> CallOutcome:
    """Joint positions from None, one vector, or a list of vectors."""
    if returned is None:
        return CallOutcome("refused", seconds=seconds)
    must = f"it must return {dof} joint positions, a list of such answers, or None"
    try:
        values = np.array(returned, dtype=float)
    except (TypeError, ValueError):
        text = f"returned {_short(returned)}; {must}"
        return CallOutcome("unreadable", seconds=seconds, text=text)
    if values.size == 0:
        return CallOutcome("refused", seconds=seconds)
    if values.shape == (dof,):
        return CallOutcome("answered", (values,), seconds)
    if values.ndim == 2 and values.shape[1] == dof:
        return CallOutcome("answered", tuple(values), seconds)
    shape = " x ".join(map(str, values.shape)) or "one"
    return CallOutcome("unreadable", seconds=seconds, text=f"returned {shape} numbers; {must}")


def _raised(error: BaseException, seconds: float) -> CallOutcome:
    """A refusal where the exception's class is neither Python's nor NumPy's."""
    module = type(error).__module__.partition(".")[0]
    if module not in ("numpy", builtins.__name__) and module not in sys.stdlib_module_names:
        return CallOutcome("refused", seconds=seconds)
    frames = traceback.extract_tb(error.__traceback__)[1:]  # the first is the call above
    frames = [each for each in frames if not Path(each.filename).is_relative_to(HARNESS)] or frames
    place = f"{Path(frames[-1].filename).name}:{frames[-1].lineno}" if frames else ""
    words = " ".join(str(error).split())
    return CallOutcome("raised", (), seconds, f"{type(error).__name__}: {words[:200]}", place)


def _short(value: object) -> str:
    text = f"{type(value).__name__} {value!r}"
    return text if len(text) < 120 else f"{text[:117]}..."
