"""The world format `urdf`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from harness.world.imported import ImportedWorld
from harness.world.world_format import WorldFormat


class Urdf(WorldFormat):
    """URDF: a cabinet, a door or another object with joints, which stands at the origin."""

    name: ClassVar[str] = "urdf"
    suffixes: ClassVar[tuple[str, ...]] = (".urdf",)

    def read(self, path: Path, folders: Sequence[Path]) -> ImportedWorld:
        """Read the object."""
        from harness.plugins.formats.urdf_world.fixture import load_urdf

        return load_urdf(path, folders)
