"""The world format `sdf`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from harness.plugins.formats.sdf.model_path import FUEL_CACHE, VARIABLES
from harness.world.imported import ImportedWorld
from harness.world.world_format import WorldFormat


class Sdf(WorldFormat):
    """Gazebo's SDF: the first world of the file."""

    name: ClassVar[str] = "sdf"
    suffixes: ClassVar[tuple[str, ...]] = (".sdf", ".world")
    variables: ClassVar[tuple[str, ...]] = (*VARIABLES, FUEL_CACHE)

    def read(self, path: Path, folders: Sequence[Path]) -> ImportedWorld:
        """Read the world."""
        from harness.plugins.formats.sdf.world import load_sdf

        return load_sdf(path, folders)
