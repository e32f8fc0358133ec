"""`harness run --robot ros2`: planned here, executed by our own bridge as by a robot's driver."""

import io
import json
import signal
import sys
import time
from threading import Event, Thread

import numpy as np
import pytest

import harness.plugins.ros.remote_controllers
from harness.cli.main import main
from harness.plugins.ros.actions import ActionServer
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.domain import free_domain
from harness.plugins.ros.interfaces import FOLLOW, stamp
from harness.plugins.ros.rtps.graph import Graph
from tests.plugins.ros.bridging import bridge, scenario

STEPS = """- ptp: {joints: {joint1: 0.2, joint2: 0.1}}
  id: there
- ptp: {joints: {joint1: 0.0, joint2: 0.0}}
"""
EXPECT = """expect:
  - joints: {positions: {joint1: 0.0}, tolerance: 1 deg}
  - always: {within_limits: {effort: false}}
  - never: collision
"""
HOLD = "- external: {}"


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "plan").mkdir()
    return scenario(tmp_path / "plan", STEPS, EXPECT)


def remote(plan, node, *arguments):
    return main(
        [
            *["run", str(plan), "--robot", "ros2", "--domain", str(node.graph.participant.domain)],
            *["--no-page", "--report-dir", str(plan.parent / "r"), *arguments],
        ]
    )


def test_a_planned_scenario_moves_a_robot_and_is_judged_from_its_topics(tmp_path, plan, capsys):
    with bridge(scenario(tmp_path, HOLD)) as (node, results):
        node.ready()
        code = remote(plan, node, "--yes", "--velocity-scaling", "0.5")
    said = capsys.readouterr().out
    [record] = (plan.parent / "r").rglob("run.json")
    run = json.loads(record.read_text())
    statuses = [verdict["status"] for verdict in run["verdicts"]]
    assert statuses == ["passed", "passed", "not observable"]
    assert [step["status"] for step in run["steps"]] == ["passed", "passed"]
    assert code == 1  # what cannot be observed has not passed
    assert "joint1: 0.0000 to 0.2000" in said
    assert results[0].commands == 2


@pytest.mark.nightly
def test_a_robot_whose_joints_have_a_prefix_is_moved_and_observed_by_names_without_it(tmp_path):
    prefix = "ros2: {prefix: left_}\n"
    (tmp_path / "plan").mkdir()
    plan = scenario(tmp_path / "plan", STEPS, prefix + EXPECT.replace("  - never: collision\n", ""))
    with bridge(scenario(tmp_path, HOLD, prefix)) as (node, results):
        states = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        node.ready()
        assert remote(plan, node, "--yes", "--velocity-scaling", "0.5") == 0
        node.wait(lambda: states)
    [record] = (plan.parent / "r").rglob("run.json")
    verdicts = json.loads(record.read_text())["verdicts"]
    assert [verdict["status"] for verdict in verdicts] == ["passed", "passed"]
    assert states[-1].name[0] == "left_joint1"
    assert results[0].commands == 2


@pytest.mark.nightly
def test_nothing_moves_before_the_user_agrees(tmp_path, plan, capsys, monkeypatch):
    answer = io.StringIO("no\n")
    answer.isatty = lambda: True
    monkeypatch.setattr(sys, "stdin", answer)
    with bridge(scenario(tmp_path, HOLD)) as (node, results):
        node.ready()
        assert remote(plan, node) == 1
    assert "PREEMPTED: the motion was not confirmed" in capsys.readouterr().out
    assert results[0].commands == 0


@pytest.mark.nightly
def test_ctrl_c_stops_the_robot(tmp_path, plan):
    with bridge(scenario(tmp_path, HOLD)) as (node, results):
        states = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        node.ready()

        def press_ctrl_c():
            node.wait(lambda: states and states[-1].position[0] > 0.005)
            signal.raise_signal(signal.SIGINT)

        person = Thread(target=press_ctrl_c)
        person.start()
        slowly = ["--yes", "--no-report", "--velocity-scaling", "0.01"]
        assert remote(plan, node, *slowly) == 130
        person.join()
        node.sleep(0.2)
        stopped = states[-1].position[0]
        node.sleep(0.3)
        assert states[-1].position[0] == pytest.approx(stopped, abs=1e-4)
    assert results[0].commands == 2


def test_a_robot_that_falls_silent_ends_the_run(plan, capsys, monkeypatch):
    monkeypatch.setattr(harness.plugins.ros.remote_controllers, "SILENCE", 2.0)
    with free_domain() as domain:
        driver, goals, is_over = Graph(domain, node="driver"), [], Event()
        states = driver.advertise("/joint_states", "sensor_msgs/msg/JointState")
        joints = ["joint1", "joint2", "joint3", "joint4", "gripper_left_joint"]
        still = message("sensor_msgs/msg/JointState", name=joints, position=np.zeros(5))

        def accept(_, content):
            goals.append(content)
            return True

        def drive():
            while not is_over.is_set():
                if not goals:
                    still.header.stamp = stamp(time.monotonic())
                    states.publish(still)
                driver.spin(time.monotonic() + 0.01)

        name = "/arm_controller/follow_joint_trajectory"
        ActionServer(
            driver, name, FOLLOW, clock=time.monotonic, on_goal=accept, on_cancel=lambda _: True
        )
        thread = Thread(target=drive)
        thread.start()
        options = ["--robot", "ros2", "--yes", "--no-report", "--domain", str(domain)]
        assert main(["run", str(plan), *options]) == 1
        is_over.set()
        thread.join()
        driver.close()
    assert len(goals) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "COMMUNICATION_FAILURE: /joint_states has stopped for 2 s; cancellation was" in said


def test_without_a_terminal_the_user_has_to_agree_in_advance(plan, capsys):
    assert main(["run", str(plan), "--robot", "ros2"]) == 2
    assert "say --yes" in capsys.readouterr().err
