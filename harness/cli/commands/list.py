"""`harness list`: what a scenario may name."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from typing import ClassVar

from harness.cli.command import SETUP, Command
from harness.cli.output import complain, say
from harness.cli.shared_options import add_plugin

Rows = Iterable[tuple[str, ...]]
SHOWN = 3  # names of a kind that `harness list` alone prints


class ListCommand(Command):
    """List robots, worlds, steps and all else that a scenario may name."""

    name: ClassVar[str] = "list"
    group: ClassVar[str] = SETUP

    def add_options(self, command: argparse.ArgumentParser) -> None:
        text = "what to list; without it, how much there is of each kind"
        command.add_argument("kind", choices=tuple(LISTINGS), nargs="?", help=text)
        add_plugin(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Print one line for each thing of a kind; without a kind, one line for each kind."""
        listing = _kinds if arguments.kind is None else LISTINGS[arguments.kind]
        table = list(listing())
        widths = [max(map(len, column)) for column in zip(*table, strict=True)]
        for row in table:
            cells = (f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True))
            say("  ".join(cells).rstrip())
        return 0


def _kinds() -> Rows:
    for kind, listing in LISTINGS.items():
        rows = list(listing())
        first = ", ".join(row[0] for row in rows[:SHOWN])
        more = ", ..." if len(rows) > SHOWN else ""
        yield f"harness list {kind}", str(len(rows)), first + more


def _robots() -> Rows:
    from harness.robot.load import gripper_names, robot_names
    from harness.robot.robot_collection import collected_robots, package_of_robot

    grippers, collected = gripper_names(), collected_robots()
    return [
        (
            name,
            "gripper" if name in grippers else "arm",
            package_of_robot(name) if name in collected else "",
        )
        for name in robot_names()
    ]


def _worlds() -> Rows:
    from harness.core.resources import data_folder

    files = sorted(data_folder("worlds").glob("*.yaml"))
    return [(file.stem, "") for file in files]


def _scenarios() -> Rows:
    from harness.suite.discovery import bundled_scenarios
    from harness.suite.header import read_header

    return [(name, read_header(file).title) for name, file in bundled_scenarios().items()]


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
    from harness.planning.search.find_pipeline import planner_names
    from harness.planning.search.planner_names import DEFAULT_PLANNER

    return [(name, "default" if name == DEFAULT_PLANNER else "") for name in planner_names()]


def _packages() -> Rows:
    """The packages of plug-ins: where each is, what it provides and what it lacks."""
    from importlib import import_module
    from importlib.util import find_spec

    from harness.core.extras import install_command
    from harness.core.registry import (
        BUILT_IN,
        BUNDLED,
        OWN_PACKAGE,
        absent_plugins,
        broken_plugins,
        noun,
        registry,
    )

    for broken in [*broken_plugins(), *absent_plugins()]:
        complain(f"harness: {broken}")
    provided: dict[tuple[str, str], list[str]] = {}
    for kind in BUILT_IN:
        for name in registry(kind):
            module, package = registry(kind).module_of(name), registry(kind).package_of(name)
            parts = module.split(".")
            is_bundled = package == OWN_PACKAGE
            if is_bundled and parts[:2] != ["harness", "plugins"]:
                continue
            row = (parts[2], "built in") if is_bundled else (package, _version_of(package))
            provided.setdefault(row, []).append(f"{noun(kind)} {name}")
    for (name, source), words in sorted(provided.items()):
        lacks = ""
        if (BUNDLED / name / "__init__.py").is_file():
            needed: dict[str, str] = getattr(import_module(f"harness.plugins.{name}"), "EXTRAS", {})
            extras = dict.fromkeys(e for package, e in needed.items() if find_spec(package) is None)
            lacks = ", ".join(
                f"without the extra `{extra}`: {install_command(extra)}" for extra in extras
            )
        yield name, source, ", ".join(words), lacks


def _version_of(package: str) -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(package)
    except PackageNotFoundError:
        return "a module of --plugin"


def _listing(kind: str) -> Callable[[], Rows]:
    return lambda: _plugins(kind)


LISTINGS: dict[str, Callable[[], Rows]] = {
    "robots": _robots,
    "worlds": _worlds,
    "scenarios": _scenarios,
    "steps": _listing("step"),
    "expectations": _listing("expectation"),
    "planners": _planners,
    "pipelines": _listing("planner"),
    "ik-solvers": _listing("ik_solver"),
    "controllers": _listing("controller"),
    "world-formats": _listing("world_format"),
    "reporters": _listing("reporter"),
    "commands": _listing("command"),
    "run-modes": _listing("run_mode"),
    "case-runners": _listing("case_runner"),
    "plugins": _packages,
}
