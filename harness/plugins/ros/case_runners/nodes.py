"""A case whose steps start ROS 2 nodes."""

from __future__ import annotations

import argparse
from contextlib import nullcontext
from typing import TYPE_CHECKING, ClassVar

from harness.plugins.ros.options import add_served_robot
from harness.suite.case_runner import CaseRunner

if TYPE_CHECKING:
    from harness.reporting.result import CaseResult
    from harness.session.progress import Notify
    from harness.session.run_request import RunRequest


class NodeRunner(CaseRunner):
    """Run a case whose steps start ROS 2 nodes that command the simulated robot."""

    name: ClassVar[str] = "nodes"

    def run(self, request: RunRequest, notify: Notify) -> CaseResult:
        """Run the case in a ROS domain of its own."""
        from harness.plugins.ros.bridge import run_with_nodes

        return run_with_nodes(request, notify)

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add `--node` and the options of the domain."""
        add_served_robot(command)

    def run_command(self, arguments: argparse.Namespace, timeout: float) -> CaseResult:
        """Run the case in the domain that the options name, or in a free one; print remarks."""
        from harness.plugins.ros.bridge import run_bridge
        from harness.plugins.ros.commands.bridge import bridge_request, show_remarks
        from harness.plugins.ros.domain import domain_of_user, free_domain

        given = arguments.domain
        with free_domain() if given is None else nullcontext(domain_of_user(given)) as domain:
            result = run_bridge(bridge_request(arguments, domain, timeout))
        show_remarks(result)
        return result.case
