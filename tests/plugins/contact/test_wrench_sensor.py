"""Sensors of force and torque: static loads against theory, MuJoCo's sums, noise, rate and tare."""

from dataclasses import replace

import numpy as np
import pytest

import harness
from harness.core.spatial import SE3
from harness.core.wrench_sensor import Payload, WrenchSensor
from harness.language.scenario import RobotSpec
from harness.plugins.studio.live_simulator import LiveSimulator
from harness.robot.load import load_robot
from harness.simulation.wrench_sensors import WrenchSensors
from tests.plugins.suction.test_seals import RIM, cup
from tests.simulation.physics_scenes import a_box
from tests.simulation.test_pushing import GANTRY

G = np.array([0.0, 0.0, -9.8])
LINK = "rh_p12_rn_base"  # carried by the flange of the arm
OFFSET = SE3.from_xyz_rpy((0.25, 0.1, 0.05))  # T_link_load
POSES = [(0, -1.57, 1.57, -1.57, -1.57, 0), (0.3, -1.2, 1.4, -2.5, 0.7, 0.9)]


@pytest.fixture(scope="module")
def ur5e():
    return load_robot(RobotSpec(model="ur5e", gripper="rh_p12_rn_a"))


def with_sensor(robot, pose=None, start=POSES[0], **options):
    sensor = WrenchSensor("wrist", LINK, pose or SE3.identity(), **options)
    joints = robot.groups[robot.arm_group].joint_names
    state = dict(zip(joints, start, strict=True))
    return replace(robot, wrench_sensors={"wrist": sensor}, start_state=state)


def held_load(robot, offset, mass=2.0, *, loaded=True, **options):
    """The simulator of an arm that holds a load at T_link_load, far from everything."""
    here = robot.link_poses(robot.start_positions())[LINK]
    load = replace(a_box("load", (0.02, 0.02, 0.02), (0, 0, 0), mass=mass), pose=here @ offset)
    simulator = LiveSimulator(robot, [load], ["load"] if loaded else [], **options)
    if loaded:
        simulator.weld("load", LINK)
    return simulator


@pytest.mark.parametrize("start", POSES)
@pytest.mark.parametrize("turned", [(0, 0, 0), (0.4, -0.3, 1.1)])
def test_a_load_of_2_kg_at_a_lever_reads_as_theory_says(ur5e, start, turned):
    """Force m g, torque r x m g, in the sensor's axes and about its origin, to 1 %."""
    robot = with_sensor(ur5e, SE3.from_xyz_rpy((0.01, 0.02, -0.03), turned), start)
    offset = OFFSET
    wrenches = []
    for loaded in (False, True):
        simulator = held_load(robot, offset, loaded=loaded)
        simulator.hold(0.6)
        wrenches.append(simulator.wrench("wrist", 0.1))
        sensor = robot.link_poses(simulator.joint_positions())[LINK]
    empty, full = wrenches
    sensor = sensor @ robot.wrench_sensors["wrist"].pose
    place = robot.wrench_sensors["wrist"].pose.inverse() @ offset
    force = sensor.rotation.T @ (2.0 * G)
    expected = np.concatenate([force, np.cross(place.translation, force)])
    assert full - empty == pytest.approx(expected, abs=0.01 * 19.6 * 0.27, rel=0.01)
    assert full[:3] - empty[:3] == pytest.approx(force, abs=0.01 * 19.6)


def test_a_press_reads_as_the_sum_of_the_contact_forces(tmp_path):
    """The sensor is in an MJCF file, at a site of the quill of a gantry."""
    sensors = '<sensor><force site="tip" noise="0"/><torque site="tip"/><jointpos joint="x"/>'
    text = GANTRY.replace("</mujoco>", f"{sensors}</sensor></mujoco>")
    (tmp_path / "gantry.xml").write_text(text, encoding="utf-8")
    file = tmp_path / "press.scenario.yaml"
    file.write_text(PRESS, encoding="utf-8")
    result = harness.run(file)
    assert result, str(result)
    signals = result.run.signals
    pushed = signals.contact_forces["quill", "block"]
    rows = slice(-400, None)  # of the wait at the end
    assert pushed[rows].min() > 10
    assert signals.wrenches["tip"][rows, 2] == pytest.approx(pushed[rows], abs=0.02)
    frictions = signals.frictions["quill", "block"][rows, :2]
    assert signals.wrenches["tip"][rows, :2] == pytest.approx(-frictions, abs=0.02)
    notes = [note for note in result.run.robot.notes if "sensors" in note]
    assert notes == ["1 sensors are ignored"], "of the joint's position"


