"""Facts of a run that several expectations need, computed once while the run is judged."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

from harness.recording.run import Run

P = ParamSpec("P")
T = TypeVar("T")
_facts: ContextVar[dict[Any, Any] | None] = ContextVar("facts", default=None)


@contextmanager
def remembered_facts() -> Generator[None]:
    """Compute each fact once in this context, in which all facts are of the same recording.

    A context inside another one continues with its facts.
    """
    if _facts.get() is not None:
        yield
        return
    token = _facts.set({})
    try:
        yield
    finally:
        _facts.reset(token)


def fact(function: Callable[Concatenate[Run, P], T]) -> Callable[Concatenate[Run, P], T]:
    """Make a function of a run remember its results while a run is judged.

    It must read nothing that an expectation has to declare, and its results must not be changed.
    """

    @wraps(function)
    def remembered(run: Run, *args: P.args, **kwargs: P.kwargs) -> T:
        facts = _facts.get()
        if facts is None:
            return function(run, *args, **kwargs)
        key = function, run.robot.selected_arm, args, tuple(kwargs.items())
        if key not in facts:
            facts[key] = function(run, *args, **kwargs)
        return facts[key]

    return remembered
