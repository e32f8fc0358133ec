"""Nodes of the real rclpy, with Fast DDS, against the bridge.

HARNESS_ROS_PYTHON names the Python of an environment that has rclpy and control_msgs; the latter is
built by `python -m tests.ros.build_control_msgs PREFIX`.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from harness.cli.main import main
from harness.ros.replay import replay
from tests.ros.bridging import PYTHON, bridge, require_control_msgs, scenario

pytestmark = pytest.mark.ros
STUDENT = Path(__file__).parent / "student"


@pytest.fixture(scope="module")
def _control_msgs():
    require_control_msgs()


@pytest.mark.usefixtures("_control_msgs")
def test_action_clients_of_rclpy_get_feedback_results_and_cancellation(tmp_path):
    with bridge(scenario(tmp_path, "- external: {}")) as (node, _):
        done = subprocess.run(
            [PYTHON, STUDENT / "protocol.py"],
            env={**os.environ, "ROS_DOMAIN_ID": str(node.graph.participant.domain)},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
    assert done.stdout, done.stderr
    said = json.loads(done.stdout.splitlines()[-1])
    assert said["feedback"][0] >= 15
    assert said["feedback"][1] == ["joint1", "joint2", "joint3", "joint4"]
    assert {name: said[name] for name in ("done", "beyond", "preempted", "canceled")} == {
        "done": [4, 0], "beyond": [6, -1], "preempted": [6, -1], "canceled": [5, 0],
    }  # fmt: skip
    assert said["cancel"] == [0, 1]
    assert said["image"] == [640, 480, "rgb8", 640 * 480 * 3]
    assert {"bridge", "student"} <= set(said["nodes"])


@pytest.mark.usefixtures("_control_msgs")
def test_a_student_s_node_lifts_the_red_box_and_replays(tmp_path, capsys):
    command = f"{PYTHON} {STUDENT / 'lift_the_box.py'}"
    box = "ros2/01_lift_the_red_box"
    code = main(["grade", box, "--node", command, "--report-dir", str(tmp_path), "--json"])
    grade = json.loads(capsys.readouterr().out)
    assert (code, grade["earned"]) == (0, 10), grade["rows"]
    [record] = tmp_path.rglob("run.json")
    assert replay(record.parent).digest == json.loads(record.read_text())["digest"]


def test_joint_angles_that_are_sent_ten_times_a_second_arrive(tmp_path):
    until = "{joints: {positions: {joint1: 0.3, joint2: 0.2}, tolerance: 1 deg}}"
    file = scenario(tmp_path, f"- external: {{until: {until}}}\n  timeout: 30 s")
    command = f"{PYTHON} {STUDENT / 'joint_angles.py'} 0.3 0.2 0.0 0.0"
    assert main(["grade", str(file), "--node", command, "--no-report"]) == 0


@pytest.mark.usefixtures("_control_msgs")
@pytest.mark.skipif(sys.executable != PYTHON, reason="rclpy is in another environment")
def test_the_bridge_itself_can_speak_through_rclpy(tmp_path, capsys):
    command = f"{PYTHON} {STUDENT / 'lift_the_box.py'}"
    arguments = ["--adapter", "rclpy", "--report-dir", str(tmp_path), "--json"]
    assert main(["grade", "ros2/01_lift_the_red_box", "--node", command, *arguments]) == 0
    assert json.loads(capsys.readouterr().out)["earned"] == 10
