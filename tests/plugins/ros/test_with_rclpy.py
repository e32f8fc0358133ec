"""Nodes of the real rclpy, with Fast DDS, against the bridge.

HARNESS_ROS_PYTHON names the Python of an environment that has rclpy and control_msgs; the latter is
built by `python -m harness.plugins.ros.build_messages PREFIX`, as is moveit_msgs.
"""

import json
import os
import signal
import subprocess
from pathlib import Path

import pytest

from harness.cli.main import main
from harness.plugins.ros.domain import free_domain
from harness.plugins.ros.handover import replay
from harness.recording.read_run import read_run
from tests.plugins.ros.bridging import PYTHON, bridge, require_control_msgs, scenario
from tests.waiting import HANG

pytestmark = pytest.mark.needs_ros
STUDENT = Path(__file__).parent / "student"
SERVED = {
    "robot": "{model: ur5e, gripper: rh_p12_rn_a}",
    "rest": "objects:\n  - {name: cube, box: {size: [4 cm, 4 cm, 4 cm]}, mass: 0.1, "
    "pose: {xyz: [0.4, 0.3, 0.02]}}\nexpect: [{always: within_limits}]",
}
"""An arm and a cube for clients of MoveIt."""


@pytest.fixture(scope="module")
def _control_msgs():
    require_control_msgs()


def run_node(folder, name, **served):
    """What a node of rclpy prints as its last line while a bridge serves a robot."""
    return run_program(folder, [PYTHON, STUDENT / name], **served)


def run_program(folder, command, environment=os.environ, **served):
    """What a program prints as its last line while a bridge serves the OpenMANIPULATOR-X."""
    options = {"run": {"report_dir": folder / "run"}}
    with bridge(scenario(folder, "- external: {}", **served), **options) as (node, _):
        done = subprocess.run(
            command,
            env={**environment, "ROS_DOMAIN_ID": str(node.graph.participant.domain)},
            capture_output=True,
            text=True,
            timeout=HANG,
            check=False,
        )
    assert done.stdout, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.usefixtures("_control_msgs")
def test_moveit_s_controller_manager_executes_stops_and_grips(tmp_path):
    assert run_node(tmp_path, "controller_manager.py") == {
        "executed": [4, 0],
        "timed out": True,
        "canceled": 1,
        "executed again": [4, 0],
        "rejected": True,
        "gripper": [4, True],
    }


@pytest.mark.usefixtures("_control_msgs")
def test_action_clients_of_rclpy_get_feedback_results_and_cancellation(tmp_path):
    said = run_node(tmp_path, "protocol.py")
    assert said["feedback"][0] >= 15
    assert said["feedback"][1] == ["joint1", "joint2", "joint3", "joint4"]
    assert {name: said[name] for name in ("done", "beyond", "preempted", "canceled")} == {
        "done": [4, 0], "beyond": [False, 0, -1], "preempted": [6, -1], "canceled": [5, 0],
    }  # fmt: skip
    assert said["cancel"] == [0, 1]
    assert said["image"] == [640, 480, "rgb8", 640 * 480 * 3]
    assert {"bridge", "student"} <= set(said["nodes"])


@pytest.mark.usefixtures("_control_msgs")
def test_malformed_goals_garbage_and_clients_that_die_do_not_end_the_bridge(tmp_path):
    said = run_node(tmp_path, "malformed.py")
    answers = {name: said[name] for name in said if isinstance(said[name], list)}
    rejected = {name: each[2] for name, each in answers.items() if each[:2] == [False, 0]}
    joints = {"a joint twice", "five names", "empty", "tolerance of an unknown joint"}
    assert {name for name, code in rejected.items() if code == -2} == joints
    assert {name for name, code in rejected.items() if code == -1} == {
        *("not a number", "infinite", "no positions", "before the start", "falling"),
        *("velocities of three", "velocities at one point", "accelerations of five"),
        *("velocities not a number", "huge velocities", "huge accelerations"),
        "tolerance not a number",
    }
    assert {name for name, code in rejected.items() if code is False} == {
        *("grip not a number", "grip infinite", "grip too wide"),
        *("effort not a number", "effort below zero", "effort infinite"),
    }
    followed = {name: each[1:] for name, each in answers.items() if name not in rejected}
    assert followed.pop("a good grip") == [4, True]
    assert followed.pop("replaced") == [6, -1]
    assert len(followed) == 8
    assert all(each == [4, 0] for each in followed.values())
    assert said["died"] == -signal.SIGKILL


