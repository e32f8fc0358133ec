"""The world format `mjcf`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from harness.world.imported import ImportedWorld
from harness.world.world_format import WorldFormat


class Mjcf(WorldFormat):
    """MuJoCo's MJCF: its bodies without joints and its free bodies."""

    name: ClassVar[str] = "mjcf"
    suffixes: ClassVar[tuple[str, ...]] = (".xml",)

    def read(self, path: Path, folders: Sequence[Path]) -> ImportedWorld:
        """Read the scene."""
        from harness.plugins.formats.mjcf.scene import load_mjcf

        return load_mjcf(path, folders)