PRESS = """
scenario: press
robot: {mjcf: gantry.xml, tcp_link: tip}
objects:
  - {name: block, static: true, box: {size: [0.2, 0.2, 0.1]}, pose: {xyz: [0.1, 0, 0.05]}}
steps:
  - move_to: {joints: {x: 0.1, y: 0, z: 0}}
  - tare: tip
  - allow_collisions:
      pairs: [[quill, block]]
      during:
        - move_until: {direction: {xyz: [0, 0, -1]}, force: 20 N, sensor: tip, max_distance: 5 cm,
            speed: 5 mm/s}
        - wait: 0.5
expect:
  - wrench: {below: 60 N, torque_below: 6 N*m}
  - eventually: {wrench: {above: 19 N, direction: {xyz: [0, 0, 1]}}, for: 0.3}
  - formula: eventually (force_z(tip) > 19 N and abs(torque_x(tip)) < 0.5)
  - formula: always (force_z(tip) < 60 N and abs(force_x(tip)) < 0.7 * force(quill, block) + 1 N)
"""


@pytest.mark.parametrize(
    ("formula", "said"),
    [
        ("always (force_z(tpi) < 60 N)", "`tip`"),
        ("always (force_z(tip) < 60 mm)", "one kind"),
        ("always (torque_z < 1)", "of one name"),
        ("always (force_z(quill) < 1)", "wrench sensor"),
    ],
)
def test_a_formula_of_what_no_sensor_reads_is_a_located_error(tmp_path, formula, said):
    sensors = '<sensor><force site="tip"/><torque site="tip"/></sensor></mujoco>'
    (tmp_path / "gantry.xml").write_text(GANTRY.replace("</mujoco>", sensors), encoding="utf-8")
    file = tmp_path / "press.scenario.yaml"
    file.write_text(PRESS + f"  - formula: {formula}\n", encoding="utf-8")
    result = harness.run(file)
    assert result.case.outcome == "invalid"
    assert said in str(result)
    assert "press.scenario.yaml:20:" in str(result)


@pytest.mark.nightly(but=["300.0-turned0"])
@pytest.mark.parametrize("turned", [(0, 0, 0), (0.4, -0.3, 1.1)])
@pytest.mark.parametrize("rate", [float("inf"), 300.0])
def test_the_weight_of_a_payload_is_gone_in_every_orientation(ur5e, turned, rate):
    """Of what the sensor carries the tool's weight is left, which the tare removes in one."""
    pose = SE3.from_xyz_rpy((0.01, 0.02, -0.03), turned)
    readings = {}
    for payload in (None, Payload(2.0, OFFSET.translation)):
        robot = with_sensor(ur5e, pose, rate=rate)
        simulator = held_load(robot, OFFSET, loaded=payload is not None)
        simulator.hold(0.3)
        simulator.tare("wrist", 0.05, payload)
        simulator.hold(0.1)
        before = simulator.wrench("wrist", 0.05)
        start = simulator.commanded_positions()[simulator.physics.actuated]
        goal = start.copy()
        goal[:6] = POSES[1]
        share = (1 - np.cos(np.linspace(0, np.pi, 1501)))[:, None] / 2
        rates = (
            np.gradient(share, 0.001, axis=0),
            np.gradient(np.gradient(share, 0.001, axis=0), 0.001, axis=0),
        )
        way = goal - start
        simulator.stream(np.stack([start + share * way, rates[0] * way, rates[1] * way]))
        simulator.command(goal)
        simulator.hold(0.4)
        readings[payload is not None] = np.stack([before, simulator.wrench("wrist", 0.05)])
        recorded = simulator.finish().wrenches["wrist"]
        assert recorded[-50:].mean(axis=0) == pytest.approx(readings[payload is not None][1])
    assert np.abs(readings[True][0]).max() < 0.02
    assert np.abs(readings[False][1]).max() > 3, "the tare alone leaves the tool's weight"
    assert readings[True] == pytest.approx(readings[False], abs=0.05)


def test_noise_is_the_same_however_the_time_is_divided_and_whenever_it_is_read(ur5e):
    robot = with_sensor(ur5e, rate=125.0, force_noise=0.5, torque_noise=0.02)
    whole, parts = (held_load(robot, SE3.identity(), loaded=False, seed=3) for _ in range(2))
    whole.hold(0.3)
    for _ in range(10):
        parts.hold(0.03)
        parts.wrench("wrist", 0.01)
    first, second = (each.finish().wrenches["wrist"] for each in (whole, parts))
    assert (first == second).all()
    changes = np.flatnonzero(np.diff(first[:, 0])) + 1
    assert (changes % 8 == 0).all(), "125 Hz are 8 steps of 1 ms"
    assert len(changes) == 37
    held = first[::8]
    assert held[:, :3].std(axis=0) == pytest.approx(0.5, rel=0.4)
    assert held[:, 3:].std(axis=0) == pytest.approx(0.02, rel=0.4)
    other = held_load(robot, SE3.identity(), loaded=False, seed=4)
    other.hold(0.3)
    assert not np.allclose(other.finish().wrenches["wrist"], first)


