"""What reads a world file of another program, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

from harness.core.errors import HarnessError, Problem, SpecError
from harness.core.registry import Plugin, described, raised, registry
from harness.language.world import WorldSpec
from harness.world.imported import ImportedWorld

__all__ = ["ImportedWorld", "WorldFormat", "WorldSpec"]
"""What a package needs to add a world format of its own."""


class WorldFormat(Plugin, ABC):
    """A format of world files, selected by the suffix of the file that `world` names.

    Attributes:
        suffixes: The suffixes of its files, in lower case, such as `.sdf`.
        variables: Environment variables that name folders in which its files are looked up.
    """

    plugin_kind: ClassVar[str] = "world_format"
    suffixes: ClassVar[tuple[str, ...]] = ()
    variables: ClassVar[tuple[str, ...]] = ()

    @abstractmethod
    def read(self, path: Path, folders: Sequence[Path]) -> ImportedWorld:
        """Read a world.

        Args:
            folders: The folders of the scenario's `model_path`.

        Raises:
            SpecError: The file has mistakes; each at its place.
        """


def read_foreign_world(path: Path, folders: Sequence[Path]) -> ImportedWorld | None:
    """The world of a file whose suffix belongs to a world format; None for other files.

    Raises:
        SpecError: The file has mistakes, or its reader goes wrong; names it and its package.
    """
    formats = registry(WorldFormat.plugin_kind)
    suffix = path.suffix.lower()
    name = next((each for each in formats if suffix in formats[each].suffixes), None)
    if name is None:
        return None
    if formats.is_own(name):
        return formats[name]().read(path, folders)
    who = described(WorldFormat.plugin_kind, name)
    try:
        world: Any = formats[name]().read(path, folders)
    except HarnessError:
        raise
    except Exception as error:
        raise SpecError([Problem(str(path), 0, 0, f"{who} raised {raised(error)}")]) from error
    if not isinstance(world, ImportedWorld):
        what = f"{who} returned {type(world).__name__}, not an ImportedWorld"
        raise SpecError([Problem(str(path), 0, 0, what)])
    return world
