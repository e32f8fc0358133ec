"""The command `harness`: arguments in, exit code out. Imports nothing that takes time."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from typing import TYPE_CHECKING, NoReturn

from harness.suite.outcome import EXIT_CODES, INTERRUPTED_EXIT_CODE, USAGE_EXIT_CODE

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path
    from types import FrameType

    from harness.cli.arguments import Parser
    from harness.cli.command import Command

EPILOG = """exit codes: 0 passed, 1 failed, 2 invalid file or wrong usage, 3 error,
130 interrupted (Ctrl-C, SIGTERM)

`harness COMMAND --help` explains a command; docs/README.md of the repository lists all pages."""
GREETING = """\
harness runs scenarios of robot arms: planned, simulated in physics, judged, reported.

  harness list scenarios          the scenarios that are bundled
  harness run NAME                run one, and write its report page
  harness new first.scenario.yaml write a commented scenario that passes, to begin with
  harness studio                  open a robot cell in the browser
  harness --help                  all commands

The documentation is the folder docs of the repository, from docs/README.md on."""
"""What `harness` alone prints."""
BROKEN_PIPE_EXIT_CODE = 141  # as a shell shows SIGPIPE
STREAMS = ("stdin", "stdout", "stderr")


def entry() -> NoReturn:
    """The console script: `main`, in the shortest way to the end of the process.

    A command makes hundreds of thousands of objects that live to its end, through which the
    collector would walk, and taking native libraries down takes 0.1 s and prints about leaks.
    """
    # Until a command has begun there is nothing to put in order.
    _handle(lambda _number, _frame: os._exit(INTERRUPTED_EXIT_CODE))
    import gc

    gc.disable()
    _use_utf8()
    _prepare_streams()
    os.environ.pop("MUJOCO_GL", None)  # with a library that is missing, mujoco cannot be imported
    from harness.core.interruption import interrupt

    try:
        try:
            _handle(interrupt)
            code = main()
        except SystemExit as end:  # of argparse, which has written why
            code = end.code if isinstance(end.code, int) else EXIT_CODES["error"]
        except OSError as error:
            code = _unwritable(error)
        code = _flushed(code)
    except KeyboardInterrupt:
        code = INTERRUPTED_EXIT_CODE
    os._exit(code)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns:
        The exit code of the command.
    """
    import gc
    from contextlib import nullcontext

    words = sys.argv[1:] if arguments is None else arguments
    parsed = parser_of(words).parse_args(words)
    from harness.cli.output import OutputError, complain, guarded, only_json_on_stdout, say
    from harness.core.registry import registry

    if parsed.command is None:
        for line in GREETING.splitlines():
            say(line)
        return 0

    command: Command = parsed.implementation
    if arguments is None and command.reads_geometry:
        from harness.cli.native_crash import in_own_process

        if (ended := in_own_process()) is not None:
            code, reason = ended
            if reason:
                complain(f"harness {command.name}: error: {reason}")
            return code
    if command.collects_garbage:
        gc.enable()
    documents = ("json", *registry("result_format").built_in_modules)
    given = getattr(parsed, "json", False) or getattr(parsed, "format", "") in documents
    is_json = given and not command.writes_json_in_parts
    ticks = getattr(parsed, "ticks", True) and not getattr(parsed, "in_process", False)
    try:
        os.getcwd()  # noqa: PTH109 - only whether there is one
    except OSError as error:
        complain(f"harness: the working directory cannot be used: {error.strerror}; change it")
        return USAGE_EXIT_CODE
    try:
        if not _load_plugins(getattr(parsed, "plugins", ())):
            return USAGE_EXIT_CODE
        json_only = only_json_on_stdout() if is_json else nullcontext()
        with json_only:
            code: object = guarded(lambda: _begun(command.run, parsed), ticks=ticks)
        sys.stdout.flush()
    except BrokenPipeError:
        _abandon_stdout()  # the reader of a pipe has left
        return BROKEN_PIPE_EXIT_CODE
    except KeyboardInterrupt:
        return INTERRUPTED_EXIT_CODE
    except OutputError as error:
        _abandon_stdout()
        complain(f"harness: {error}")
        return EXIT_CODES["error"]
    if isinstance(code, int):
        return code
    where = type(command).__module__
    complain(f"harness: `{command.name}` of {where} returned {code!r}, which is no exit code")
    return EXIT_CODES["error"]


def _begun(run: Callable[[argparse.Namespace], int], parsed: argparse.Namespace) -> int:
    """Run a command that can write where its report goes, with its folders of packages."""
    if getattr(parsed, "report_dir", None) and not getattr(parsed, "no_report", False):
        from pathlib import Path

        from harness.suite.folders import refuse_unwritable

        refuse_unwritable(Path(parsed.report_dir), "--report-dir: ")
    with _package_path(getattr(parsed, "package_folders", ())):
        return run(parsed)


