"""The options of every command: read by `--help`, so nothing here takes time to import."""

from __future__ import annotations

import argparse

from harness.cli.arguments import (
    batch_size,
    factor,
    folder,
    metres,
    names_of,
    object_topic,
    override_argument,
    port_number,
    radians,
    rate,
    seconds,
    share,
    whole_number,
)
from harness.cli.robot_options import ROBOT, add_robot_options

IMPORTS = ("sdf", "scene", "srdf", "moveit")
FORMATS = ("full", "short", "json", "github")
BAGS = ("mcap", "sqlite3")
DOUBTS = ("publishers", "tf", "frames", "steps", "velocities")
LISTS = (
    "robots",
    "worlds",
    "scenarios",
    "steps",
    "expectations",
    "planners",
    "pipelines",
    "ik-solvers",
    "controllers",
    "world-formats",
    "reporters",
)

STRICT = "fail where a verdict has a warning, such as `already true at the start`"


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


def for_run(run: argparse.ArgumentParser) -> None:
    """Add the options of `harness run`."""
    _file_options(run)
    run.add_argument(
        "-k",
        metavar="EXPR",
        dest="expression",
        default="",
        help="run only scenarios whose path, title or tags match: 'pick and not ur5e'",
    )
    run.add_argument(
        "-j",
        metavar="N",
        dest="workers",
        type=whole_number,
        default=1,
        help="run N scenarios side by side",
    )
    run.add_argument(
        "--repeat",
        metavar="N",
        type=whole_number,
        default=1,
        help="run each case N times and report whether all digests are equal",
    )
    run.add_argument(
        "--case",
        metavar="NAME",
        dest="cases",
        action="append",
        default=[],
        help="run only the case of this name, or the cases whose names match a pattern: 'ur5e-*'",
    )
    run.add_argument(
        "--samples",
        metavar="N",
        type=whole_number,
        default=None,
        help="draw this many samples, instead of the number in the file",
    )
    run.add_argument(
        "--keep",
        choices=("all", "failed"),
        default="",
        help="write the reports of all cases, or only of those that failed (default: all; of"
        " samples,"
        " those that failed)",
    )
    run.add_argument(
        "--resume",
        action="store_true",
        help="continue where the same command was interrupted, and keep the results that exist",
    )
    run.add_argument(
        "--strict",
        action="store_true",
        help=STRICT,
    )
    run.add_argument(
        "--report-dir",
        metavar="DIR",
        default="reports",
        help="write reports into this folder (default: reports)",
    )
    run.add_argument(
        "--shard",
        metavar="N/COUNT",
        default="",
        help="run part N of COUNT of the suite, or with 'auto' the part that SLURM, Kubernetes or"
        " GitLab names; `harness merge` joins the parts",
    )
    run.add_argument(
        "--conditions",
        metavar="FILE",
        default="",
        help="run the samples of an earlier run, by its conditions.jsonl or its report folder,"
        " instead of drawing new ones: the same conditions for another version, robot or planner",
    )
    run.add_argument(
        "--on",
        metavar="CLUSTER",
        dest="cluster",
        default="",
        help="run the cases on Ray: 'ray' for processes of this machine (-j) or the cluster of"
        " RAY_ADDRESS, 'ray://HOST:PORT' for another cluster; needs the extra `cluster`",
    )
    run.add_argument("--no-report", action="store_true", help="write no report")
    run.add_argument(
        "--no-sharing",
        action="store_true",
        help="compute plans, physics and distances in every case, even those that are"
        " the same as in a case before",
    )
    run.add_argument("--no-page", action="store_true", help="write the report without its page")
    run.add_argument("--bag", action="store_true", help="write a rosbag2 into the report too")
    run.add_argument(
        "--reporter",
        metavar="NAME",
        dest="reporters",
        action="append",
        default=[],
        help="let a reporter of `harness list reporters` write into the report too; repeatable",
    )
    run.add_argument(
        "--history",
        metavar="DIR",
        default=None,
        help="show the margins of the earlier results.json files in this folder on the suite's"
        " page",
    )
    _format_options(run)
    run.add_argument(
        "--hard-cap",
        metavar="SECONDS",
        type=seconds,
        default=None,
        help="end a scenario as an error after this wall time (default: 600)",
    )
    run.add_argument("--node", metavar="[NAME=]COMMAND", dest="nodes", action="append", default=[],
                     help="allow the step `external` to start this command;"
                          " repeatable")  # fmt: skip
    run.add_argument("--robot", choices=("simulated", "ros2"), default="simulated",
                     help="with ros2, plan here and let the controllers of a ROS 2 robot"
                          " execute, after"
                     " the plan is printed and confirmed")  # fmt: skip
    run.add_argument(
        "--yes", action="store_true", help="with --robot ros2: confirm the plan in advance"
    )
    run.add_argument("--velocity-scaling", metavar="SHARE", type=share, default=1.0,
                     help="with --robot ros2: scale the planned speed by this share (default:"
                          " 1)")  # fmt: skip
    _domain_options(run)
    run.add_argument("--live", action="store_true",
                     help="show the cases on a page of this machine while they run; needs the extra"
                     " `studio`")  # fmt: skip
    run.add_argument("--in-process", action="store_true",
                     help="run all cases in this process, for a debugger")  # fmt: skip