@pytest.mark.parametrize("first", [0, 1000, 1024, 5000])
def test_one_look_reads_what_the_whole_sequence_has(first):
    sensors = WrenchSensors([WrenchSensor("wrist", "hand", force_noise=0.5)], 0.001, 7)
    measured = np.zeros((6000, 6))
    whole = sensors.readings("wrist", measured, 0, 6000)
    assert (sensors.readings("wrist", measured, first, 900) == whole[first : first + 900]).all()
    assert whole[:, :3].std(axis=0) == pytest.approx(0.5, rel=0.05)
    assert np.corrcoef(whole[:1024, 0], whole[1024:2048, 0])[0, 1] == pytest.approx(0, abs=0.1)


def test_a_rate_that_does_not_divide_the_step_reads_the_last_sample_that_was_due(ur5e):
    robot = with_sensor(ur5e, rate=300.0)
    simulator = held_load(robot, OFFSET)
    exact = held_load(with_sensor(ur5e), OFFSET)
    for each in (simulator, exact):
        each.hold(0.05)
    held, every = (each.finish().wrenches["wrist"] for each in (simulator, exact))
    for row in range(len(held)):
        due = int(np.ceil(np.floor(row * 0.3 + 1e-9) / 0.3 - 1e-9))
        assert due <= row < due + 4
        assert (held[row] == every[due]).all()


@pytest.mark.parametrize("span", [0.001, 0.004, 0.05])
def test_a_mean_right_after_a_tare_has_no_reading_from_before_it(ur5e, span):
    simulator = held_load(with_sensor(ur5e), OFFSET)
    simulator.hold(0.3)
    assert np.abs(simulator.wrench("wrist", span)).max() > 20
    simulator.tare("wrist", 0.05)
    assert np.abs(simulator.wrench("wrist", span)).max() < 0.2


def test_a_tare_is_forgotten_with_the_samples_after_a_snapshot(ur5e):
    simulator = held_load(with_sensor(ur5e), OFFSET)
    simulator.hold(0.3)
    before = simulator.snapshot()
    zero = simulator.tare("wrist", 0.05)
    simulator.hold(0.1)
    assert np.linalg.norm(zero[:3]) > 19
    assert np.abs(simulator.wrench("wrist", 0.05)).max() < 0.05
    assert np.abs(simulator.tare("wrist", 0.05) - zero).max() < 0.05, "of the untared readings"
    simulator.restore(before)
    simulator.hold(0.1)
    assert np.linalg.norm(simulator.wrench("wrist", 0.05)[:3]) > 19


STILL = """
scenario: still
robot: {model: ur5e, gripper: rh_p12_rn_a%s}
steps:
  - wait: 0.1
%s
"""
ONE = ", wrench_sensors: {wrist: rh_p12_rn_base}"
TWO = ", wrench_sensors: {wrist: rh_p12_rn_base, elbow: forearm_link}"


@pytest.mark.parametrize(
    ("robot", "rest", "said"),
    [
        (", wrench_sensors: {wrist: tool_0}", "", ["3:60", "no link 'tool_0'", "`tool0`"]),
        (", wrench_sensors: {wrist: world}", "", ["3:60", "no link 'world'"]),
        (", wrench_sensors: {wrist: ft_frame}", "", ["3:60", "a frame that carries nothing"]),
        (", wrench_sensors: {wrist: {link: tool0, rate: 0}}", "", ["3:", "rate"]),
        (", wrench_sensors: {wrist: {link: tool0, force_noise: -1}}", "", ["3:", "force_noise"]),
        (", wrench_sensors: {wrist: {link: tool0, torque_noise: 1 N}}", "", ["3:", "torque"]),
        ("", "  - tare: {}", ["6:", "no sensor of force and torque", "wrench_sensors"]),
        (ONE, "  - tare: {payload: {mass: -1 kg}}", ["6:", "mass"]),
        (ONE, "  - tare: {payload: {com: [0, 0, 0.1]}}", ["6:", "mass"]),
        (ONE, "  - tare: wirst", ["6:", "`wrist`"]),
        (TWO, "  - tare: {}", ["6:", "wrist, elbow", "`sensor`"]),
        ("", "expect: [{wrench: {below: 5}}]", ["6:", "no sensor of force and torque"]),
        (ONE, "expect: [{wrench: {below: 5, above: 6}}]", ["6:", "must not be more than"]),
        (ONE, "expect: [{wrench: {below: 0}}]", ["6:", "a magnitude, which is never below 0"]),
        (ONE, "expect: [{wrench: {above: 0}}]", ["6:", "a magnitude, which is never below 0"]),
        (ONE, "expect: [{wrench: {torque_above: -1}}]", ["6:", "a magnitude, which is never"]),
        (ONE, "expect: [{wrench: {below: 5 N*m}}]", ["6:", "N*m"]),
        (ONE, "expect: [{wrench: {sensor: wrist}}]", ["6:", "`torque_above`"]),
        (ONE, "expect: [{wrench: {below: 5, direction: {xyz: [0, 0, 1], frame: wirst}}}]", ["6:"]),
    ],
)
def test_bad_input_is_a_located_error(tmp_path, robot, rest, said):
    file = tmp_path / "still.scenario.yaml"
    file.write_text(STILL % (robot, rest), encoding="utf-8")
    result = harness.run(file)
    assert result.case.outcome == "invalid"
    for words in said:
        assert words in str(result)


