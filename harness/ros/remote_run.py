"""A scenario on a ROS 2 robot: planned here, executed by the robot's controllers, judged here."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from harness.reporting.result import CaseResult
from harness.ros.control.cell import controller_names
from harness.ros.graph import Graph
from harness.ros.remote import RemoteArm, RemoteOptions
from harness.session.prepare import prepare
from harness.session.progress import Notify
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from harness.session.start import Start
from harness.session.timing import Clock

if TYPE_CHECKING:
    from harness.session.timed_simulator import TimedSimulator


def run_on_robot(
    request: RunRequest, graph: Graph, options: RemoteOptions, notify: Notify = lambda _: None
) -> CaseResult:
    """Run a case on the robot of a ROS 2 domain.

    What its topics do not show, such as contacts and the poses of objects, is not observable.

    Raises:
        StepFailed: COMMUNICATION_FAILURE; the robot cannot be reached.
    """

    def start(request: RunRequest, clock: Clock) -> Start:
        del clock
        prepared = prepare(request.file, request.overrides, request.seed, request.text)
        program = prepared.program
        names = controller_names(program.description, prepared.loaded.scenario.ros2)
        arm = RemoteArm(graph, program, prepared.kinematics, names, options)
        arm.observe_frames(tuple(prepared.observed_links))
        return Start(prepared, cast("TimedSimulator", arm), 0)

    return run_case(request, notify, start=start)
