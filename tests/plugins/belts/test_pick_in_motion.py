"""Picks from belts and turntables in motion, and what makes them miss."""

import re

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.plugins.belts.interception import Company
from harness.plugins.belts.ride import Ride
from harness.recording.read_run import read_run
from tests.running import run_case

BELT = (
    "{name: belt, static: true, box: {size: [0.8, 0.1, 0.02]}, pose: {xyz: [0, 0.2, 0.01]},"
    " surface_velocity: %s}"
)
CAN = (
    "{name: can, cylinder: {radius: 1.5 cm, length: 5 cm}, mass: 0.05, friction: 0.6,"
    " pose: {xyz: [%s, 0.2, 0.045]}}"
)


def text_of(velocity="4 cm/s", x=-0.2, more="", step="pick: {object: can, track: true}"):
    return f"""scenario: a can on a belt
robot: open_manipulator_x
objects:
  - {BELT % velocity}
  - {CAN % x}
{more}
steps:
  - {step}
expect:
  - lifted: {{object: can, above: 5 cm}}
  - grasped: can
  - never: collision
  - always: within_limits
"""


def run(folder, **changes):
    path = folder / "belt.scenario.yaml"
    path.write_text(text_of(**changes), encoding="utf-8")
    return run_case(path)


def met(folder):
    """When the can was met, its way on the belt until then [m], and by how much it was missed."""
    run = read_run(folder / "run").run
    result = next(step.result for step in run.steps if step.verb == "grasp").plain()
    row = round(result["met"] / 0.001)
    poses = run.signals.object_poses["can"]
    return result["met"], poses[row, 0] - poses[0, 0], np.linalg.norm(result["miss"])


@pytest.mark.nightly
def test_a_faster_belt_takes_the_can_farther_before_it_is_met(recorded_run):
    slow, fast = (met(recorded_run(text_of(velocity=v))) for v in ("2 cm/s", "4 cm/s"))
    assert fast[1] > 1.5 * slow[1]
    for (time, way, miss), speed in ((slow, 0.02), (fast, 0.04)):
        assert way == pytest.approx(speed * time, abs=1e-3)
        assert miss < 1e-3


@pytest.mark.nightly
def test_a_turntable_is_tracked_too(tmp_path):
    table = "{name: table, static: true, cylinder: {radius: 0.09, length: 0.02},"
    table += " pose: {xyz: [0.2, 0, 0.01]}, surface_rotation: 0.3}"
    text = text_of(velocity=0, x=0.17).replace("0.2, 0.045", "0.03, 0.045")
    path = tmp_path / "table.scenario.yaml"
    path.write_text(text.replace(BELT % 0, table), encoding="utf-8")
    result = run_case(path)
    assert result.outcome == "passed", (result.steps, result.verdicts)


@pytest.mark.nightly
def test_what_does_not_come_is_missed_by_so_much_at_a_time(tmp_path):
    stop = "  - {name: stop, static: true, in: simulation, box: {size: [1 cm, 0.1, 1 cm]},"
    result = run(tmp_path, more=stop + " pose: {xyz: [-0.15, 0.2, 0.025]}}")
    (grasp,) = [step for step in result.steps if step.verb == "grasp"]
    found = re.search(r"at t=([\d.]+) s.* it was ([\d.]+) mm from where 'belt'", grasp.message)
    assert found, grasp.message
    time, miss = map(float, found.groups())
    # The stop holds the can 30 mm after its start: the rest of the belt's travel is the miss.
    assert miss == pytest.approx(1e3 * (0.04 * time - 0.03), abs=2)


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize(
    ("changes", "messages"),
    [
        ({"velocity": "40 cm/s", "x": 0.1}, ["'can' cannot be met on 'belt' (400 mm/s), which it"]),
        ({"x": 0.38}, ["which it leaves in 0.55 s", "takes", "from the begin of the approach"]),
        ({"more": "  - {name: x, box: {size: [1, 1, 1]}, static: true}"}, ["START_STATE"]),
    ],
)
def test_a_can_that_cannot_be_met_says_why(tmp_path, changes, messages):
    result = run(tmp_path, **changes)
    step = result.steps[0]
    assert step.status == "failed"
    assert all(message in f"{step.error_code} {step.message}" for message in messages), step


