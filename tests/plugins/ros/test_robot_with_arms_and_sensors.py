"""`harness run --robot ros2` of two arms and of wrist sensors; our own bridge is the robot."""

import time
from contextlib import closing, contextmanager
from threading import Event, Thread

import numpy as np
import pytest

from harness.cli.main import main
from harness.core.errors import SpecError
from harness.core.spatial import SE3
from harness.core.wrench_sensor import WrenchSensor
from harness.plugins.ros.actions import ActionServer
from harness.plugins.ros.bag.messages import message, vector
from harness.plugins.ros.bag.wrenches import WRENCH
from harness.plugins.ros.domain import free_domain
from harness.plugins.ros.interfaces import FOLLOW, header, stamp
from harness.plugins.ros.refused_steps import refuse_steps
from harness.plugins.ros.rtps.graph import Graph
from harness.plugins.ros.wrench_readings import WrenchReadings
from harness.recording.read_run import read_run
from harness.session.prepare import prepare
from tests.commands import harness
from tests.plugins.ros.bridging import bridge, scenario
from tests.plugins.ros.test_robot_of_ros2 import HOLD, remote
from tests.plugins.ros.test_several_arms import arm_joints, cell

STATE = "sensor_msgs/msg/JointState"
SENSOR = "{model: open_manipulator_x, wrench_sensors: {wrist: {link: link5}}}"
AT_ONCE = """\
  - parallel:
      - {ptp: {joints: {left_joint1: 0.5}}, robot: left}
      - {ptp: {joints: {right_joint1: -0.4}}, robot: right}
"""


def planned(folder, make, *arguments, **options):
    (folder / "plan").mkdir()
    return make(folder / "plan", *arguments, **options)


def recorded(plan):
    [file] = (plan.parent / "r").rglob("run.json")
    return read_run(file.parent).run


@pytest.mark.nightly
def test_two_arms_move_at_once_each_by_its_own_controller_and_grip(tmp_path):
    more = """\
  - {gripper: open, robot: right}
  - {ptp: {joints: {left_joint1: 0.2}}, robot: left}
"""
    goal = "{left_joint1: 0.2, right_joint1: -0.4, right_gripper_left_joint: 0.019}"
    expect = f"expect: [{{joints: {{positions: {goal}}}}}]\n"
    plan = planned(tmp_path, cell, expect, AT_ONCE + more)
    with bridge(cell(tmp_path)) as (node, results):
        assert remote(plan, node, "--yes") == 0
    run = recorded(plan)
    both = [run.robot.joint_index[f"{arm}_joint1"] for arm in ("left", "right")]
    moving = np.abs(run.signals.joint_velocities[:, both]) > 0.05
    assert moving.all(axis=1).sum() > 20  # samples of 10 ms in which both arms move
    assert results[0].commands == 4


@contextmanager
def drivers(domain, accepts, published=("left", "right")):
    """Two drivers, each with joint states and a controller of its own that accepts or rejects."""
    is_over, graphs, canceled = Event(), [], []
    for arm in ("left", "right"):
        graph = Graph(domain, node=f"{arm}_driver")
        joints = [*arm_joints(arm), f"{arm}_gripper_left_joint"]
        publisher = graph.advertise(f"/{arm}/joint_states", STATE)
        ActionServer(
            graph,
            f"/{arm}/arm_controller/follow_joint_trajectory",
            FOLLOW,
            clock=time.monotonic,
            on_goal=lambda *_, arm=arm: accepts[arm],
            on_cancel=lambda _, arm=arm: canceled.append(arm),
        )
        graphs.append((graph, publisher, message(STATE, name=joints, position=np.zeros(5))))

    def drive():
        while not is_over.is_set():
            for graph, publisher, state in graphs:
                state.header.stamp = stamp(time.monotonic())
                if state.name[0].split("_")[0] in published:
                    publisher.publish(state)
                graph.spin(time.monotonic() + 0.005)

    thread = Thread(target=drive)
    thread.start()
    try:
        yield canceled
    finally:
        is_over.set()
        thread.join()
        for graph, *_ in graphs:
            graph.close()


def test_an_arm_whose_controller_rejects_its_share_stops_the_other_one(tmp_path, capsys):
    plan = cell(tmp_path, steps=AT_ONCE)
    with free_domain() as domain, drivers(domain, {"left": True, "right": False}) as canceled:
        options = ["--robot", "ros2", "--yes", "--no-report", "--domain", str(domain)]
        assert main(["run", str(plan), *options]) == 1
    assert canceled == ["left"]
    said = " ".join(capsys.readouterr().out.split())
    assert "/right/arm_controller/follow_joint_trajectory rejected the trajectory" in said


