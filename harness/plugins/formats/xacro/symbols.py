"""Properties and macros of xacro files, by scope."""

from __future__ import annotations

import keyword
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from harness.language.files.source import Place
from harness.plugins.formats.xacro.expression import Names
from harness.plugins.formats.xacro.values import ExpressionError

BOOLEANS = {"true": True, "True": True, "false": False, "False": False}


@dataclass(frozen=True)
class Text:
    """A text of a file that is evaluated when it is needed."""

    text: str
    place: Place


class Table:
    """The properties, or the macros, of one scope.

    Attributes:
        parent: The scope around it; at the top the names that xacro itself has.
        is_namespace: Whether it is that of an included file (`ns="..."`).
    """

    def __init__(
        self,
        parent: Table | Names | None,
        evaluate: Callable[[Text, Table], Any],
        *,
        is_namespace: bool = False,
    ) -> None:
        self.parent = parent
        self.is_namespace = is_namespace
        self._evaluate = evaluate
        self._values: dict[str, Any] = {}
        self._open: list[str] = []

    def child(self, *, is_namespace: bool = False) -> Table:
        """A scope in this one."""
        return Table(self, self._evaluate, is_namespace=is_namespace)

    def __contains__(self, name: str) -> bool:
        return name in self._values or (self.parent is not None and name in self.parent)

    def __getitem__(self, name: str) -> Any:
        """The value of a name, which is evaluated now if it was not before.

        Raises:
            KeyError: There is no such name.
            ExpressionError: Its value depends on itself.
        """
        if name not in self._values:
            if self.parent is None:
                raise KeyError(name)
            return self.parent[name]
        value = self._values[name]
        if isinstance(value, Text):
            if name in self._open:
                circle = " -> ".join([*self._open, name])
                raise ExpressionError(f"properties depend on each other in a circle: {circle}")
            self._open.append(name)
            value = self._values[name] = literal(self._evaluate(value, self))
            self._open.remove(name)
        return value

    def __setitem__(self, name: str, value: Any) -> None:
        """Define a name; a Text that is a number or boolean as it stands is one."""
        plain = literal(value.text if isinstance(value, Text) else value)
        is_pending = isinstance(value, Text) and isinstance(plain, str)
        self._values[name] = Text(plain, value.place) if is_pending else plain

    def get(self, name: str) -> Any:
        """The value of a name; None if there is no such name."""
        try:
            return self[name]
        except KeyError:
            return None

    def remove(self, name: str) -> None:
        """Forget a name in this scope and those around it."""
        self._values.pop(name, None)
        if isinstance(self.parent, Table):
            self.parent.remove(name)

    def top(self) -> Table:
        """The outermost scope of the files."""
        return self.parent.top() if isinstance(self.parent, Table) else self

    def caller(self) -> Table:
        """The scope to which `scope="parent"` leads."""
        found = self.parent if isinstance(self.parent, Table) else self
        if self.is_namespace:
            return found
        while found.is_namespace and isinstance(found.parent, Table):
            found = found.parent
        return found

    def names(self) -> list[str]:
        """All names of this scope and those around it."""
        around = self.parent.names() if self.parent is not None else []
        own = [name for name in self._values if name.isidentifier()]
        return [*own, *(name for name in around if name not in own)]


def literal(value: Any) -> Any:
    """The number or boolean that a text is; any other value as it is."""
    if not isinstance(value, str):
        return value
    if len(value) >= 2 and value[0] == value[-1] == "'":
        return value[1:-1]
    if "_" in value:
        return value
    for kind in (int, float):
        try:
            return kind(value)
        except ValueError:
            pass
    return BOOLEANS.get(value, value)


def is_property_name(name: object) -> bool:
    """Whether a property may have this name."""
    return (
        isinstance(name, str)
        and name.isidentifier()
        and not keyword.iskeyword(name)
        and not name.startswith("__")
    )


def truth(value: Any) -> bool | None:
    """The value of a condition; None for a text that is none."""
    if not isinstance(value, str):
        return bool(value)
    if value in BOOLEANS:
        return BOOLEANS[value]
    try:
        return bool(int(value))
    except ValueError:
        return None