@pytest.mark.parametrize(
    ("mass", "lever", "tilt"), [(4.0, 0.0, 0.0), (1.5, 0.012, 0.0), (2.0, 0.004, 0.3)]
)
def test_a_sensor_that_carries_a_cup_reads_what_the_vacuum_holds(mass, lever, tilt):
    """The vacuum's force on the cup and that of the rim differ by the load's weight."""
    robot = cup(rpy=(np.pi + tilt, 0, 0))
    robot = replace(robot, wrench_sensors={"wrist": WrenchSensor("wrist", "suction_pad")})
    turn = SE3.from_xyz_rpy((0, 0, 0), (tilt, 0, 0))
    rim = SE3.from_xyz_rpy((0, 0, RIM + 0.07), (np.pi + tilt, 0, 0)) @ SE3.from_xyz_rpy(
        (0, 0, 0.07)
    )
    place = SE3(np.eye(3), rim.translation) @ turn @ SE3.from_xyz_rpy((lever, 0, -0.0205))
    plate = replace(a_box("plate", (0.1, 0.1, 0.04), (0, 0, 0), mass=mass), pose=place)
    simulator = LiveSimulator(robot, (plate,), ("plate",), gravity=(0, 0, 0))
    simulator.command_gripper(0.005, 5.0, timeout=2)
    free = simulator.wrench("wrist", 0.05)
    assert free == pytest.approx(np.zeros(6), abs=0.02), "75 N of vacuum are in balance"
    simulator.physics.model.opt.gravity[:] = G
    simulator.hold(0.5)
    down = (SE3.from_xyz_rpy((0, 0, 0), (np.pi + tilt, 0, 0)).inverse().rotation @ G) * mass
    pad = robot.link_poses(robot.start_positions())["suction_pad"]
    com = pad.inverse().apply(simulator.object_pose("plate").translation)
    expected = np.concatenate([down, np.cross(com, down)])
    assert simulator.wrench("wrist", 0.05) == pytest.approx(expected, rel=0.01, abs=0.01)


JUDGED = """
expect:
  - wrench: {below: 30 N, force_window: 0}
  - wrench: {below: 4 N}
  - wrench: {above: 4 N, direction: {xyz: [0, 0, -1]}}
  - wrench: {below: -4 N, direction: {xyz: [0, 0, 1]}}
  - wrench: {above: 4 N, direction: {xyz: [0, 0, 1], frame: wrist}}
  - wrench: {torque_above: 1 N*m}
  - eventually: {wrench: {below: 30 N}, for: 0.1}
"""


def test_margins_are_newtons_and_directions_have_signs(tmp_path):
    """The gripper points down, so that the sensor's z axis does; it weighs 4.1 N."""
    start = ", start_state: {joints: {shoulder_lift_joint: -1.57, elbow_joint: 1.57,"
    robot = f"{ONE}{start} wrist_1_joint: -1.57, wrist_2_joint: -1.57}}}}"
    file = tmp_path / "judged.scenario.yaml"
    file.write_text(STILL % (robot, JUDGED.lstrip()), encoding="utf-8")
    result = harness.run(file)
    verdicts = result.case.verdicts
    weight = np.linalg.norm(result.run.signals.wrenches["wrist"][-1, :3])
    held = [verdict.status == "passed" for verdict in verdicts]
    assert held == [True, False, True, True, True, False, True], str(result)
    assert verdicts[0].margin == pytest.approx(30 - weight, abs=0.1)
    assert verdicts[0].unit == "N"
