"""A world format: boxes in a table of comma-separated values."""

import csv
from collections.abc import Sequence
from pathlib import Path

from harness.world.world_format import ImportedWorld, WorldFormat, WorldSpec


class Boxes(WorldFormat):
    """Static boxes, a line for each: name, x, y, z, and three side lengths [m]."""

    name = "boxes_csv"
    suffixes = (".csv",)

    def read(self, path: Path, folders: Sequence[Path]) -> ImportedWorld:
        """Read the table."""
        del folders
        with path.open(newline="", encoding="utf-8") as file:
            rows = [(name, list(map(float, numbers))) for name, *numbers in csv.reader(file)]
        objects = [
            {"name": name, "static": True, "box": {"size": size}, "pose": {"xyz": xyz}}
            for name, (*xyz, a, b, c) in rows
            for size in [[a, b, c]]
        ]
        world = WorldSpec.model_validate({"world": path.stem, "objects": objects})
        return ImportedWorld(world, path)