def for_search(search: argparse.ArgumentParser) -> None:
    """Add the options of `harness search`."""
    add = search.add_argument
    add("file", metavar="FILE", help="a scenario file with `randomize`, or a bundled name")
    _value_options(search)
    add("--seed", metavar="N", type=int, default=None,
        help="use this seed for every run and for the search, instead of the file's")  # fmt: skip
    add(
        "--case",
        metavar="NAME",
        default="",
        help="search this parametrised case, where the file has several",
    )
    add("--runs", metavar="N", type=whole_number, default=None,
        help="make N runs, not counting those that shrink a failure"
             " (default: the file's `search`, or 100)")  # fmt: skip
    add("--start", metavar="N", type=whole_number, default=None,
        help="begin with N low-discrepancy samples, which estimate the failure rate"
             " (default: the file's, or 32)")  # fmt: skip
    add("--batch", metavar="N", type=batch_size, default=None,
        help="let the optimiser propose N runs at a time"
             " (default: the file's, or 4 + 3 ln(number of parameters))")  # fmt: skip
    add("--minimise", metavar="NAME", default=None,
        help="minimise the margin of this expectation"
             " (default: the file's, or the worst margin)")  # fmt: skip
    add("-j", metavar="N", dest="workers", type=whole_number, default=1,
        help="make N runs side by side")  # fmt: skip
    add("--resume", action="store_true",
        help="continue where the same command was interrupted, and keep the results that"
             " exist")  # fmt: skip
    add("--hard-cap", metavar="SECONDS", type=seconds, default=None,
        help="end a run as an error after this wall time (default: 600)")  # fmt: skip
    add("--report-dir", metavar="DIR", default="reports",
        help="write files into DIR/search (default: reports)")  # fmt: skip
    add("--json", action="store_true", help="print one JSON document on standard output")


def for_results(results: argparse.ArgumentParser) -> None:
    """Add the options of `harness results`."""
    add = results.add_argument
    add("folder", metavar="DIR", help="the report folder of a suite")
    add("--outcome", choices=("passed", "failed", "invalid", "error"), default="",
        help="select runs with this outcome")  # fmt: skip
    add("--tag", metavar="TAG", dest="tags", action="append", default=[],
        help="select runs whose file has this tag; repeatable")  # fmt: skip
    add("--cause", metavar="TEXT", default="",
        help="select failures whose cause contains this text")  # fmt: skip
    add("--where", metavar="NAME<VALUE", dest="conditions", action="append", default=[],
        help="select runs in which this holds for a parameter, or for `margin`, `share`, `seed` or"
             " `sim_time`; repeatable: --where 'friction<0.4' --where 'margin<1 mm'")  # fmt: skip
    add("--limit", metavar="N", type=whole_number, default=None,
        help="print at most N runs (default: 20)")  # fmt: skip
    add("--against", metavar="DIR", default="",
        help="compare with another campaign on the same conditions: exit code 1 when that one has"
             " a lower success rate")  # fmt: skip
    add("--csv", metavar="FILE", default="", help="write the selected runs as CSV")
    add("--parquet", metavar="FILE", default="",
        help="write the selected runs as Parquet; needs the extra `parquet`")  # fmt: skip
    add("--json", action="store_true", help="print one JSON document on standard output")