@pytest.mark.usefixtures("_control_msgs")
def test_a_student_s_node_lifts_the_red_box_and_replays(tmp_path, capsys):
    command = f"{PYTHON} {STUDENT / 'lift_the_box.py'}"
    box = "ros2/01_lift_the_red_box"
    code = main(["grade", box, "--node", command, "--report-dir", str(tmp_path), "--json"])
    grade = json.loads(capsys.readouterr().out)
    assert (code, grade["earned"]) == (0, 10), grade["rows"]
    [record] = tmp_path.rglob("run.json")
    assert replay(record.parent).digest == json.loads(record.read_text())["digest"]


@pytest.mark.usefixtures("_control_msgs")
@pytest.mark.parametrize("strays", [False, True])
def test_a_driver_on_rclpy_executes_a_plan_and_is_stopped_where_it_strays(tmp_path, capsys, strays):
    steps = "- ptp: {joints: {joint1: 0.2}}\n- ptp: {joints: {joint1: 0.0}}"
    file = scenario(tmp_path, steps, "expect: [{eventually: {joints: {positions: {joint1: 0.2}}}}]")
    with free_domain() as domain:
        driver = subprocess.Popen(
            [PYTHON, STUDENT / "driver.py", *["--strays"] * strays],
            env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
            stdout=subprocess.PIPE,
            text=True,
        )
        options = ["--robot", "ros2", "--yes", "--no-report", "--domain", str(domain)]
        code = main(["run", str(file), *options])
        driver.terminate()
        executed = driver.communicate(timeout=HANG)[0].split()
    said = " ".join(capsys.readouterr().out.split())
    assert (code, executed) == ((1, ["canceled"]) if strays else (0, ["executed"] * 2)), said
    assert ("CONTROL_FAILED: joint1 is 0.5 rad off its trajectory" in said) is strays


def test_joint_angles_that_are_sent_ten_times_a_second_arrive(tmp_path):
    until = "{joints: {positions: {joint1: 0.3, joint2: 0.2}, tolerance: 1 deg}}"
    file = scenario(tmp_path, f"- external: {{until: {until}}}\n  timeout: 30 s")
    command = f"{PYTHON} {STUDENT / 'joint_angles.py'} 0.3 0.2 0.0 0.0"
    assert main(["grade", str(file), "--node", command, "--no-report"]) == 0


def test_a_client_of_moveit_on_rclpy_plans_moves_and_attaches_and_its_run_replays(tmp_path):
    require_control_msgs("moveit_msgs.srv")
    said = run_node(tmp_path, "move_group.py", **SERVED)
    times = said.pop("milliseconds")
    assert all(0 < each < 5000 for each in times.values())
    assert said == {
        "kinematics": [1, 1],
        "place": [0.4, 0.1, 0.4],
        "move": [True, 4, 1],
        "line": [1.0, 1],
        "execute": [True, 4, 1],
        "again": [True, 6, -4],  # the arm is not at its start any more
        "apply": True,
        "blocked": True,
        "attach": True,
        "scene": ["ground_plane", "wall"],
        "attached": ["cube"],
    }
    stored = read_run(tmp_path / "run")
    assert replay(tmp_path / "run").digest == stored.digest


def test_rviz_s_requests_are_answered_and_the_run_replays(tmp_path):
    require_control_msgs("moveit_msgs.srv", "std_srvs.srv")
    assert run_node(tmp_path, "rviz.py", **SERVED) == {
        "descriptions": ["<?xml ", "<?xml "],
        "pipelines": ["ompl", "pilz_industrial_motion_planner"],
        "plan": [4, 1],
        "shown": 1,
        "execute": [4, 1],
        "plan and execute": [4, 1],
        "line": 1,
        "added": ["Box_0"],
    }
    assert replay(tmp_path / "run").digest == read_run(tmp_path / "run").digest


