"""`harness run --robot ros2`: a robot's own controllers execute what is planned here."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.arguments import share_of_one
from harness.cli.output import complain, output, say
from harness.cli.run_mode import RunCall, RunFiles, RunMode
from harness.cli.suite_output import show_case
from harness.plugins.ros.options import add_domain
from harness.suite.discovery import UsageError
from harness.suite.outcome import EXIT_CODES

if TYPE_CHECKING:
    from harness.core.trajectory import JointTrajectory
    from harness.reporting.progress_events import ProgressEvent

AGREED = ("y", "yes")


class RemoteMode(RunMode):
    """Plan here, and let the controllers of a ROS 2 robot execute."""

    name: ClassVar[str] = "remote"

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add `--robot` and the options that only it has."""
        add = command.add_argument
        text = (
            "with ros2, plan here and let the controllers of a ROS 2 robot execute, after the plan"
            " is printed and confirmed"
        )
        add("--robot", choices=("simulated", "ros2"), default="simulated", help=text)
        add("--yes", action="store_true", help="with --robot ros2: confirm the plan in advance")
        text = "with --robot ros2: scale the planned speed by this share (default: 1)"
        add("--velocity-scaling", metavar="SHARE", type=share_of_one, default=1.0, help=text)
        add_domain(command)

    def run(self, run_files: RunFiles, call: RunCall) -> int:
        """Run scenarios, with `--robot ros2` one of them on the robot."""
        arguments = call.arguments
        if arguments.robot == "ros2":
            simulated = {"--live": "live", "--shard": "shard", "--on": "cluster"}
            for option, name in {**simulated, "--conditions": "conditions"}.items():
                if vars(arguments).get(name):
                    raise UsageError(f"--robot ros2 and {option} exclude each other")
            return run_on_ros2(arguments, call.files)
        if arguments.yes or arguments.velocity_scaling != 1.0:
            raise UsageError(
                "--yes and --velocity-scaling need --robot ros2; in a file the speed is"
                " `planning: {max_velocity_scaling_factor: 0.5}`"
            )
        return run_files(call)


def run_on_ros2(arguments: argparse.Namespace, files: Sequence[Path]) -> int:
    """Run one scenario on a ROS 2 robot, once the user has seen the plan and agreed.

    Raises:
        UsageError: There is more than one scenario, or the user cannot confirm.
    """
    from harness.plugins.ros.domain import domain_of_user
    from harness.plugins.ros.remote import RemoteArm, run_on_robot
    from harness.plugins.ros.rtps.graph import Graph
    from harness.session.run_request import RunRequest
    from harness.suite.folders import report_folders

    if len(files) != 1:
        raise UsageError(f"--robot ros2 runs one scenario at a time, not {len(files)}")
    if not arguments.yes and not sys.stdin.isatty():
        raise UsageError("--robot ros2 moves a robot: confirm at a terminal, or say --yes")
    folder = None if arguments.no_report else report_folders(files, Path(arguments.report_dir))[0]
    request = RunRequest(
        files[0],
        overrides=dict(arguments.overrides),
        seed=arguments.seed,
        report_dir=folder,
        page=not arguments.no_page,
        bag=arguments.bag,
    )
    confirmation = _Confirmation(arguments.yes, arguments.velocity_scaling)
    domain = domain_of_user(arguments.domain)
    is_local, share = not arguments.network, arguments.velocity_scaling
    with closing(Graph(domain, node="armharness", is_local=is_local)) as graph:
        connect = partial(RemoteArm, graph, share, confirmation)
        case = run_on_robot(request, connect, confirmation.note)
    show_case(case, request.file)
    return EXIT_CODES[case.outcome]


class _Confirmation:
    """Prints the plan of each motion, and requires a confirmation before the first one."""

    def __init__(self, is_agreed: bool, velocity_scaling: float) -> None:
        self._is_agreed, self._share = is_agreed, velocity_scaling
        self._step = ""

    def note(self, event: ProgressEvent) -> None:
        """Take note of the step that is on."""
        from harness.reporting.progress_events import StepStarted

        if isinstance(event, StepStarted):
            self._step = event.step

    def __call__(self, trajectory: JointTrajectory) -> bool:
        seconds = trajectory.duration / self._share
        say(f"{self._step}: {len(trajectory.times)} points in {seconds:.2f} s")
        ends = zip(
            trajectory.joint_names, trajectory.positions[0], trajectory.positions[-1], strict=True
        )
        for name, begin, end in ends:
            say(f"  {name}: {round(begin, 4) + 0.0:.4f} to {round(end, 4) + 0.0:.4f}")
        if not self._is_agreed:
            output().clear()
            complain("Move the robot along this plan, and along those of the steps after it? [y/N]")
            self._is_agreed = sys.stdin.readline().strip().lower() in AGREED
        return self._is_agreed
