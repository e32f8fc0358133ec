"""A scenario's cell on the ROS 2 graph, executed, recorded and judged as any other run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from harness.ports import LONGEST_RUN
from harness.reporting.result import CaseResult
from harness.ros.domain import free_domain
from harness.ros.graph import Graph
from harness.ros.launch import Allowed
from harness.ros.live import LiveControl, LiveOptions, Say
from harness.session.progress import Notify
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest

NODE = "bridge"


@dataclass(frozen=True)
class BridgeRequest:
    """A scenario, and how nodes reach its cell.

    Attributes:
        run: The case, and what is written of it.
        domain: The number of the ROS domain.
        is_local: Whether nodes of other machines are kept out.
        adapter: `rtps`, or `rclpy` of a ROS 2 installation.
        nodes: Commands that steps may start, by name.
        factor: Simulated seconds in a wall second.
        is_interactive: Whether Ctrl-C ends the session in order.
        say: Receives notes for the user while it runs.
        should_end: Looked at a hundred times a second; whether the session ends now.
    """

    run: RunRequest
    domain: int
    is_local: bool = True
    adapter: str = "rtps"
    nodes: Mapping[str, str] = field(default_factory=dict[str, str])
    factor: float = 1.0
    is_interactive: bool = False
    say: Say = lambda _: None
    should_end: Callable[[], bool] = lambda: False


@dataclass(frozen=True)
class BridgeResult:
    """The judged run, and what is said of the wall around it.

    Attributes:
        case: The result, as of any run.
        pace: One sentence about simulated and wall time.
        output: The end of what the launched program printed.
        commands: Number of commands that arrived.
    """

    case: CaseResult
    pace: str = ""
    output: str = ""
    commands: int = 0


def open_graph(
    adapter: str, domain: int, *, node: str, is_local: bool = True, say: Say = lambda _: None
) -> Graph:
    """Join a domain; notes on what cannot be published are given to `say`.

    Raises:
        SpecError: There is no such domain, or the adapter is not installed.
        NetworkError: The domain cannot be joined.
    """
    if adapter == "rclpy":
        from harness.ros.rclpy_graph import RclpyGraph

        return RclpyGraph(domain, node=node, is_local=is_local, say=say)
    from harness.ros.rtps.graph import RtpsGraph

    return RtpsGraph(domain, node=node, is_local=is_local)


def run_bridge(request: BridgeRequest, notify: Notify = lambda _: None) -> BridgeResult:
    """Run a scenario whose step `external` is nodes' to carry out.

    Raises:
        NetworkError: The domain cannot be joined.
    """
    graph = open_graph(
        request.adapter, request.domain, node=NODE, is_local=request.is_local, say=request.say
    )
    options = LiveOptions(
        Allowed(request.nodes, request.domain),
        request.factor,
        request.say,
        request.is_interactive,
        request.should_end,
    )
    made: list[LiveControl] = []

    def session(prepared: object, simulator: object) -> LiveControl:
        made.append(LiveControl(prepared, simulator, graph, options))
        return made[0]

    try:
        case = run_case(request.run, notify, session)
    finally:
        graph.close()
    if not made:
        return BridgeResult(case)
    commands = sum(command.kind != "end" for command in made[0].commands)
    return BridgeResult(case, made[0].pace.text(), made[0].output, commands)


def run_with_nodes(request: RunRequest, notify: Notify) -> CaseResult:
    """Run a case whose steps may start the request's nodes, in a domain of its own."""
    with free_domain() as domain:
        result = run_bridge(BridgeRequest(request, domain, nodes=request.nodes), notify)
    said = [result.pace] if result.pace else []
    if result.output and result.case.outcome != "passed":
        said.append(f"the launched program printed: {result.output}")
    return replace(result.case, notes=(*result.case.notes, *said))


def handed_over(request: RunRequest, timeout: float = LONGEST_RUN) -> RunRequest:
    """The request with all steps of its file replaced by one that hands the robot over."""
    steps = f"[{{external: {{}}, timeout: {timeout:g} s}}]"
    return replace(request, overrides={**request.overrides, "steps": steps})