def test_the_buttons_of_robotis_gui_are_answered_and_the_run_replays(tmp_path):
    """Motions at the tenth of the speed that MoveGroupInterface requests where none is set.

    The box is not in the planning scene, as in the lesson: the GUI plans the gripper's closing too.
    """
    require_control_msgs("moveit_msgs.srv", "std_srvs.srv")
    rest = (
        "objects:\n  - {name: box, box: {size: [3 cm, 3 cm, 10 cm]}, mass: 0.05, in: simulation, "
        "pose: {xyz: [0.22, 0, 0.05]}}\n"
        "expect: [{lifted: {object: box, above: 4 cm}}, {always: within_limits}]"
    )
    assert run_node(tmp_path, "gui.py", rest=rest) == {
        "home": [1, 1, True],
        "init": [1, 1, True],
        "close": [1, 1, -0.01],
        "before the box": [1, 1, True],
        "at the box": [1, 1, True],
        "grip": [1, 1],  # it stalls
        "lift": [1, 1, True],
        "release": [1, 1, 0.019],  # within the two seconds after which the GUI stops the gripper
        "angles": [1, 1, True],
        "position": [1, 1],
        "pose": [1, 1],
        "stopped": [1, -7, False],
        "torque": False,
    }
    stored = read_run(tmp_path / "run")
    assert stored.outcome == "passed"
    assert replay(tmp_path / "run").digest == stored.digest


LIBRARIES = (
    *("rcl", "rcl_action", "rcutils", "rmw", "rosidl_runtime_c"),
    *(
        f"{package}__{part}"
        for package in ("moveit_msgs", "std_msgs", "geometry_msgs")
        for part in ("rosidl_typesupport_c", "rosidl_generator_c")
    ),
)


def test_a_client_in_cpp_plans_executes_attaches_and_stops_and_its_run_replays(tmp_path):
    """The wheels' libraries find each other by LD_LIBRARY_PATH, and some refer to Python's."""
    require_control_msgs("moveit_msgs.srv")
    paths = "import sys, sysconfig; print(sys.prefix, sysconfig.get_config_var('LIBDIR'),"
    paths += " sysconfig.get_config_var('LDLIBRARY'))"
    found = subprocess.run([PYTHON, "-c", paths], capture_output=True, text=True, check=True)
    prefix, folder, python = found.stdout.split()
    if not python.endswith(".so"):
        pytest.skip(f"{PYTHON} has no shared library, which the wheels of rcl need")
    client = tmp_path / "move_group"
    subprocess.run(
        ["g++", "-std=c++17", *(f"-I{each}" for each in Path(prefix, "include").glob("*")),
         STUDENT / "move_group.cpp", "-o", client, f"-L{prefix}/lib",
         "-Wl,--unresolved-symbols=ignore-in-shared-libs", *(f"-l{each}" for each in LIBRARIES)],
        check=True,
        capture_output=True,
    )  # fmt: skip
    libraries = [f"{prefix}/lib", folder, *map(str, Path(prefix).rglob("*.libs"))]
    environment = {
        **os.environ,
        "AMENT_PREFIX_PATH": prefix,
        "LD_LIBRARY_PATH": ":".join(libraries),
        "LD_PRELOAD": str(Path(folder, python)),
    }
    assert run_program(tmp_path, [client], environment, **SERVED) == {
        "planners": 2,
        "plan": [4, 1],
        "points": True,
        "executed": [4, 1],
        "line": 1,
        "stopped": [6, -7],
    }
    run = read_run(tmp_path / "run")
    assert [each.object for each in run.run.attachments] == ["cube"]
    assert replay(tmp_path / "run").digest == run.digest


@pytest.mark.usefixtures("_control_msgs")
def test_a_node_moves_two_arms_by_their_names_and_its_run_replays(tmp_path):
    require_control_msgs("moveit_msgs.action")
    file = tmp_path / "two.scenario.yaml"
    node = f"{PYTHON} {STUDENT / 'two_arms.py'}"
    file.write_text(
        "scenario: two arms\nrobots:\n"
        "  left: {model: open_manipulator_x, base: {xyz: [0, 0.3, 0]}}\n"
        "  right: {model: open_manipulator_x, base: {xyz: [0, -0.3, 0]}}\n"
        "steps:\n  - external: {timeout: 60 s}\n"
        "expect:\n  - eventually: {joints: {positions: {left_joint1: 0.4}, tolerance: 1 deg}}\n"
        "  - joints: {positions: {left_joint1: 0.1, right_joint1: 0.2}, tolerance: 1 deg}\n"
        "  - never: collision\n"
    )
    folder = tmp_path / "reports"
    options = ["--no-page", "--report-dir", str(folder)]
    assert main(["grade", str(file), "--node", node, *options]) == 0
    [run] = folder.rglob("run.json")
    stored = read_run(run.parent)
    assert replay(run.parent).digest == stored.digest
