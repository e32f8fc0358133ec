"""A bridge in a thread, with a node in its domain."""

import os
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread

import pytest

from harness.plugins.ros.bridge import BridgeRequest, run_bridge
from harness.plugins.ros.domain import free_domain
from harness.session.run_request import RunRequest
from tests.plugins.ros.nodes import Node
from tests.waiting import HANG

PYTHON = os.environ.get("HARNESS_ROS_PYTHON", sys.executable)
"""An environment with rclpy, and with control_msgs, which no package index has."""

ROBOT = "{model: open_manipulator_x}"
STEPS = "- external: {until: {joints: {positions: {joint1: 0.2}, tolerance: 0.5 deg}}}"


def require_control_msgs(*others):
    """Fail without rclpy, and skip without control_msgs or other modules."""
    built = [(module, pytest.skip) for module in ("control_msgs.action", *others)]
    for module, missing in (("rclpy", pytest.fail), *built):
        done = subprocess.run([PYTHON, "-c", f"import {module}"], capture_output=True, check=False)
        if done.returncode:
            missing(f"{PYTHON} has no {module}; build it with harness.plugins.ros.build_messages")


def scenario(folder, steps=STEPS, rest="expect: [{always: within_limits}]", robot=ROBOT):
    """A scenario file whose arm is handed over."""
    file = Path(folder) / "test.scenario.yaml"
    lines = "\n".join(f"  {line}" for line in steps.splitlines())
    file.write_text(f"scenario: a test\nrobot: {robot}\nsteps:\n{lines}\n{rest}\n")
    return file


@contextmanager
def bridge(file, *, waits=False, **options):
    """A bridge in a thread; yields a node in its domain and, at the end, the result.

    With the block the session ends, or, where it `waits`, with its steps.
    """
    ended = Event()
    with free_domain() as domain:
        run = RunRequest(Path(file), page=False, stills=False, **options.pop("run", {}))
        results = []
        request = BridgeRequest(run, domain, stop=ended, **options)
        thread = Thread(target=lambda: results.append(run_bridge(request)))
        thread.start()
        node = Node(domain)
        try:
            yield node, results
        finally:
            if not waits:
                ended.set()
            thread.join(HANG)
            node.graph.close()