def for_merge(merge: argparse.ArgumentParser) -> None:
    """Add the options of `harness merge`."""
    merge.add_argument(
        "folders", metavar="DIR", nargs="+", help="a report folder of `harness run --shard`"
    )
    merge.add_argument(
        "--report-dir",
        metavar="DIR",
        default="reports",
        help="write the results into this folder (default: reports)",
    )
    merge.add_argument(
        "--history",
        metavar="DIR",
        default=None,
        help="show the margins of the earlier results.json files in this folder on the suite's"
        " page",
    )
    _format_options(merge)


def for_check(check: argparse.ArgumentParser) -> None:
    """Add the options of `harness check`."""
    _file_options(check)
    _format_options(check)


def for_explain(explain: argparse.ArgumentParser) -> None:
    """Add the options of `harness explain`."""
    _file_options(explain)


def for_bench(bench: argparse.ArgumentParser) -> None:
    """Add the options of `harness bench`."""
    _paths(bench)
    bench.add_argument(
        "--planners",
        metavar="A,B",
        type=names_of,
        default=[],
        help="planners and pipelines to compare (default: all that `harness list planners` names)",
    )
    bench.add_argument(
        "--seeds",
        metavar="N",
        type=whole_number,
        default=5,
        help="plan with seeds 1 to N (default: 5)",
    )
    bench.add_argument(
        "--report-dir",
        metavar="DIR",
        default="reports",
        help="write files into DIR/bench (default: reports)",
    )
    bench.add_argument("--no-report", action="store_true", help="write no files")
    bench.add_argument(
        "--json", action="store_true", help="print one JSON document on standard output"
    )


def for_list(listing: argparse.ArgumentParser) -> None:
    """Add the options of `harness list`."""
    listing.add_argument("kind", choices=LISTS)
    _plugin_option(listing)


def for_view(view: argparse.ArgumentParser) -> None:
    """Add the options of `harness view`."""
    view.add_argument("run", metavar="RUN", help="the run's report folder, or a file in it;"
                      " append '#t=10.1' to open that moment")  # fmt: skip
    view.add_argument(
        "--rebuild", action="store_true", help="write the page again from the saved run"
    )
    view.add_argument(
        "--no-open", action="store_true", help="print the path of the page and open no browser"
    )


def for_judge(judge: argparse.ArgumentParser) -> None:
    """Add the options of `harness judge`."""
    judge.add_argument("folder", metavar="RUN", help="the run's report folder")
    judge.add_argument("--with", metavar="FILE", dest="with_file",
                       help="judge by the expectations of this scenario instead")  # fmt: skip
    _plugin_option(judge)
    judge.add_argument("--contacts", action="store_true",
                       help="list all contacts: bodies, first time, duration, peak"
                            " force")  # fmt: skip
    judge.add_argument("--strict", action="store_true", help=STRICT)
    judge.add_argument(
        "--json", action="store_true", help="print one JSON document on standard output"
    )


