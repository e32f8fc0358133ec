"""Import a library without the slow modules that only unused functions need."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Generator
from contextlib import contextmanager
from types import ModuleType
from typing import Any


class _Placeholder(ModuleType):
    """Stands for a module: what is taken from it imports the module when it is first called."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        if sys.modules.get(self.__name__) is not self:
            return getattr(importlib.import_module(self.__name__), name)

        def forwarded(*arguments: Any, **options: Any) -> Any:
            return getattr(importlib.import_module(self.__name__), name)(*arguments, **options)

        return forwarded


@contextmanager
def deferred(*modules: str) -> Generator[None]:
    """Let the imports inside find placeholders of modules that are not imported yet.

    A library that is imported here works as ever: a function of such a module, or an attribute
    read through the module, imports the module when it is first used. Only classes that the library
    derives from must not come from it.

    Args:
        modules: Their full names. `import a.b` needs both `a` and `a.b`.
    """
    placeholders = {name: _Placeholder(name) for name in modules if name not in sys.modules}
    for name, placeholder in placeholders.items():
        parent, _, last = name.rpartition(".")
        if parent in placeholders:
            setattr(placeholders[parent], last, placeholder)
    sys.modules.update(placeholders)
    try:
        yield
    finally:
        for name, placeholder in placeholders.items():
            if sys.modules.get(name) is placeholder:
                del sys.modules[name]
