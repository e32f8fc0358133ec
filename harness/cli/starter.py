"""Folders of other systems that `harness new` writes, each a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar

from harness.core.registry import Plugin


class Starter(Plugin, ABC):
    """Writes a folder from which another system runs this program."""

    plugin_kind: ClassVar[str] = "starter"

    @abstractmethod
    def write(self, folder: Path) -> list[str]:
        """Write the folder.

        Returns:
            Lines to print: what was written, and what to do with it.

        Raises:
            UsageError: The folder exists, or cannot be written.
        """