def for_grade(grade: argparse.ArgumentParser) -> None:
    """Add the options of `harness grade`."""
    grade.add_argument("scenario", metavar="SCENARIO", help="a scenario file, or a bundled name")
    _plugin_option(grade)
    grade.add_argument("bag", metavar="BAG", nargs="?", default="",
                       help="a rosbag2 folder, .mcap or .db3 file; or give --node")  # fmt: skip
    _node_options(grade)
    grade.add_argument("--timeout", metavar="SECONDS", type=seconds, default=60.0,
                       help="give the nodes this simulated time where no step is `external`"
                       " (default: 60)")  # fmt: skip
    grade.add_argument("--joint-states", metavar="TOPIC", default="/joint_states",
                       help="read the joint positions from this topic (default:"
                            " /joint_states)")  # fmt: skip
    grade.add_argument("--objects", metavar="TOPIC", action="append", default=[],
                       help="read poses of objects by name from this topic: TFMessage, as"
                            " Gazebo's bridge"
                       " sends them, or ModelStates")  # fmt: skip
    grade.add_argument("--object", metavar="NAME=TOPIC", dest="object_poses", action="append",
                       type=object_topic, default=[],
                       help="read the pose of one object from this topic")  # fmt: skip
    grade.add_argument("--set", metavar="PATH=VALUE", dest="overrides", action="append",
                       type=override_argument, default=[],
                       help="change a value of the file")  # fmt: skip
    grade.add_argument("--allow", metavar="DOUBT", dest="allowed", action="append", default=[],
                       choices=DOUBTS,
                       help="award points in spite of a doubt about the recording: "
                       + ", ".join(DOUBTS))  # fmt: skip
    _package_option(grade)
    grade.add_argument(
        "--json", action="store_true", help="print one JSON document on standard output"
    )


def for_bridge(bridge: argparse.ArgumentParser) -> None:
    """Add the options of `harness bridge`."""
    bridge.add_argument("scenario", metavar="SCENARIO", help="a scenario file, or a bundled name")
    _node_options(bridge)
    bridge.add_argument("--duration", metavar="SECONDS", type=seconds, default=None,
                        help="end after this simulated time where no step is `external`"
                        " (default: 600)")  # fmt: skip
    bridge.add_argument("--set", metavar="PATH=VALUE", dest="overrides", action="append",
                        type=override_argument, default=[],
                        help="change a value of the file")  # fmt: skip
    _package_option(bridge)
    _plugin_option(bridge)
    bridge.set_defaults(command="bridge")


def for_replay(replay: argparse.ArgumentParser) -> None:
    """Add the options of `harness replay`."""
    replay.add_argument("run", metavar="RUN", help="the run's report folder")
    replay.add_argument("--report-dir", metavar="DIR", default="",
                        help="write the replayed run into this folder")  # fmt: skip
    replay.add_argument(
        "--json", action="store_true", help="print one JSON document on standard output"
    )
    _plugin_option(replay)
    replay.set_defaults(command="replay")


def _node_options(command: argparse.ArgumentParser) -> None:
    """Add the options of commands that serve a robot to ROS 2 nodes."""
    add = command.add_argument
    add("--node", metavar="[NAME=]COMMAND", dest="nodes", action="append", default=[],
        help="allow the scenario to start this command: 'python student.py';"
             " repeatable")  # fmt: skip
    _domain_options(command)
    add("--pace", metavar="FACTOR", type=factor, default=1.0,
        help="advance this many simulated seconds in one second of wall time (default:"
             " 1)")  # fmt: skip
    add("--seed", metavar="N", type=int, default=None, help="use this seed instead of the file's")
    add("--report-dir", metavar="DIR", default="reports",
        help="write reports into this folder (default: reports)")  # fmt: skip
    add("--no-report", action="store_true", help="write no report")


def _domain_options(command: argparse.ArgumentParser) -> None:
    """Add the options of commands that join a ROS domain."""
    add = command.add_argument
    add("--domain", metavar="N", type=int, default=None,
        help="join this ROS domain (default: ROS_DOMAIN_ID or 0; with --node, a free"
             " one)")  # fmt: skip
    add("--network", action="store_true", help="communicate with nodes on other machines too")
    add("--adapter", choices=("rtps", "rclpy"), default="rtps",
        help="communicate through the built-in RTPS, or through an installed rclpy")  # fmt: skip


def for_compare(compare: argparse.ArgumentParser) -> None:
    """Add the options of `harness compare`."""
    compare.add_argument("first", metavar="RUN", help="the report folder of a run")
    compare.add_argument("second", metavar="RUN", help="the report folder of another run")
    compare.add_argument(
        "--json", action="store_true", help="print one JSON document on standard output"
    )


def for_new(new: argparse.ArgumentParser) -> None:
    """Add the options of `harness new`."""
    new.add_argument(
        "file", metavar="FILE", help="the scenario file to write, for example first.scenario.yaml"
    )
    new.add_argument("--robot", metavar="ROBOT", default="", help=ROBOT)
    add_robot_options(new)


