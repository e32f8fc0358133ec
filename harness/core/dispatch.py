"""Registry of handlers: one for each model class."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Generic, TypeVar

M = TypeVar("M")
C = TypeVar("C")
R = TypeVar("R")


class Dispatch(Generic[C, R]):
    """Dispatches a model to the handler of its class."""

    def __init__(self) -> None:
        self._handlers: dict[type, Callable[[Any, C], R]] = {}

    def handles(self, model: type[M]) -> Callable[[Callable[[M, C], R]], Callable[[M, C], R]]:
        """Register the decorated function for a class; a second handler is a program error."""

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
