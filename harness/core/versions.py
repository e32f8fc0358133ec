"""Versions of what a result may depend on."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.metadata import version

LIBRARIES = ("armharness", "mujoco", "pin", "coal", "ompl", "numpy")


@cache
def library_versions() -> Mapping[str, str]:
    """What a run may depend on; looked up once, each takes a millisecond or two."""
    return {name: version(name) for name in LIBRARIES}