def for_export(export: argparse.ArgumentParser) -> None:
    """Add the options of `harness export`."""
    export.add_argument("run", metavar="RUN", help="the run's report folder")
    export.add_argument("--bag", metavar="DIR", help="write a rosbag2 into this new folder")
    export.add_argument("--urdf", metavar="FILE", help="write the robot's URDF")
    export.add_argument("--storage", choices=BAGS, default="mcap",
                        help="store the bag in this format (default: mcap,"
                             " compressed)")  # fmt: skip
    export.add_argument("--rate", metavar="HZ", type=rate, default=100.0,
                        help="write joints, frames and clock at this rate (default:"
                             " 100)")  # fmt: skip
    export.add_argument("--raw-images", action="store_true",
                        help="write the cameras' pictures uncompressed too")  # fmt: skip
    export.add_argument("--meshes", choices=("package", "file"), default="package",
                        help="how the URDF names mesh files: as package://, or where they are"
                        " on this machine")  # fmt: skip
    export.add_argument("--force", action="store_true", help="overwrite what is there")


def for_import(importing: argparse.ArgumentParser) -> None:
    """Add the options of `harness import`."""
    importing.add_argument("kind", choices=IMPORTS, help="the format of FILE")
    importing.add_argument("files", metavar="FILE", nargs="+",
                           help="an SDF world, a MoveIt .scene or an SRDF; for `moveit`, any number"
                           " of PlanningScene and MotionPlanRequest files in YAML")  # fmt: skip
    importing.add_argument("-o", "--output", metavar="FILE",
                           help="write to this path (default: FILE's name with .yaml; of an SRDF"
                           " a folder of FILE's name; for `moveit` the folder `scenarios`"
                           " next to the first FILE)")  # fmt: skip
    importing.add_argument("--model-path", metavar="DIR", action="append", default=[],
                           help="look models up in this folder before"
                                " GZ_SIM_RESOURCE_PATH")  # fmt: skip
    importing.add_argument("--force", action="store_true", help="overwrite what is there")
    importing.add_argument("--robot", metavar="FILE", default="",
                           help="the robot of an SRDF or of MoveIt's files: a URDF, xacro or"
                           " MJCF; for `moveit` also a bundled name")  # fmt: skip
    add_robot_options(importing)


def for_ik_test(test: argparse.ArgumentParser) -> None:
    """Add the options of `harness ik-test`."""
    add = test.add_argument
    add(
        "solver",
        metavar="SOLVER",
        help="module:function, file.py:function, a name of `harness list ik-solvers`, or `own` for"
        " the robot's own solver",
    )
    _plugin_option(test)
    add("--robot", metavar="ROBOT", required=True, help=ROBOT)
    add_robot_options(test)
    add(
        "--link",
        metavar="LINK",
        default="",
        help="place this link at the targets (default: the TCP)",
    )
    add(
        "--branches",
        action="store_true",
        help="the function claims to return every solution for a target",
    )
    add("--examples", metavar="N", type=whole_number, default=100,
        help="try N cases of each property (default: 100)")  # fmt: skip
    add(
        "--seed",
        metavar="N",
        type=int,
        default=0,
        help="draw the cases with this seed (default: 0)",
    )
    add("--position-tolerance", metavar="M", type=metres, default=1e-4,
        help="accept answers within this distance of the target [m] (default: 0.0001)")  # fmt: skip
    add("--orientation-tolerance", metavar="RAD", type=radians, default=1e-3,
        help="accept answers within this angle of the target [rad] (default: 0.001)")  # fmt: skip
    add("--call-limit", metavar="SECONDS", type=seconds, default=5.0,
        help="count a call as hanging after this wall time (default: 5)")  # fmt: skip
    add("--report-dir", metavar="DIR", default="reports",
        help="write reports into this folder (default: reports)")  # fmt: skip
    add("--no-report", action="store_true", help="write no report and no pictures")
    add("--json", action="store_true", help="print one JSON document on standard output")


