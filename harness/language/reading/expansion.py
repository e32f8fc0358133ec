"""Steps that others take the place of, as plug-ins write them, before the file is checked."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar

from harness.core.errors import Problem
from harness.core.registry import Plugin, registry
from harness.language.files.source import Located


class Expansion(Plugin, ABC):
    """Replaces the steps with one verb by other steps."""

    plugin_kind: ClassVar[str] = "expansion"

    @abstractmethod
    def expand(self, root: Located, path: Path, problems: list[Problem]) -> Located:
        """A file's values with the steps replaced; mistakes are added to the problems."""


def with_expansions(root: Located, path: Path, problems: list[Problem]) -> Located:
    """A file's values with the steps of every built-in expansion replaced."""
    for kind in registry(Expansion.plugin_kind).built_in():
        root = kind().expand(root, path, problems)
    return root
