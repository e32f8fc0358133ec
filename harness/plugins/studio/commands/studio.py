"""`harness studio`: a robot cell in the browser, whose actions grow into a scenario."""

from __future__ import annotations

import argparse
import threading
from pathlib import Path
from typing import ClassVar

from harness.cli.arguments import seconds, whole_number_from
from harness.cli.command import SCENARIOS, Command
from harness.cli.commands.view import open_browser
from harness.cli.output import complain, say
from harness.cli.robot_options import ROBOT
from harness.cli.shared_options import add_plugin
from harness.core.extras import install_command
from harness.suite.discovery import SUFFIX, UsageError, discover


class StudioCommand(Command):
    """Open a robot cell in the browser, and make a scenario."""

    name: ClassVar[str] = "studio"
    group: ClassVar[str] = SCENARIOS
    collects_garbage: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness studio`."""
        add = command.add_argument
        text = f"{ROBOT}; a scenario; a run's folder (default: open_manipulator_x)"
        add(
            "target",
            metavar="ROBOT|SCENARIO|RUN",
            nargs="?",
            default="open_manipulator_x",
            help=text,
        )
        text = "with a run: continue by hand from this time (default: 0)"
        add("--at", metavar="SECONDS", type=_start_time, default=None, help=text)
        text = "put the robot into this bundled world or world file"
        add("--world", metavar="WORLD", default="", help=text)
        text = "mount this bundled gripper on the robot"
        add("--gripper", metavar="NAME", default="", help=text)
        text = (
            "put the robot's base at this place of the world [m], such as a table's top: 0 0 1.02"
        )
        add("--base", metavar=("X", "Y", "Z"), nargs=3, type=_coordinate, help=text)
        text = "serve the page on this port; 0 selects a free one (default: 8011)"
        add(
            "--port", metavar="N", type=whole_number_from(0, 65535, "port"), default=8011, help=text
        )
        text = "listen on this address instead of loopback; the URL then contains a token"
        add("--host", metavar="ADDRESS", default="", help=text)
        add("--no-open", action="store_true", help="print the address and open no browser")
        add_plugin(command)
        command.set_defaults(ticks=False)

    def run(self, arguments: argparse.Namespace) -> int:
        """Serve the studio until Ctrl-C."""
        refuse_missing_extra()
        from harness.plugins.studio.files import StudioFiles
        from harness.plugins.studio.guard import LOOPBACK, Guard
        from harness.plugins.studio.server import PortInUseError, StudioServer, page_assets
        from harness.plugins.studio.studio import Studio

        path, text, time = start_of(arguments)
        files = StudioFiles(Path.cwd(), path, [Path(arguments.target)])
        restored = files.restored()
        is_restored = restored is not None and restored != text
        notice = ""
        if is_restored:
            notice = (
                f"This is unsaved work that was found in {files.unsaved.name}."
                " Save keeps it; delete that file to begin again."
            )
        studio = Studio.opened(files, text, restored if is_restored else None, notice)
        if (
            studio.problems and not files.path.exists()
        ):  # what the command line names is the mistake
            raise UsageError("; ".join(each.sentence for each in studio.problems))
        if time:
            say(f"going on to t={time:g} s, as the run did")
            studio.cell.run_until(time)
        host = arguments.host or LOOPBACK[0]
        is_open = host not in ("127.0.0.1", "localhost", "::1")
        guard = Guard.of(page_assets(), is_open=is_open)
        try:
            server = StudioServer(host, arguments.port, guard, studio.session.handle)
        except PortInUseError as error:
            raise UsageError(str(error)) from error
        studio.open()
        shown = f"[{host}]" if ":" in host else host
        address = f"http://{shown}:{server.port}/"
        say(f"{address}?token={guard.token}" if guard.token else address)
        if is_open:
            complain("harness: whoever has this address can move the robot and write its file")
        if not arguments.no_open and not open_browser(address):
            complain(f"no browser could be opened here; open {address}")
        try:
            threading.Event().wait()  # until Ctrl-C or SIGTERM
        finally:
            studio.close()
        return 0


def refuse_missing_extra() -> None:
    """Refuse to go on without the packages of the extra `studio`.

    Raises:
        UsageError: A package is not installed.
    """
    try:
        import django_static_ace_builds as _ace  # noqa: F401 - only whether it is there
        import websockets as _websockets  # noqa: F401
    except ImportError as error:
        command = install_command("studio")
        raise UsageError(
            f"the studio needs packages that are not installed: {command} ({error})"
        ) from error


def start_of(arguments: argparse.Namespace) -> tuple[Path, str, float | None]:
    """The file that the studio saves to, the text with which it begins, and the time to go to."""
    from harness.language.files.yaml_file import read_text
    from harness.recording.stored_run import RESOLVED, RUN

    word: str = arguments.target
    if (Path(word) / RUN).is_file():
        text = read_text(Path(word) / RESOLVED)
        return Path(word) / f"continued{SUFFIX}", text, arguments.at or 0.0
    if arguments.at is not None:
        raise UsageError(f"--at is for the folder of a run, which '{word}' is not")
    return (*_text(word, arguments), None)


def _text(word: str, arguments: argparse.Namespace) -> tuple[Path, str]:
    from harness.language.files.yaml_file import read_text
    from harness.robot.load import robot_names
    from harness.robot.robot_source import RobotSource

    kind = RobotSource(word).kind
    is_file = kind not in ("model", "scenario") or (Path(word) / "robot.yaml").is_file()
    is_robot = is_file or word in robot_names()
    if not is_robot:
        return _scenario(word, arguments)
    from harness.plugins.studio.document import Plain, new_text

    robot = {kind: word, "gripper": arguments.gripper}
    stem = Path(word).name.partition(".")[0] or "robot"
    path = Path(f"{stem}_by_hand{SUFFIX}")
    if path.exists():
        if arguments.gripper or arguments.world or arguments.base is not None:
            raise UsageError(
                f"'{path}' exists and has a robot and a world of its own: rename or delete it, or"
                " leave --gripper, --world and --base out to go on with it"
            )
        return path, read_text(path)
    given: dict[str, Plain] = {key: value for key, value in robot.items() if value}
    if arguments.base is not None:
        given["base"] = {"xyz": arguments.base}
    return path, new_text(f"{stem} by hand", given, arguments.world or "empty")


def _scenario(word: str, arguments: argparse.Namespace) -> tuple[Path, str]:
    from harness.core.suggestion import did_you_mean
    from harness.language.files.yaml_file import read_text
    from harness.robot.load import robot_names

    if arguments.gripper or arguments.world or arguments.base is not None:
        raise UsageError("--gripper, --world and --base are for a robot; a scenario has its own")
    try:
        [file, *more] = discover([word])
    except UsageError as error:
        hint = did_you_mean(word, robot_names(), "robots")
        raise UsageError(f"{error}; no robot has that name either; {hint}") from error
    if more:
        raise UsageError(f"'{word}' has several scenarios; the studio opens one of them")
    text = read_text(file)
    is_inside = file.resolve().is_relative_to(Path.cwd())
    return (file if is_inside else Path(file.name)), text


def _coordinate(text: str) -> float:
    """A finite coordinate [m]."""
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not abs(number) < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}' is not a coordinate in metres, such as 1.02")
    return number


def _start_time(text: str) -> float:
    """A time of a run [s]: 0, or later."""
    return 0.0 if text in ("0", "0.0") else seconds(text)