def for_robot(robot: argparse.ArgumentParser) -> None:
    """Add the options of `harness robot`."""
    actions = robot.add_subparsers(dest="action", metavar="ACTION", required=True)
    check = actions.add_parser(
        "check",
        help="check limits, masses, kinematics, self-collisions and reach",
        description="Check a robot; the exit code is 1 when something is wrong.",
    )
    show = actions.add_parser("show", help="draw the robot", description="Draw a robot.")
    for action in (check, show):
        action.add_argument("robot", metavar="ROBOT", help=f"{ROBOT}; or a scenario")
        add_robot_options(action)
        action.add_argument("--state", metavar="NAME", default="",
                            help="draw the robot in this named state (default: the"
                                 " start)")  # fmt: skip
        action.add_argument(
            "--image", metavar="FILE", default="", help="write the picture to this PNG or JPEG file"
        )
    check.add_argument("--samples", metavar="N", type=whole_number, default=None,
                       help="check N random configurations (default: 2000; for an SRDF"
                            " 10000)")  # fmt: skip
    check.add_argument(
        "--seed", metavar="N", type=int, default=0, help="draw them with this seed (default: 0)"
    )
    check.add_argument("--write-srdf", metavar="FILE", default="",
                       help="write an SRDF that disables the pairs that need no collision"
                            " check")  # fmt: skip
    check.add_argument("--force", action="store_true", help="overwrite that file")
    check.add_argument(
        "--json", action="store_true", help="print one JSON document on standard output"
    )


def for_studio(studio: argparse.ArgumentParser) -> None:
    """Add the options of `harness studio`."""
    add = studio.add_argument
    add("target", metavar="ROBOT|SCENARIO|RUN", nargs="?", default="open_manipulator_x",
        help=f"{ROBOT}; a scenario; a run's folder (default: open_manipulator_x)")  # fmt: skip
    add("--at", metavar="SECONDS", type=seconds, default=None,
        help="with a run: continue by hand from this time (default: 0)")  # fmt: skip
    add(
        "--world",
        metavar="WORLD",
        default="",
        help="put the robot into this bundled world or world file",
    )
    add("--gripper", metavar="NAME", default="", help="mount this bundled gripper on the robot")
    add("--port", metavar="N", type=port_number, default=8011,
        help="serve the page on this port; 0 selects a free one (default: 8011)")  # fmt: skip
    add("--host", metavar="ADDRESS", default="",
        help="listen on this address instead of loopback; the URL then contains a"
             " token")  # fmt: skip
    add("--no-open", action="store_true", help="print the address and open no browser")
    _plugin_option(studio)


def for_schema(schema: argparse.ArgumentParser) -> None:
    """Add the options of `harness schema`."""
    schema.add_argument(
        "--write", metavar="FILE", help="write the schema to this file instead of standard output"
    )
    _plugin_option(schema)


def _file_options(command: argparse.ArgumentParser) -> None:
    _paths(command)
    command.add_argument("--seed", metavar="N", type=int, default=None,
                         help="use this seed instead of the file's")  # fmt: skip


def _paths(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "paths",
        metavar="PATH",
        nargs="+",
        help="a scenario file, a folder of *.scenario.yaml, or a bundled name",
    )
    _value_options(command)


def _value_options(command: argparse.ArgumentParser) -> None:
    """Add the options of every command that prepares scenarios: values, packages and plug-ins."""
    command.add_argument(
        "--set",
        metavar="PATH=VALUE",
        dest="overrides",
        action="append",
        type=override_argument,
        default=[],
        help="change a value of the file: --set robot.model=ur5e, --set objects.cube.mass=1",
    )
    _package_option(command)
    _plugin_option(command)


def _plugin_option(command: argparse.ArgumentParser) -> None:
    """Add the options of every command that reads scenario files."""
    command.add_argument(
        "--plugin",
        metavar="MODULE",
        dest="plugins",
        action="append",
        default=[],
        help="load the plug-ins of a Python module (its name, or a .py file)",
    )


def _package_option(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--package-path",
        metavar="DIR",
        dest="package_folders",
        action="append",
        type=folder,
        default=[],
        help="look package:// up in this folder, and allow meshes to be read there",
    )
