"""A scenario's cell on the ROS 2 graph, executed, recorded and judged as any other run."""

from __future__ import annotations

import time
from contextlib import closing
from dataclasses import dataclass, replace

from harness.core.errors import Problem, SpecError
from harness.core.limits import LONGEST_RUN
from harness.plugins.ros.domain import free_domain
from harness.plugins.ros.live import BridgeRequest, LiveControl
from harness.plugins.ros.rtps.graph import Graph
from harness.reporting.result import CaseResult
from harness.session.progress import Notify
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from harness.session.start import Start, start_simulated
from harness.session.timing import Clock
from harness.simulation.mujoco_simulator import MujocoSimulator

NODE = "bridge"
DISCOVERY = 0.5  # wall time in which other robots of the domain are discovered [s]
MOST_WAITS = 10  # such times, while more of another node becomes known: on a busy machine


@dataclass(frozen=True)
class BridgeResult:
    """The judged run, the number of commands, and remarks on wall time, names and programs."""

    case: CaseResult
    commands: int = 0
    remarks: tuple[str, ...] = ()


def run_bridge(request: BridgeRequest, notify: Notify = lambda _: None) -> BridgeResult:
    """Run a scenario whose step `external` is nodes' to carry out.

    Raises:
        SpecError: Another robot is in the domain.
        NetworkError: The domain cannot be joined.
    """
    made: list[LiveControl] = []

    def start(run: RunRequest, clock: Clock) -> Start[MujocoSimulator]:
        start = start_simulated(run, clock)

        def session() -> LiveControl:
            made.append(LiveControl(start.prepared, start.simulator, graph, request))
            return made[0]

        return replace(start, open_session=session)

    graph = Graph(request.domain, node=NODE, is_local=request.is_local)
    with closing(graph):
        _refuse_other_robot(graph, request.domain)
        case = run_case(request.run, notify, start)
    if not made:
        return BridgeResult(case)
    remarks = made[0].remarks(has_passed=case.outcome == "passed")
    return BridgeResult(case, made[0].command_count, remarks)


def _refuse_other_robot(graph: Graph, domain: int) -> None:
    """Raise where a robot or another simulator is in the domain: both would obey a command."""
    before: list[int] = []
    for _ in range(MOST_WAITS):
        graph.spin(time.monotonic() + DISCOVERY)
        counts = graph.participant.endpoint_counts()
        is_alone = graph.participant.is_first and not counts
        if is_alone or (counts and all(counts) and counts == before):
            break
        before = counts
    if any(use.publishes and use.topic == "/joint_states" for use in graph.uses()[1]):
        reason = "another robot or simulator publishes /joint_states; use another --domain"
        raise SpecError([Problem(f"ROS domain {domain}", 0, 0, reason)])


def run_with_nodes(request: RunRequest, notify: Notify) -> CaseResult:
    """Run a case whose steps may start the request's nodes, in a domain of its own."""
    remarks: list[str] = []
    with free_domain() as domain:
        result = run_bridge(BridgeRequest(request, domain, say=remarks.append), notify)
    return replace(result.case, notes=(*result.case.notes, *remarks, *result.remarks))


def handed_over(request: RunRequest, timeout: float = LONGEST_RUN) -> RunRequest:
    """The request with all steps of its file replaced by one that hands the robot over."""
    steps = f"[{{external: {{}}, timeout: {timeout:g} s}}]"
    return replace(request, overrides={**request.overrides, "steps": steps})
