"""The bridge to ROS 2: how fast goals are accepted, missed joint states, and CPU time."""

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness.plugins.ros.domain import free_domain
from tests.plugins.ros.bridging import scenario
from tests.plugins.ros.nodes import Node, follow, point

pytestmark = pytest.mark.benchmark
TICK = os.sysconf("SC_CLK_TCK")
GOALS = 50
SERVE = """
import sys, time
from harness.cli.main import main
from harness.plugins.ros.control.cell import ExternalCell

tick, spent = ExternalCell.tick, []

def timed(cell):
    begin = time.process_time()
    tick(cell)
    spent.append(time.process_time() - begin)

ExternalCell.tick = timed
main(["bridge", *sys.argv[1:]])
print("cell", sum(spent) / len(spent))
"""
"""Serves a scenario, and prints the CPU time of a tick of controllers and physics [s]: while the
process sleeps between ticks, each takes two or three times as long as in a replay."""


def cpu_time(pid):
    """CPU time of a process and its threads [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def test_goals_joint_states_and_cpu_time(tmp_path):
    file = scenario(tmp_path, "- external: {}\n  timeout: 14 s")
    with free_domain() as domain:
        pass
    command = [sys.executable, "-c", SERVE, str(file), "--no-report", "--domain", str(domain)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    node = Node(domain)
    states = []
    node.graph.subscribe(
        "/joint_states",
        "sensor_msgs/msg/JointState",
        lambda state: states.append((time.monotonic(), state.header.stamp)),
    )
    node.ready()
    node.wait(lambda: states)
    begin, cpu, first = time.monotonic(), cpu_time(process.pid), len(states)
    accepted = []
    for number in range(GOALS):
        sent = time.monotonic()
        goal = node.arm.send(follow(point(0.1, [0.01 * (number % 10), 0, 0, 0])))
        node.wait(lambda goal=goal: goal.is_accepted is not None)
        accepted.append(1e3 * (time.monotonic() - sent))
        node.wait(lambda goal=goal: goal.is_over)
    seconds, cpu = time.monotonic() - begin, cpu_time(process.pid) - cpu
    kept = states[first:]
    stamps = [stamp.sec + 1e-9 * stamp.nanosec for _, stamp in kept]
    due = round((stamps[-1] - stamps[0]) / 0.01) + 1
    node.graph.close()
    said, _ = process.communicate(timeout=120)
    total, cell = 100 * cpu / seconds, 1e4 * float(said.split()[-1])
    print(  # noqa: T201
        f"\ngoal accepted: median {statistics.median(accepted):.1f} ms, most {max(accepted):.1f} ms"
        f"\njoint_states: {len(kept)} of {due}, {len(kept) / seconds:.1f} Hz"
        f"\nCPU: {total:.1f} % of a core; controllers and physics {cell:.1f} %, so"
        f" {total - cell:.1f} % for the bridge itself"
    )
