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
from harness.cli.robot_options import ROBOT, add_robot_options

EPILOG = """exit codes: 0 passed, 1 failed, 2 invalid file or wrong usage, 3 error, 130 Ctrl-C"""
BROKEN_PIPE_EXIT_CODE = 141  # as a shell shows SIGPIPE
IMPORTS = ("sdf", "scene", "srdf")
FORMATS = ("full", "short", "json", "github")
BAGS = ("mcap", "sqlite3")
LISTS = ("robots", "worlds", "scenarios", "steps", "expectations", "planners")


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
    command = importlib.import_module(f"harness.cli.{parsed.module}")
    try:
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

    _run_options(command("run", "run scenarios and judge them"))
    _check_options(command("check", "validate scenarios and the reach of their goals"))
    _file_options(command("explain", "print the program that a scenario becomes"))
    _list_options(command("list", "list what a scenario may name", module="listing"))
    _view_options(command("view", "open the page of a run"))
    _judge_options(command("judge", "judge a saved run again"))
    _grade_options(command("grade", "grade a recording of another program by a scenario"))
    _compare_options(command("compare", "tell what changed from one saved run to another"))
    _new_options(command("new", "write a commented scenario that passes"))
    _export_options(command("export", "write a saved run as a rosbag2, and its robot as a URDF"))
    _import_options(command("import", "write files of other programs as ours", module="importing"))
    _robot_options(command("robot", "look a robot over, or draw it"))
    _ik_test_options(command("ik-test", "test a function that solves inverse kinematics",
                             module="ik_test"))  # fmt: skip
    _bench_options(command("bench", "compare planners on the motions of scenarios"))
    _schema_options(command("schema", "print the JSON Schema of scenario files"))
    return parser


def _format_options(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--format",
        choices=FORMATS,
        default="full",
        help="full: for people; short: a line each; json: one document; github: annotations",
    )
    command.add_argument(
        "--json",
        action="store_const",
        const="json",
        dest="format",
        help="the same as --format json",
    )


def _run_options(run: argparse.ArgumentParser) -> None:
    _file_options(run)
    run.add_argument(
        "-k",
        metavar="EXPR",
        dest="expression",
        default="",
        help="only scenarios whose path, title or tags match: 'pick and not ur5e'",
    )
    run.add_argument(
        "-j",
        metavar="N",
        dest="workers",
        type=_count,
        default=1,
        help="run N scenarios side by side",
    )
    run.add_argument(
        "--repeat",
        metavar="N",
        type=_count,
        default=1,
        help="run each N times and say whether all digests are the same",
    )
    run.add_argument(
        "--case",
        metavar="NAME",
        dest="cases",
        action="append",
        default=[],
        help="only the case of this name, or of names that match: 'ur5e-*'",
    )
    run.add_argument(
        "--samples", metavar="N", type=_count, default=None, help="in place of the file's"
    )
    run.add_argument(
        "--keep",
        choices=("all", "failed"),
        default="",
        help="whose reports are written (default: all; of samples those that failed)",
    )
    run.add_argument(
        "--resume",
        action="store_true",
        help="go on where the same command was interrupted, without computing again",
    )
    run.add_argument(
        "--report-dir", metavar="DIR", default="reports", help="where reports go (default: reports)"
    )
    run.add_argument("--no-report", action="store_true", help="write no report")
    run.add_argument("--no-page", action="store_true", help="write the report without its page")
    run.add_argument("--bag", action="store_true", help="write a rosbag2 into the report too")
    run.add_argument(
        "--history",
        metavar="DIR",
        default=None,
        help="a folder of earlier results.json files, whose margins the suite's page shows",
    )
    _format_options(run)
    run.add_argument(
        "--hard-cap",
        metavar="SECONDS",
        type=_seconds,
        default=None,
        help="wall time after which a scenario ends as an error (default: 600)",
    )
    run.add_argument("--in-process", action="store_true",
                     help="no process for each scenario: for debuggers")  # fmt: skip


def _check_options(check: argparse.ArgumentParser) -> None:
    _file_options(check)
    _format_options(check)


def _bench_options(bench: argparse.ArgumentParser) -> None:
    _paths(bench)
    bench.add_argument(
        "--planners",
        metavar="A,B",
        type=_names,
        default=[],
        help="planner ids to compare (default: all that `harness list planners` names)",
    )
    bench.add_argument(
        "--seeds", metavar="N", type=_count, default=5, help="plan with seeds 1 to N (default: 5)"
    )
    bench.add_argument(
        "--report-dir", metavar="DIR", default="reports", help="files go to DIR/bench"
    )
    bench.add_argument("--no-report", action="store_true", help="write no files")
    bench.add_argument("--json", action="store_true", help="one JSON document on stdout")


