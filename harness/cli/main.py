"""The command `harness`: arguments in, exit code out. Imports nothing that takes time."""

from __future__ import annotations

import argparse
import gc
import importlib
import os
import sys
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import NoReturn

from harness import __version__
from harness.cli import options

EPILOG = """exit codes: 0 passed, 1 failed, 2 invalid file or wrong usage, 3 error, 130 Ctrl-C"""
USAGE_EXIT_CODE = 2
BROKEN_PIPE_EXIT_CODE = 141  # as a shell shows SIGPIPE


def entry() -> NoReturn:
    """The console script: `main`, in the shortest way to the end of the process.

    A command makes hundreds of thousands of objects that live to its end, through which the
    collector would walk, and taking native libraries down takes 0.1 s and prints about leaks.
    """
    gc.disable()
    code = main()
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(code)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns:
        The exit code.
    """
    parsed = _parser().parse_args(arguments)
    if parsed.module == "run":
        gc.enable()
    try:
        if not _load_plugins(getattr(parsed, "plugins", ())):
            return USAGE_EXIT_CODE
        command = importlib.import_module(f"harness.cli.{parsed.module}")
        with _package_path(getattr(parsed, "package_folders", ())):
            code = command.run(parsed)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader of a pipe has left; nothing is to be said to it at exit either.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE_EXIT_CODE
    except KeyboardInterrupt:
        return 130
    return code


def _package_path(folders: Sequence[Path]) -> AbstractContextManager[None]:
    if not folders:
        return nullcontext()
    from harness.robot.packages import searched_too

    return searched_too(folders)


def _load_plugins(modules: Sequence[str]) -> bool:
    """Load the modules of `--plugin`; what is wrong with one is printed."""
    if not modules:
        return True
    from harness.core.registry import PluginError, load_plugin

    try:
        for module in modules:
            load_plugin(module)
    except PluginError as error:
        sys.stderr.write(f"harness: {error}\n")
        return False
    return True


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="harness",
        description="Run scenarios of robot arms: planned, simulated, judged, reported.",
        epilog=EPILOG,
    )
    parser.add_argument("--version", action="version", version=f"armharness {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)

    def command(name: str, text: str, module: str = "") -> argparse.ArgumentParser:
        added = commands.add_parser(name, help=text, description=f"{text[0].upper()}{text[1:]}.")
        added.set_defaults(module=module or name)
        return added

    options.for_run(command("run", "run scenarios and judge them"))
    options.for_check(command("check", "validate scenarios and the reach of their goals"))
    options.for_explain(command("explain", "print the program that a scenario becomes"))
    options.for_list(command("list", "list what a scenario may name", module="listing"))
    options.for_view(command("view", "open the page of a run"))
    options.for_judge(command("judge", "judge a saved run again"))
    options.for_grade(command("grade", "grade a recording of another program by a scenario"))
    options.for_compare(command("compare", "tell what changed from one saved run to another"))
    options.for_new(command("new", "write a commented scenario that passes"))
    options.for_export(command("export", "write a saved run as a rosbag2, and its robot as a URDF"))
    options.for_import(
        command("import", "write files of other programs as ours", module="importing")
    )
    options.for_robot(command("robot", "look a robot over, or draw it"))
    options.for_ik_test(
        command("ik-test", "test a function that solves inverse kinematics", module="ik_test")
    )
    options.for_bench(command("bench", "compare planners on the motions of scenarios"))
    options.for_schema(command("schema", "print the JSON Schema of scenario files"))
    return parser