def test_what_lies_on_no_belt_is_not_tracked(tmp_path):
    text = text_of().replace(", surface_velocity: 4 cm/s", "")
    path = tmp_path / "belt.scenario.yaml"
    path.write_text(text, encoding="utf-8")
    step = run_case(path).steps[0]
    assert step.error_code == "INVALID_OBJECT_NAME"
    assert "'can' lies on no belt and no turntable" in step.message
    assert "leave out `track`" in " ".join(step.explanation)


@pytest.mark.parametrize(
    "motion", [SurfaceMotion((0.2, 0, 0)), SurfaceMotion((0.1, 0.05, 0), 0.5), SurfaceMotion()]
)
def test_the_tcp_starts_and_ends_at_rest_and_moves_with_the_object_in_between(motion):
    belt, start = SE3.from_xyz_rpy((0.3, 0.1, 0.2), (0, 0, 0.7)), SE3.from_xyz_rpy((0.1, 0.2, 0))
    ride = Ride("can", "belt", motion, belt, start, np.array([[-9, -9], [9, 9]]))
    at = SE3.from_xyz_rpy((0, 0, 0.02), (3.1, 0, 0.3))
    before = SE3(at.rotation, at.translation + np.array([0, 0, 0.05]))
    company = Company(ride, 1.5, 0.8, 0.4, before, at, np.array([0, 0, 0.1]))

    def speed(time):
        pair = (company.tcp_pose(time + sign * 1e-5).translation for sign in (-1, 1))
        return (next(pair) - next(pair)) / -2e-5

    assert speed(1e-5) == pytest.approx(np.zeros(3), abs=1e-3)
    assert speed(company.duration - 1e-5) == pytest.approx(np.zeros(3), abs=1e-3)
    for time in (0.8, 1.0, 1.2):
        with_object = ride.pose(1.5 + time) @ at
        assert company.tcp_pose(time).distance_to(with_object) == pytest.approx((0, 0), abs=1e-7)
    times = np.linspace(0.001, company.duration - 0.001, 400)
    jumps = np.diff([speed(time) for time in times], axis=0)
    assert np.abs(jumps).max() < 0.01, "the velocity has no jump"


TWO_BELTS = """scenario: from belt to belt
robot: {model: ur5e, gripper: %s}
objects:
  - {name: belt, static: true, surface_velocity: 0.15, box: {size: [2, 0.3, 0.1]}, pose: {xyz: [0.1, 0.4, 0.05]}}
  - {name: other, static: true, surface_velocity: 0.1, box: {size: [1.5, 0.3, 0.1]}, pose: {xyz: [0.3, -0.4, 0.05]}}
  - {name: box, box: {size: [0.06, 0.05, 0.06]}, pose: {xyz: [-0.6, 0.4, 0.13]}, mass: 0.3, friction: 0.6}
steps:
  - pick: {object: box, track: true}
  - place: {object: box, pose: {xyz: [0.0, -0.4, 0.13]}, track: true}
  - wait: 0.5
expect:
  - never: collision
  - released: box
  - "on": {object: box, support: other}
"""  # noqa: E501


@pytest.mark.nightly
@pytest.mark.parametrize("gripper", ["rh_p12_rn_a", "suction_cup"])
def test_a_box_is_put_from_one_running_belt_onto_another(recorded_run, gripper):
    run = read_run(recorded_run(TWO_BELTS % gripper) / "run").run
    release = next(step for step in run.steps if step.verb == "release")
    poses = run.signals.object_poses["box"][release.start_index :, :3]
    speed = np.diff(poses[:, 0]) / 0.001
    assert poses[0, :2] == pytest.approx([0.0, -0.4], abs=2e-3), "it was let go where it was to be"
    assert speed[50:-1] == pytest.approx(0.1, abs=0.03), "at the belt's speed from the start"


def test_an_arm_of_four_joints_does_not_place_in_motion(tmp_path):
    result = run(tmp_path, step="place: {object: can, pose: {xyz: [0.1, 0.2, 0.045]}, track: true}")
    assert any("fewer than six joints" in each.message for each in result.problems)