def _list_options(listing: argparse.ArgumentParser) -> None:
    listing.add_argument("kind", choices=LISTS)


def _view_options(view: argparse.ArgumentParser) -> None:
    view.add_argument("run", metavar="RUN", help="the run's report folder, or a file in it;"
                      " '#t=10.1' behind it opens that moment")  # fmt: skip
    view.add_argument("--rebuild", action="store_true", help="write the page anew")
    view.add_argument("--no-open", action="store_true", help="only say where the page is")


def _judge_options(judge: argparse.ArgumentParser) -> None:
    judge.add_argument("folder", metavar="RUN", help="the run's report folder")
    judge.add_argument("--with", metavar="FILE", dest="with_file",
                       help="by the expectations of this scenario")  # fmt: skip
    judge.add_argument("--contacts", action="store_true",
                       help="list who touched whom: first time, duration, peak force")  # fmt: skip
    judge.add_argument("--json", action="store_true", help="one JSON document on stdout")


def _grade_options(grade: argparse.ArgumentParser) -> None:
    grade.add_argument("scenario", metavar="SCENARIO", help="a scenario file, or a bundled name")
    grade.add_argument("bag", metavar="BAG", help="a rosbag2 folder, an .mcap or a .db3 file")
    grade.add_argument("--joint-states", metavar="TOPIC", default="/joint_states",
                       help="where the joints are (default: /joint_states)")  # fmt: skip
    grade.add_argument("--objects", metavar="TOPIC", action="append", default=[],
                       help="a topic with poses of objects by name: TFMessage, as Gazebo's bridge"
                       " sends them, or ModelStates")  # fmt: skip
    grade.add_argument("--object", metavar="NAME=TOPIC", dest="object_poses", action="append",
                       type=_object_topic, default=[],
                       help="the topic with the pose of one object")  # fmt: skip
    grade.add_argument("--set", metavar="PATH=VALUE", dest="overrides", action="append",
                       type=_override, default=[], help="change a value of the file")  # fmt: skip
    _package_option(grade)
    grade.add_argument("--json", action="store_true", help="one JSON document on stdout")


def _compare_options(compare: argparse.ArgumentParser) -> None:
    compare.add_argument("first", metavar="RUN", help="a run's report folder")
    compare.add_argument("second", metavar="RUN", help="another")
    compare.add_argument("--json", action="store_true", help="one JSON document on stdout")


def _new_options(new: argparse.ArgumentParser) -> None:
    new.add_argument("file", metavar="FILE", help="for example first.scenario.yaml")
    new.add_argument("--robot", metavar="ROBOT", default="", help=ROBOT)
    add_robot_options(new)


def _export_options(export: argparse.ArgumentParser) -> None:
    export.add_argument("run", metavar="RUN", help="the run's report folder")
    export.add_argument("--bag", metavar="DIR", help="write a rosbag2 into this new folder")
    export.add_argument("--urdf", metavar="FILE", help="write the robot's URDF")
    export.add_argument("--storage", choices=BAGS, default="mcap",
                        help="of the bag (default: mcap, compressed)")  # fmt: skip
    export.add_argument("--rate", metavar="HZ", type=_rate, default=100.0,
                        help="of joints, frames and clock (default: 100)")  # fmt: skip
    export.add_argument("--raw-images", action="store_true",
                        help="the cameras' pictures uncompressed too")  # fmt: skip
    export.add_argument("--meshes", choices=("package", "file"), default="package",
                        help="how the URDF names mesh files: as package://, or where they are"
                        " on this machine")  # fmt: skip
    export.add_argument("--force", action="store_true", help="overwrite what is there")


def _import_options(importing: argparse.ArgumentParser) -> None:
    importing.add_argument("kind", choices=IMPORTS, help="what FILE is")
    importing.add_argument("file", metavar="FILE", help="an SDF world, a MoveIt scene or an SRDF")
    importing.add_argument("-o", "--output", metavar="FILE",
                           help="what to write (default: FILE's name with .yaml; of an SRDF"
                           " a folder of FILE's name)")  # fmt: skip
    importing.add_argument("--model-path", metavar="DIR", action="append", default=[],
                           help="look models up here before GZ_SIM_RESOURCE_PATH")  # fmt: skip
    importing.add_argument("--force", action="store_true", help="overwrite what is there")
    importing.add_argument("--robot", metavar="FILE", default="",
                           help="the URDF, xacro or MJCF that an SRDF is of")  # fmt: skip
    add_robot_options(importing, has_srdf=False)


