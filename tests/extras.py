"""Tests that need an extra: part of the nightly run, and skipped where it is not installed."""

import os
from collections.abc import Iterator
from functools import cache
from importlib.metadata import requires

import pytest
from packaging.requirements import Requirement

from tests.installed import is_installed

PREFIX = "needs_"
OTHER_PYTHON = {"ros": "HARNESS_ROS_PYTHON"}
"""Variables that name another Python, in which an extra is installed."""


def extra_of(marker: str) -> str:
    """The extra in pyproject.toml whose marker this is: `ik-packages` for `needs_ik_packages`."""
    return marker.removeprefix(PREFIX).replace("_", "-")


def distributions_of(extra: str) -> Iterator[str]:
    """The distributions that an extra installs."""
    for requirement in map(Requirement, requires("armharness") or ()):
        if requirement.marker is not None and requirement.marker.evaluate({"extra": extra}):
            yield requirement.name


@cache
def missing(extra: str) -> list[str]:
    """The distributions of an extra that are not installed."""
    if os.environ.get(OTHER_PYTHON.get(extra, "")):
        return []
    return [name for name in distributions_of(extra) if not is_installed(name)]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Make tests that need an extra nightly, unless they measure; skip them without the extra."""
    for item in items:
        names = [each.name for each in item.iter_markers() if each.name.startswith(PREFIX)]
        if names and item.get_closest_marker("benchmark") is None:
            item.add_marker(pytest.mark.nightly)
        for extra in map(extra_of, names):
            if absent := missing(extra):
                command = f"pip install -e '.[test,{extra}]'"
                reason = f"needs the extra `{extra}`, of which {absent[0]} is missing: {command}"
                item.add_marker(pytest.mark.skip(reason=reason))
