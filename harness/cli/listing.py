"""`harness list`: what a scenario may name."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable

from harness.cli.output import complain, guarded, say

Rows = Iterable[tuple[str, ...]]


def run(arguments: argparse.Namespace) -> int:
    """Print one line for each thing of a kind."""
    return guarded(lambda: _run(LISTINGS[arguments.kind]()))


def _run(rows: Rows) -> int:
    table = list(rows)
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for row in table:
        cells = (f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True))
        say("  ".join(cells).rstrip())
    return 0


def _robots() -> Rows:
    from harness.robot.load import gripper_names, robot_names

    grippers = gripper_names()
    return [(name, "gripper" if name in grippers else "arm") for name in robot_names()]


def _worlds() -> Rows:
    from harness.core.resources import data_folder

    files = sorted(data_folder("worlds").glob("*.yaml"))
    return [(file.stem, "") for file in files]


def _scenarios() -> Rows:
    from harness.suite.discovery import bundled_scenarios
    from harness.suite.header import read_header

    return [(name, read_header(file).title) for name, file in bundled_scenarios().items()]


def _steps() -> Rows:
    return _plugins("step")


def _expectations() -> Rows:
    return _plugins("expectation")


def _plugins(kind: str) -> Rows:
    """Name, package and first sentence of every plug-in of a kind."""
    from harness.core.registry import broken_plugins, registry
    from harness.language.annotations import description_of

    for broken in broken_plugins():
        complain(f"harness: {broken}")
    registered = registry(kind)
    return [
        (name, registered.package_of(name), description_of(model).split("\n")[0])
        for name, model in registered.items()
    ]


def _planners() -> Rows:
    from harness.planning.search.planner_names import DEFAULT_PLANNER, planner_names

    return [(name, "default" if name == DEFAULT_PLANNER else "") for name in planner_names()]


LISTINGS: dict[str, Callable[[], Rows]] = {
    "robots": _robots,
    "worlds": _worlds,
    "scenarios": _scenarios,
    "steps": _steps,
    "expectations": _expectations,
    "planners": _planners,
}