@pytest.mark.nightly
def test_joints_of_which_nothing_is_published_are_named(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("harness.plugins.ros.remote.PATIENCE", 1.0)
    plan = cell(tmp_path, steps=AT_ONCE)
    with free_domain() as domain, drivers(domain, {}, ["left"]):
        options = ["--robot", "ros2", "--yes", "--no-report", "--domain", str(domain)]
        assert main(["run", str(plan), *options]) == 3
    said = " ".join("".join(capsys.readouterr()).split())
    assert "no message with the joints right_joint1, right_joint2," in said


def test_a_wrist_sensor_of_a_robot_is_tared_recorded_and_judged(tmp_path):
    steps = "- wait: 0.3\n- tare: wrist\n- wait: 0.3\n  id: still"
    expect = "expect: [{always: {wrench: {below: 0.1 N, torque_below: 0.01 N*m}}, during: still}]"
    plan = planned(tmp_path, scenario, steps, expect, robot=SENSOR)
    with bridge(scenario(tmp_path, HOLD, robot=SENSOR)) as (node, _):
        assert remote(plan, node, "--yes") == 0
    run = recorded(plan)
    wrench = run.signals.wrenches["wrist"]
    hand = [link.inertial for link in run.robot.links if link.name[:5] in ("link5", "gripp")]
    mass = sum(part.mass for part in hand if part is not None)
    assert np.linalg.norm(wrench[10, :3]) == pytest.approx(9.8 * mass, rel=0.01)


DOWN = "{direction: {xyz: [0, 0, -1]}, force: 5 N, max_distance: 1 cm}"
BOX = "{name: box, box: {size: [2 cm, 2 cm, 2 cm]}, pose: {xyz: [0.2, 0, 0.01]}%s}"
BELT = """objects:
- {name: belt, static: true, box: {size: [0.4, 0.1, 0.02]}, pose: {xyz: [0.3, 0.2, 0.01]},
   surface_velocity: 0.01}
- {name: can, cylinder: {radius: 1 cm, length: 4 cm}, mass: 0.05, pose: {xyz: [0.2, 0.2, 0.04]}}
- name: cabinet
  static: true
  box: {size: [0.1, 0.1, 0.02]}
  pose: {xyz: [0.2, -0.2, 0.01]}
  joints:
  - {name: drawer, slide: {axis: [0, 1, 0], range: [0, 0.1]}, mass: 0.1,
     shapes: [{name: handle, box: {size: [0.02, 0.02, 0.02]}, pose: {xyz: [0, 0, 0.05]}}]}
expect: [{always: within_limits}]
"""


@pytest.mark.parametrize(
    ("steps", "line", "word"),
    [
        (f"- wait: 0.1\n- move_until: {DOWN}", 5, "move_until"),
        ("- comply: {stiffness: {z: 500}, during: [{wait: 0.1}]}", 4, "comply"),
        ("- repeat: {times: 2, steps: [{conveyor: {object: belt, velocity: 0.1}}]}", 4, "conveyor"),
        (f"- add_object: {BOX % ''}", 4, "add_object"),
        ("- inject: {sensor_noise: 0.001}", 4, "inject"),
        ("- parallel: [{gripper: open}, {ptp: {joints: {joint1: 0.2}}}]", 4, "parallel"),
        ("- pick: {object: can, mode: weld}", 4, "pick"),
        ("- gripper: open\n- grasp: {object: can, mode: weld}", 5, "grasp"),
        ("- pick: {object: can, track: true}", 4, "pick"),
        ("- clear_objects: {world: true}", 4, "clear_objects"),
        ("- move_to: {position: {frame: can, xyz: [0, 0, 0.06]}}", 4, "move_to"),
        ("- lin: {position: {frame: can, xyz: [0, 0, 0.06]}}", 4, "lin"),
    ],
)
def test_what_no_robot_can_do_is_refused_at_its_line(tmp_path, capsys, steps, line, word):
    plan = scenario(tmp_path, steps, BELT)
    with free_domain() as domain:
        options = ["--robot", "ros2", "--yes", "--no-report", "--domain", str(domain)]
        assert main(["run", str(plan), *options]) == 2
    said = " ".join("".join(capsys.readouterr()).replace("|", " ").split())
    assert f"scenario.yaml:{line}:" in said
    assert f"`{word}` is not possible on a ROS 2 robot: " in said
    assert "without `--robot ros2` the step is simulated" in said


APPLAUD = """
from typing import ClassVar
from harness.cell.step import Step

class Applaud(Step):
    "Applaud."

    verb: ClassVar[str] = "applaud"
    simulated_only = "its hands are full", "applaud yourself"

    def execute(self, cell):
        pass
"""


def test_a_step_of_a_package_says_itself_that_no_robot_can_do_it(tmp_path):
    (tmp_path / "applause.py").write_text(APPLAUD, encoding="utf-8")
    plan = scenario(tmp_path, "- applaud: {}", BELT)
    options = ["--robot", "ros2", "--yes", "--no-report", "--plugin", "applause.py"]
    done = harness("run", plan, *options, cwd=tmp_path)  # the step stays in that process
    assert done.returncode == 2
    said = " ".join((done.stdout + done.stderr).replace("|", " ").split())
    assert "`applaud` is not possible on a ROS 2 robot: its hands are full" in said
    assert "applaud yourself; without `--robot ros2` the step is simulated" in said


def test_a_drawer_of_a_real_cell_is_not_opened(tmp_path):
    robot = "{model: ur5e, gripper: rh_p12_rn_a}"
    plan = scenario(tmp_path, "- open: {object: cabinet, to: 2 cm}", BELT, robot=robot)
    with pytest.raises(SpecError, match="where a door or drawer stands is not measured there"):
        refuse_steps(prepare(plan))


def test_what_stands_next_to_a_belt_is_a_goal(tmp_path):
    steps = "- move_to: {position: {frame: can, xyz: [0, 0, 0.06]}}\n- clear_objects: {}"
    elsewhere = BELT.replace("[0.2, 0.2, 0.04]", "[0.2, 0.1, 0.02]")
    refuse_steps(prepare(scenario(tmp_path, steps, elsewhere)))
    with pytest.raises(SpecError, match="meet a moving object"):
        refuse_steps(prepare(scenario(tmp_path, steps, BELT)))


@pytest.mark.nightly
def test_objects_of_the_planning_scene_alone_are_not_refused(tmp_path):
    steps = f"- add_object: {BOX % ', in: planning'}\n- remove_object: box\n- wait: 0.1"
    plan = planned(tmp_path, scenario, steps, "expect: [{joints: {positions: {joint1: 0}}}]")
    with bridge(scenario(tmp_path, HOLD)) as (node, _):
        assert remote(plan, node, "--yes") == 0


def read(sensor, *readings):
    """The readings of a sensor whose messages have a frame, a time and a force along z."""
    with (
        free_domain() as domain,
        closing(Graph(domain, node="here")) as here,
        closing(Graph(domain, node="driver")) as driver,
    ):
        publisher = driver.advertise("/wrist/wrench", WRENCH)
        done, found = [], WrenchReadings(here, {"wrist": sensor})
        last = driver.advertise("/last", STATE)
        here.subscribe("/last", STATE, done.append)
        matched = lambda: publisher.subscribers and last.subscribers  # noqa: E731
        assert driver.spin_until(lambda: here.spin(0) or matched(), 60)
        for frame, moment, force in readings:
            content = message("geometry_msgs/msg/Wrench", force=vector([0.0, 0.0, force]))
            publisher.publish(message(WRENCH, header=header(moment, frame), wrench=content))
        last.publish(message(STATE))
        assert here.spin_until(lambda: driver.spin(0) or done, 60)
    return found


def test_readings_are_held_until_the_next_one_and_unknown_before_the_first():
    found = read(WrenchSensor("wrist", "tool0"), ("tool0", 1.0, 2.0), ("", 2.0, 4.0))
    rows = found.at("wrist", np.array([0.5, 1.0, 1.99, 2.0, 3.0]))[:, 2]
    assert np.isnan(rows[0])
    assert rows[1:].tolist() == [2.0, 2.0, 4.0, 4.0]
    assert found.mean("wrist", 1.5)[2] == 3.0
    assert found.mean("wrist", 0.0)[2] == 4.0


def test_readings_in_the_axes_of_another_frame_are_none_of_the_sensor():
    turned = WrenchSensor("wrist", "tool0", SE3.from_xyz_rpy((0, 0, 0.1), (0, 0, 0)))
    found = read(turned, ("tool0", 1.0, 2.0))
    assert found.lack(60) == (
        "/wrist/wrench is in the frame 'tool0', and the sensor 'wrist' of the scenario in"
        " 'wrist_wrench_frame': give it the link of that frame"
    )
