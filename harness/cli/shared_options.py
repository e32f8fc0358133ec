"""Options that several commands have, with one meaning and one help text."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from harness.cli.arguments import folder, override_argument, seconds
from harness.core.registry import registry

if TYPE_CHECKING:
    from harness.reporting.suite.result_format import ResultFormat


def add_paths(command: argparse.ArgumentParser) -> None:
    """Scenario files, and the options of every command that prepares them."""
    command.add_argument(
        "paths",
        metavar="PATH",
        nargs="+",
        help="a scenario file, a folder of *.scenario.yaml, or a bundled name",
    )
    add_preparation(command)


def add_preparation(command: argparse.ArgumentParser) -> None:
    """Values, packages and plug-ins of the scenarios that a command prepares."""
    add_overrides(command, ": --set robot.model=ur5e, --set objects.cube.mass=1")
    add_package_path(command)
    add_plugin(command)


def add_overrides(command: argparse.ArgumentParser, examples: str = "") -> None:
    """`--set PATH=VALUE`."""
    command.add_argument(
        "--set",
        metavar="PATH=VALUE",
        dest="overrides",
        action="append",
        type=override_argument,
        default=[],
        help=f"change a value of the file{examples}",
    )


def add_plugin(command: argparse.ArgumentParser) -> None:
    """`--plugin MODULE`, of every command that reads scenario files."""
    command.add_argument(
        "--plugin",
        metavar="MODULE",
        dest="plugins",
        action="append",
        default=[],
        help="load the plug-ins of a Python module (its name, or a .py file)",
    )


def add_package_path(command: argparse.ArgumentParser) -> None:
    """`--package-path DIR`, for the whole command."""
    command.add_argument(
        "--package-path",
        metavar="DIR",
        dest="package_folders",
        action="append",
        type=folder,
        default=[],
        help="find package:// paths in this folder, and allow meshes to be read there",
    )


def add_seed(command: argparse.ArgumentParser, used: str = "use this seed") -> None:
    """`--seed N` in place of the file's seed."""
    text = f"{used} instead of the file's"
    command.add_argument("--seed", metavar="N", type=int, default=None, help=text)


def add_json(command: argparse.ArgumentParser) -> None:
    """`--json`."""
    text = "print one JSON document on standard output"
    command.add_argument("--json", action="store_true", help=text)


def add_format(command: argparse.ArgumentParser, *, is_of_runs: bool = True) -> None:
    """`--format`, and `--json` for one of its values."""
    formats = {"full": "for people", "short": "a line each", "json": "one document"}
    known: list[type[ResultFormat]] = registry("result_format").built_in()
    formats |= {each.name: each.text for each in known if each.is_of_runs or not is_of_runs}
    text = "; ".join(f"{name}: {what}" for name, what in formats.items())
    command.add_argument("--format", choices=tuple(formats), default="full", help=text)
    text = "the same as --format json"
    command.add_argument("--json", action="store_const", const="json", dest="format", help=text)


def add_verbose(command: argparse.ArgumentParser) -> None:
    """`--verbose`, of commands that print results of runs."""
    text = "show digests, samples that passed, and how much faster than real time it was"
    command.add_argument("-v", "--verbose", action="store_true", help=text)


def add_report_dir(
    command: argparse.ArgumentParser,
    written: str = "write reports into this folder",
    *,
    is_for_nodes: bool = False,
) -> None:
    """`--report-dir DIR`; of a command whose other input is recordings, only `is_for_nodes`."""
    text = f"{written} (default: {'with --node, ' if is_for_nodes else ''}reports)"
    default = None if is_for_nodes else "reports"
    command.add_argument("--report-dir", metavar="DIR", default=default, help=text)


def add_hard_cap(command: argparse.ArgumentParser, run: str) -> None:
    """`--hard-cap SECONDS`, for commands whose runs have processes of their own."""
    text = f"end a {run} as an error after this wall time, waits for a processor left out"
    text += " (default: 600)"
    command.add_argument("--hard-cap", metavar="SECONDS", type=seconds, default=None, help=text)


def add_history(command: argparse.ArgumentParser) -> None:
    """`--history DIR`, for the page of a suite."""
    text = "show the margins of the earlier results.json files in this folder on the suite's page"
    command.add_argument("--history", metavar="DIR", default=None, help=text)


def add_node(command: argparse.ArgumentParser, allowed: str) -> None:
    """`--node COMMAND`, the programs that a scenario may start."""
    command.add_argument(
        "--node",
        metavar="[NAME=]COMMAND",
        dest="nodes",
        action="append",
        default=[],
        help=f"allow {allowed}; repeatable",
    )


def add_report_options(
    command: argparse.ArgumentParser, *, grades_recordings: bool = False
) -> None:
    """The seed and the report of commands that run one case."""
    add_seed(command)
    add_report_dir(command, is_for_nodes=grades_recordings)
    command.add_argument("--no-report", action="store_true", help="write no report")
    text = "write the report without its page"
    command.add_argument("--no-page", action="store_true", help=text)
