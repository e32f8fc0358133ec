"""tcp_path of a step with corners: the path, orientation and speed that were commanded."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.plugins.paths.expectations.tcp_path import TcpPath
from harness.recording.read_run import read_run
from harness.robot.mechanism import Joint
from tests.judging.synthetic_run import ROBOT, at, changed, make_run, step, verdict

N = 400  # samples of 10 ms
SQUARE = np.array([[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1], [0, 0]])
STEP = 1e-3  # [m] from sample to sample along the square


def slide(name, parent, child, axis):
    return Joint(name, "prismatic", parent, child, SE3.identity(), axis, -1, 1, 2, 5, 10)


GANTRY = replace(
    ROBOT,
    joints=(
        slide("x", "world", "base_link", np.array([1.0, 0, 0])),
        slide("y", "base_link", "palm", np.array([0, 1.0, 0])),
        *ROBOT.joints[3:],
    ),
)


def around(length):
    """Where the square is after a length of it, shape (n, 2)."""
    corners = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(SQUARE, axis=0), axis=1))])
    return np.stack([np.interp(length, corners, SQUARE[:, axis]) for axis in range(2)], axis=1)


ONCE = np.arange(N) * STEP


def run_of(tcp, commands=None, verb="cartesian_path"):
    """A gantry that is commanded around the square once, and is at `tcp`, shape (n, 2) each."""
    commands = around(ONCE) if commands is None else commands
    columns = np.zeros((N, 3))
    columns[:, :2] = commands
    still = np.zeros((2, 2))
    trajectory = JointTrajectory(("x", "y"), np.array([0, 3.99]), commands[[0, -1]], still, still)
    poses = at(N)
    poses[:, :2] = tcp
    moving = step("go", 0, N, verb, trajectory=trajectory)
    return make_run(
        N,
        robot=GANTRY,
        steps=(moving,),
        tcp_pose=poses,
        joint_commands=columns,
        joint_positions=columns,
        object_poses={"Table": at(N), "box": at(N)},
    )


@pytest.mark.parametrize("verb", ["cartesian_path", "sequence"])
@pytest.mark.parametrize("late", [0, 3, 10])
def test_a_path_with_corners_is_followed_up_to_a_tenth_of_a_second_late(verb, late):
    lagging = around(np.clip(ONCE - late * STEP, 0, None))
    answer = verdict(run_of(lagging, verb=verb), TcpPath(), "go")
    assert answer.status == "passed", answer.reason
    assert answer.margin == pytest.approx(0.001, abs=1e-9) or answer.unit == "1"


@pytest.mark.parametrize(
    ("travelled", "said"),
    [
        (around(np.clip(ONCE - 15 * STEP, 0, None)), "5.0 mm from the commanded path"),
        (around(0.4 - ONCE), "from the commanded path"),
        (np.zeros((N, 2)), "from the commanded path"),
        (around(ONCE) + np.array([0.0, 0.0011]), "1.1 mm from the commanded path, 1.0 mm allowed"),
        (np.minimum(around(ONCE), 0.098), "2.0 mm from the commanded path"),
    ],
    ids=["too late", "the other way round", "at the start", "aside", "corners cut"],
)
def test_what_leaves_the_commanded_path_fails(travelled, said):
    answer = verdict(run_of(travelled), TcpPath(), "go")
    assert (answer.status, answer.unit) == ("failed", "m")
    assert said in answer.reason


def test_ends_that_coincide_are_no_path_of_no_length():
    """The line between the ends of a closed path has no length; its path has."""
    closed = around(0.4 * np.arange(N) / (N - 1))
    assert verdict(run_of(closed, closed), TcpPath(), "go").status == "passed"
    line = verdict(run_of(closed, closed, verb="lin"), TcpPath(), "go")
    assert (line.status, line.reason) == (
        "not observable",
        "start and end of the line are one point",
    )


def test_a_path_that_retraces_itself_is_travelled_both_ways():
    there = np.stack([0.1 - np.abs(0.1 - ONCE / 2), 0 * ONCE], axis=1)
    assert verdict(run_of(there, there), TcpPath(), "go").status == "passed"
    stays = np.minimum(there, there[:100].max(axis=0))
    assert verdict(run_of(stays, there), TcpPath(), "go").status == "failed"


def test_half_of_a_path_is_half_of_its_length():
    half = around(np.minimum(ONCE, 0.2))
    answer = verdict(run_of(half, half), TcpPath(min_fraction=1.0), "go")
    assert answer.status == "passed", "all that was commanded"
    stopped = verdict(run_of(half), TcpPath(max_deviation=0.2), "go")
    assert (stopped.status, stopped.unit) == ("failed", "1")
    assert "travelled 50.1 % of the commanded path forwards" in stopped.reason
    shaken = run_of(np.where(np.arange(N)[:, None] % 2, 0.03, 0) + 0 * half)
    assert verdict(shaken, TcpPath(max_deviation=0.2), "go").unit == "1", "shaking goes nowhere"


@pytest.mark.parametrize(("turn", "status"), [(0.018, "failed"), (0.017, "passed")])
def test_the_orientation_is_the_commanded_one(turn, status):
    run = run_of(around(ONCE))
    tcp = run.signals.tcp_pose.copy()
    tcp[200:203, 3:] = np.cos(turn / 2), 0, np.sin(turn / 2), 0
    run = changed(run, tcp_pose=tcp)
    answer = verdict(run, TcpPath(max_rotation=0.0175), "go")
    assert answer.status == status
    assert verdict(run, TcpPath(), "go").status == "passed"
    if status == "failed":
        assert (answer.unit, answer.time) == ("rad", pytest.approx(2.0))


def test_the_speed_is_the_one_commanded_at_the_same_place():
    """It lingers for 50 ms and hurries after its command: its places are right, its speeds not."""
    length = ONCE.copy()
    length[150:155] = length[150] + 0.5 * STEP * np.arange(5)
    answer = verdict(run_of(around(length)), TcpPath(max_speed_error=0.04), "go")
    assert (answer.status, answer.unit) == ("failed", "m/s")
    assert "200 mm/s from the commanded one, 40.0 mm/s allowed" in answer.reason, "3 mm in 10 ms"
    assert verdict(run_of(around(length)), TcpPath(max_speed_error=0.3), "go").status == "passed"
    late = run_of(around(np.clip(ONCE - 3 * STEP, 0, None)))
    assert verdict(late, TcpPath(max_speed_error=0.11), "go").status == "passed"


def test_commands_that_were_not_recorded_are_not_observable():
    run = changed(run_of(around(ONCE)), joint_commands=np.full((N, 3), np.nan))
    answer = verdict(run, TcpPath(), "go")
    assert answer.status == "not observable"
    assert "commanded positions were not recorded" in answer.reason
    standing = run_of(around(0 * ONCE), around(0 * ONCE))
    assert "commanded to stand still" in verdict(standing, TcpPath(), "go").reason


SEAM = """
scenario: a seam with blends
robot: ur5e
world: empty
steps:
  - move_to: {pose: {xyz: [0.4, -0.1, 0.3], rpy: [180 deg, 0, 0]}}
  - id: seam
    sequence:
      - lin: {pose: {xyz: [0.5, -0.1, 0.3], rpy: [180 deg, 0, 0]}}
        blend_radius: 2 cm
      - lin: {pose: {xyz: [0.5, 0.1, 0.3], rpy: [170 deg, 0, 20 deg]}}
        blend_radius: 2 cm
      - lin: {pose: {xyz: [0.4, 0.1, 0.25], rpy: [180 deg, 0, 0]}}
expect:
  - tcp_path: {max_deviation: 0.1 mm, max_rotation: 0.1 deg, max_speed_error: 5 mm/s, during: seam}
  - tcp_path: {max_deviation: 0.1 um, during: seam}
  - tcp_path: {max_deviation: 0.1 mm, max_speed_error: 0.01 mm/s, during: seam}
  - tcp_path: {line: {start: {xyz: [0.4, -0.1, 0.3]}, end: {xyz: [0.4, 0.1, 0.25]}}, during: seam}
"""


@pytest.mark.nightly
def test_a_seam_with_blends_is_followed_in_the_physics(recorded_run):
    """By micrometres, which a stricter tolerance shows; the straight line is 10 cm away."""
    verdicts = read_run(recorded_run(SEAM, "failed") / "run").verdicts
    assert [verdict.status for verdict in verdicts] == ["passed", "failed", "failed", "failed"]
    deviations = [next(m for m in v.measures if "deviation" in m.name).value for v in verdicts]
    assert deviations[1] < 1e-5
    assert 0.05 < deviations[3] < 0.15
