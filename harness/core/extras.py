"""How to install packages that not everyone needs."""

from __future__ import annotations

import shlex
import sys
from importlib.metadata import PackageNotFoundError, requires
from importlib.util import find_spec
from pathlib import Path

DISTRIBUTION = "armharness"
EXTRAS = {
    "cv2": "cameras",
    "av": "video",
    "rosbags": "bags",
    "mcap": "bags",
    "zstandard": "bags",
    "lz4": "bags",
    "cmaes": "search",
    "hypothesis": "ik-test",
    "scipy": "meshes",
    "trimesh": "meshes",
    "collada": "meshes",
}
"""Packages that only some commands import, and the extra that has each."""


def install_command(extra: str) -> str:
    """A command for the packages of an extra that works in every folder.

    It names the packages themselves: a clone's distribution is on no index.
    """
    try:
        stated = requires(DISTRIBUTION) or []
    except PackageNotFoundError:  # a source tree that was never installed
        return _pip_install("-e", f"{Path(__file__).parents[2]}[{extra}]")
    marked = (requirement.partition(";") for requirement in stated)
    return _pip_install(
        *(
            name.strip()
            for name, _, marker in marked
            if marker.replace("'", '"').strip() == f'extra == "{extra}"'
        )
    )


def missing_extra(error: BaseException) -> str:
    """What to install where an import found no package of an extra; empty for other errors."""
    name = error.name if isinstance(error, ModuleNotFoundError) else None
    package = (name or "").partition(".")[0]
    extra = EXTRAS.get(package)
    if extra is None:
        return ""
    return f"the Python package {package} is not installed; install it by: {install_command(extra)}"


def absent_package(package: str) -> str:
    """What to install where a package of an extra is not installed; empty where it is."""
    return "" if find_spec(package) else missing_extra(ModuleNotFoundError(name=package))


def _pip_install(*what: str) -> str:
    return shlex.join([sys.executable, "-m", "pip", "install", *what])
