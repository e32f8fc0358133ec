"""What results follow from besides their files: the program, its libraries, its plug-ins."""

from __future__ import annotations

import hashlib
import os
import platform
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points

from harness import __version__
from harness.core.registry import ENTRY_POINTS, registry
from harness.core.registry import VARIABLE as PLUGINS
from harness.core.resources import PACKAGE, data_folder
from harness.core.versions import library_versions
from harness.recording.plain import to_plain
from harness.robot.packages import SEARCH_VARIABLE as PACKAGES


@dataclass(frozen=True)
class Installation:
    """What must be the same so that results can be compared, and kept.

    Attributes:
        source: Hash of the program's source files, robots and worlds.
        libraries: Versions of the libraries that results depend on, and of packages with plug-ins.
    """

    version: str
    source: str
    python: str
    libraries: Mapping[str, str]

    def difference(self, other: Installation) -> str:
        """The first thing in which another installation differs, with both values; or empty."""
        here, there = to_plain(self), to_plain(other)
        here |= here.pop("libraries")
        there |= there.pop("libraries")
        for name in sorted({*here, *there}, key=[*here, *there].index):
            if here.get(name) != there.get(name):
                return f"{name} {str(there.get(name))[:12]} instead of {str(here.get(name))[:12]}"
        return ""

    @property
    def digest(self) -> str:
        return hashlib.sha256(repr(to_plain(self)).encode()).hexdigest()


@cache
def installation() -> Installation:
    """The installation in this process."""
    hasher = hashlib.sha256()
    for folder in (PACKAGE, data_folder("robots"), data_folder("worlds")):
        for file in sorted(folder.rglob("*")):
            if file.is_file() and file.suffix != ".pyc":
                hasher.update(f"{file.relative_to(folder)}\0".encode() + file.read_bytes())
    packages = {
        entry.dist.name: entry.dist.version
        for entry in entry_points(group=ENTRY_POINTS)
        if entry.dist is not None
    }
    return Installation(
        __version__,
        hasher.hexdigest(),
        platform.python_version(),
        dict(library_versions()) | packages,
    )


def search_environment() -> dict[str, str]:
    """The environment variables that name plug-ins and folders of files, where they are set."""
    formats = registry("world_format").values()
    names = [PLUGINS, PACKAGES, *(name for each in formats for name in each.variables)]
    return {name: value for name in names if (value := os.environ.get(name, ""))}