def _abandon_stdout() -> None:
    """Lead standard output nowhere, so that what it still holds is no error at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _handle(handler: Callable[[int, FrameType | None], object]) -> None:
    """Let Ctrl-C, SIGTERM and SIGHUP do this, unless whoever started the process ignores them."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, handler)


def _use_utf8() -> None:
    """Start again in Python's UTF-8 mode where the locale has another encoding.

    Names and contents of files are UTF-8 whatever the locale says; the terminal keeps its encoding.
    """
    if sys.flags.utf8_mode or sys.getfilesystemencoding() == "utf-8" or not sys.executable:
        return
    environment = {**os.environ, "PYTHONUTF8": "1"}
    if sys.stdout is not None:  # pyright: ignore[reportUnnecessaryComparison] - it was closed
        environment.setdefault("PYTHONIOENCODING", f"{sys.stdout.encoding}:backslashreplace")
    os.execve(sys.executable, [sys.executable, *sys.orig_argv[1:]], environment)


def _prepare_streams() -> None:
    """Lead standard streams that are closed nowhere, and let no character be refused."""
    for number, name in enumerate(STREAMS):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # the lowest number: this one
        if getattr(sys, name) is None:
            stream = open(number, "w" if number else "r", encoding="utf-8")  # noqa: SIM115, PTH123
            setattr(sys, name, stream)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="backslashreplace")  # pyright: ignore[reportAttributeAccessIssue]


def _flushed(code: int) -> int:
    """The exit code, or that of an error where the last words cannot be written."""
    try:
        sys.stdout.flush()
    except OSError as error:
        return _unwritable(error)
    return code


def _unwritable(error: OSError) -> int:
    from harness.cli.output import complain

    if isinstance(error, BrokenPipeError):
        return BROKEN_PIPE_EXIT_CODE
    complain(f"harness: standard output cannot be written: {error.strerror}")
    return EXIT_CODES["error"]


def _package_path(folders: Sequence[Path]) -> AbstractContextManager[None]:
    from contextlib import nullcontext

    if not folders:
        return nullcontext()
    from harness.robot.packages import additional_package_folders

    return additional_package_folders(folders)


def _load_plugins(modules: Sequence[str]) -> bool:
    """Load the modules of `--plugin`; what is wrong with one is printed."""
    if not modules:
        return True
    from harness.cli.output import complain
    from harness.core.registry import PluginError, load_plugin

    try:
        for module in modules:
            load_plugin(module)
    except PluginError as error:
        complain(f"harness: {error}")
        return False
    return True


def parser_of(words: Sequence[str]) -> Parser:
    """The parser of the command that the words name, or of all commands where they name none."""
    from harness import __version__
    from harness.cli.arguments import CommandParser, Parser
    from harness.core.registry import registry

    parser = Parser(
        prog="harness",
        usage="harness [-h] [--version] COMMAND ...",
        description="Run scenarios of robot arms: planned, simulated, judged, reported.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"armharness {__version__}")
    parsers = parser.add_subparsers(
        prog="harness",
        metavar="COMMAND",
        dest="command",
        parser_class=CommandParser,
        help=argparse.SUPPRESS,
    )
    known = registry("command")
    named = [word for word in words[:1] if word in known.built_in_modules]
    commands: dict[str, Command] = {name: known[name]() for name in named or _all_commands()}
    for name, command in commands.items():
        added = parsers.add_parser(name, description=command.summary())
        added.set_defaults(implementation=command)
        added.add_options = command.add_options
    parser.epilog = f"{_grouped(commands)}\n{EPILOG}"
    return parser


def _grouped(commands: Mapping[str, Command]) -> str:
    """The commands with their summaries, under the titles of their groups."""
    from harness.cli.command import GROUPS, OTHERS

    width = max(map(len, commands)) + 2
    text = ""
    for group in GROUPS:
        lines = [
            f"    {name:{width}}{(said := each.summary())[0].lower()}{said[1:].rstrip('.')}\n"
            for name, each in commands.items()
            if group == (each.group if each.group in GROUPS else OTHERS)
        ]
        text += "".join([f"{group}:\n", *lines, "\n"]) if lines else ""
    return text


def _all_commands() -> list[str]:
    """The names of all commands; what is wrong with the plug-ins of a package is printed."""
    from harness.cli.output import complain
    from harness.core.registry import PluginError, broken_plugins, registry

    known = registry("command")
    try:
        broken, names = broken_plugins(), list(known)
    except PluginError as error:
        broken, names = [str(error)], list(known.built_in_modules)
    for reason in broken:
        complain(f"harness: {reason}")
    return names
