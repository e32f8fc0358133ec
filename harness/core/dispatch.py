"""One handler per spec model, found by the model's type."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Generic, TypeVar

M = TypeVar("M")
C = TypeVar("C")
R = TypeVar("R")


class Dispatch(Generic[C, R]):
    """Dispatches a spec model to the one function that carries it out."""

    def __init__(self) -> None:
        self._handlers: dict[type, Callable[[Any, C], R]] = {}

    def handles(self, model: type[M]) -> Callable[[Callable[[M, C], R]], Callable[[M, C], R]]:
        """Register the decorated function for a model; a second one is an error of the program."""

        def register(handler: Callable[[M, C], R]) -> Callable[[M, C], R]:
            if model in self._handlers:
                raise ValueError(f"{model.__name__} already has a handler")
            self._handlers[model] = handler
            return handler

        return register

    def __contains__(self, model: type) -> bool:
        return model in self._handlers

    def __iter__(self) -> Iterator[type]:
        return iter(self._handlers)

    def __call__(self, spec: object, context: C) -> R:
        return self._handlers[type(spec)](spec, context)