def _ik_test_options(test: argparse.ArgumentParser) -> None:
    add = test.add_argument
    add("solver", metavar="SOLVER", help="module:function or file.py:function; `own` is ours")
    add("--robot", metavar="ROBOT", required=True, help=ROBOT)
    add_robot_options(test)
    add("--link", metavar="LINK", default="", help="that is placed (default: the TCP)")
    add("--branches", action="store_true", help="it claims to find every way to a target")
    add("--examples", metavar="N", type=_count, default=100,
        help="cases of each property (default: 100)")  # fmt: skip
    add("--seed", metavar="N", type=int, default=0, help="of the cases (default: 0)")
    add("--position-tolerance", metavar="M", type=_metres, default=1e-4,
        help="of answers [m] (default: 0.0001)")  # fmt: skip
    add("--orientation-tolerance", metavar="RAD", type=_radians, default=1e-3,
        help="of answers [rad] (default: 0.001)")  # fmt: skip
    add("--call-limit", metavar="SECONDS", type=_seconds, default=5.0,
        help="wall time after which a call hangs (default: 5)")  # fmt: skip
    add("--report-dir", metavar="DIR", default="reports",
        help="where reports go (default: reports)")  # fmt: skip
    add("--no-report", action="store_true", help="no report and no pictures")
    add("--json", action="store_true", help="one JSON document on stdout")


def _robot_options(robot: argparse.ArgumentParser) -> None:
    actions = robot.add_subparsers(dest="action", metavar="ACTION", required=True)
    check = actions.add_parser(
        "check",
        help="limits, masses, kinematics, self-collisions, reach",
        description="Look a robot over; exit code 1 when something is wrong.",
    )
    show = actions.add_parser("show", help="draw it", description="Draw a robot.")
    for action in (check, show):
        action.add_argument("robot", metavar="ROBOT", help=f"{ROBOT}; or a scenario")
        add_robot_options(action)
        action.add_argument("--state", metavar="NAME", default="",
                            help="for the picture: a named state (default: the start)")  # fmt: skip
        action.add_argument("--image", metavar="FILE", default="", help="a picture, PNG or JPEG")
    check.add_argument("--samples", metavar="N", type=_count, default=None,
                       help="random configurations (default: 2000; for an SRDF 10000)")  # fmt: skip
    check.add_argument("--seed", metavar="N", type=int, default=0, help="of them (default: 0)")
    check.add_argument("--write-srdf", metavar="FILE", default="",
                       help="write an SRDF with the pairs that need not be checked")  # fmt: skip
    check.add_argument("--force", action="store_true", help="overwrite that file")
    check.add_argument("--json", action="store_true", help="one JSON document on stdout")


def _schema_options(schema: argparse.ArgumentParser) -> None:
    schema.add_argument("--write", metavar="FILE", help="write it to a file instead")


def _file_options(command: argparse.ArgumentParser) -> None:
    _paths(command)
    command.add_argument("--seed", metavar="N", type=int, default=None,
                         help="in place of the file's")  # fmt: skip


def _paths(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "paths",
        metavar="PATH",
        nargs="+",
        help="a scenario file, a folder of *.scenario.yaml, or a bundled name",
    )
    command.add_argument(
        "--set",
        metavar="PATH=VALUE",
        dest="overrides",
        action="append",
        type=_override,
        default=[],
        help="change a value of the file: --set robot.model=ur5e",
    )
    _package_option(command)


def _package_option(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--package-path",
        metavar="DIR",
        dest="package_folders",
        action="append",
        type=_folder,
        default=[],
        help="where package:// is looked up and meshes may be read",
    )


def _folder(text: str) -> Path:
    if not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"there is no folder '{text}'")
    return Path(text)


def _override(text: str) -> tuple[str, str]:
    path, equals, value = text.partition("=")
    if not equals or not path.strip():
        raise argparse.ArgumentTypeError(f"'{text}' is not PATH=VALUE, as in robot.model=ur5e")
    return path.strip(), value


def _names(text: str) -> list[str]:
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not names:
        raise argparse.ArgumentTypeError("no planner is named")
    return list(dict.fromkeys(names))


def _object_topic(text: str) -> tuple[str, str]:
    name, equals, topic = text.partition("=")
    if not equals or not name.strip() or not topic.strip():
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=TOPIC, as in red_box=/red_box/pose")
    return name.strip(), topic.strip()


def _count(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number from 1")
    return int(text)


def _metres(text: str) -> float:
    return _positive(text, "metres")


def _radians(text: str) -> float:
    return _positive(text, "radians")


def _seconds(text: str) -> float:
    return _positive(text, "seconds")


def _rate(text: str) -> float:
    return _positive(text, "messages a second")


def _positive(text: str, what: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not 0 < number < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of {what} above 0")
    return number
