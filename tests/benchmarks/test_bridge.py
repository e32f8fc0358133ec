"""The bridge to ROS 2: how fast goals are accepted, missed joint states, and CPU time."""

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness.ros.control.cell import ExternalCell
from harness.ros.domain import free_domain
from harness.ros.handover import replay
from tests.ros.bridging import scenario
from tests.ros.nodes import Node, follow, point

pytestmark = pytest.mark.benchmark
TICK = os.sysconf("SC_CLK_TCK")
GOALS = 50


def cpu_time(pid):
    """CPU time of a process and its threads [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def test_goals_joint_states_and_cpu_time(tmp_path, monkeypatch):
    file = scenario(tmp_path, "- external: {}\n  timeout: 14 s")
    command = [*(sys.executable, "-m", "harness.cli", "bridge", str(file)), "--report-dir"]
    with free_domain() as domain:
        pass
    process = subprocess.Popen([*command, str(tmp_path / "r"), "--domain", str(domain)])
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
    process.wait(120)
    [record] = (tmp_path / "r").rglob("run.json")
    ticks, tick = [], ExternalCell.tick

    def timed(cell):
        started = time.process_time()
        tick(cell)
        ticks.append(time.process_time() - started)

    monkeypatch.setattr(ExternalCell, "tick", timed)
    assert replay(record.parent).outcome == "passed"
    total, cell = 100 * cpu / seconds, 100 * sum(ticks) / (0.01 * len(ticks))
    print(  # noqa: T201
        f"\ngoal accepted: median {statistics.median(accepted):.1f} ms, most {max(accepted):.1f} ms"
        f"\njoint_states: {len(kept)} of {due}, {len(kept) / seconds:.1f} Hz"
        f"\nCPU: {total:.1f} % of a core; controllers and physics {cell:.1f} %, so"
        f" {total - cell:.1f} % for the bridge itself"
    )
