"""The controllers as functions of time: no transport, and the physics where it is the subject."""

import numpy as np
import pytest
from scipy.interpolate import BPoly

from harness.core.spatial import SE3
from harness.plugins.ros.control.cell import UNBOUNDED
from harness.plugins.ros.control.controller import Window
from harness.plugins.ros.control.goals import Code, GoalRefused
from harness.plugins.ros.control.step_response import StepResponse
from harness.plugins.ros.control.trajectory import Spline, start_trajectory
from harness.recording.commands import CommandRecord
from harness.robot.description import TrackingTolerances
from harness.robot.mechanism import Joint

JOINTS = [
    Joint(name, "revolute", "a", "b", SE3.identity(), np.array([0, 0, 1.0]), -2.0, 2.0)
    for name in ("first", "second")
]
REST = np.zeros((3, 1, 2))
HERE = np.zeros(2)
TIMES = np.arange(1, 201) * 0.01


def content(*points, names=("first", "second"), **fields):
    rows = [{"time": t, "positions": p, "velocities": v, "accelerations": []} for t, p, v in points]
    return {"joint_names": list(names), "points": rows, **fields}


def followed(sent, now=0.0, tolerances=UNBOUNDED):
    """The motion of a goal from rest at zero."""
    command = CommandRecord(0, now, "trajectory", goal="g", content=sent)
    return start_trajectory(JOINTS, tolerances, command, REST)


def refused(**fields):
    with pytest.raises(GoalRefused) as error:
        followed(fields, 1.0)
    return error.value.code


@pytest.mark.parametrize("order", [1, 3, 5])
def test_segments_are_those_of_hermite_interpolation(order):
    rng = np.random.default_rng(order)
    knots, data = np.array([0.0, 0.3, 1.0, 1.1]), rng.normal(size=(3, 4, 2))
    given = data[: (order + 1) // 2]
    reference = BPoly.from_derivatives(knots, np.moveaxis(given, 0, 1))
    times = np.linspace(0.0, 1.0999, 57)
    found = Spline(knots, *given).at(times)
    for derivative, rows in enumerate(found):
        assert np.allclose(rows, reference(times, nu=derivative), atol=1e-6 * 10**derivative)


def test_joints_in_another_order_are_sorted_and_the_start_is_the_last_set_point():
    arm = followed(content((1.0, [0.4, 0.2], [0, 0]), names=("second", "first")))
    positions, velocities, _ = arm.at(np.array([0.0, 0.5, 1.0, 2.0]))
    assert np.allclose(positions, [[0, 0], [0.1, 0.2], [0.2, 0.4], [0.2, 0.4]])
    assert np.allclose(velocities[[0, 2, 3]], 0)


def test_points_that_are_over_are_left_out():
    late = content((0.5, [1, 1], [0, 0]), (2.0, [0.5, 0.5], [0, 0]), stamp=10.0)
    arm = followed(late, 11.0)
    positions, _, _ = arm.at(np.array([11.0, 12.0]))
    assert np.allclose(positions, [[0, 0], [0.5, 0.5]])


def test_a_stamp_in_the_future_delays_and_one_of_another_clock_does_not():
    arm = followed(content((1.0, [1, 1], [0, 0]), stamp=15.0), 10.0)
    assert np.allclose(arm.at(np.array([16.0]))[0], 1.0)
    assert (arm.at(np.array([15.0]))[0] < 0.99).all()
    arm = followed(content((1.0, [1, 1], [0, 0]), stamp=1.79e9), 10.0)
    assert np.allclose(arm.at(np.array([11.0]))[0], 1.0)


@pytest.mark.parametrize(("time", "stamp"), [(1e-9, 0.0), (0.0, 0.0), (0.5, 0.5)])
def test_a_trajectory_that_ends_now_is_its_last_point(time, stamp):
    arm = followed(content((time, [0.3, 0.1], [0, 0]), stamp=stamp), 1.0)
    assert np.allclose(arm.at(np.array([1.01]))[0], [0.3, 0.1])


def test_long_names_are_cropped_in_messages():
    names = ("x" * 10_000, "second")
    with pytest.raises(GoalRefused) as error:
        followed(content((1.0, [0, 0], []), names=names), 1.0)
    assert len(str(error.value)) < 200


def test_each_mistake_has_its_error_code():
    good = content((1.0, [0, 0], [0, 0]))
    assert refused(**{**good, "joint_names": []}) is Code.INVALID_JOINTS
    assert refused(**{**good, "joint_names": ["first", "third"]}) is Code.INVALID_JOINTS
    assert refused(**{**good, "joint_names": ["first"]}) is Code.INVALID_JOINTS
    assert refused(**{**good, "points": []}) is Code.INVALID_GOAL
    assert refused(**content((0.0, [0, 0], []), (0.0, [0, 0], []))) is Code.INVALID_GOAL
    assert refused(**content((1.0, [0, 2.1], []))) is Code.INVALID_GOAL
    assert refused(**content((1.0, [0, np.inf], []))) is Code.INVALID_GOAL
    assert refused(**content((1.0, [0, 0], [0, 1]))) is Code.INVALID_GOAL
    overflow = content((0.3, [0, 0], [1e308, 0]), (0.5, [0, 0], [0, 0]))
    assert refused(**overflow) is Code.INVALID_GOAL
    assert refused(**content((0.1, [0, 0], []), stamp=0.5)) is Code.OLD_HEADER_TIMESTAMP
    unknown = [{"name": "third", "position": 0.1, "velocity": 0.0}]
    assert refused(**good, path_tolerance=unknown) is Code.INVALID_JOINTS


def test_the_first_sample_beyond_the_path_tolerance_decides():
    arm = followed(content((2.0, [1, 0], [0, 0])), tolerances=TrackingTolerances(0.05))
    desired = arm.at(TIMES)
    lagging = desired[:2].copy()
    lagging[0, 50:, 0] -= 0.06
    ended = arm.judge(Window(TIMES, desired, lagging, HERE))
    assert (ended.goal, ended.result.error_code) == ("g", Code.PATH_TOLERANCE_VIOLATED)
    assert (
        "'first' is off by 0.06 rad (tolerance 0.05 rad) at t=0.510 s" in ended.result.error_string
    )


@pytest.mark.parametrize(
    ("bound", "code"), [(-1.0, Code.SUCCESSFUL), (0.0, None), (0.2, Code.SUCCESSFUL)]
)
def test_a_goal_s_own_tolerance_replaces_the_default(bound, code):
    own = [{"name": "first", "position": bound, "velocity": 0.0}]
    sent = content((2.0, [1, 0], [0, 0]), goal_tolerance=own)
    arm = followed(sent, tolerances=TrackingTolerances(np.inf, 0.01, 0.5))
    desired = arm.at(TIMES)
    off = desired[:2] + np.array([[[0.1, 0.0]], [[0.0, 0.0]]])
    ended = arm.judge(Window(TIMES, desired, off, HERE))
    assert (ended and ended.result.error_code) == code
    if code is None:
        later = TIMES + 0.5
        ended = arm.judge(Window(later, arm.at(later), off, HERE))
        assert ended.result.error_code == Code.GOAL_TOLERANCE_VIOLATED


@pytest.mark.parametrize("jumps", [[0.05], [3.0], [0.05, 0.05, 0.05], [1.0, -2.0]])
def test_steps_keep_velocity_limits_and_end_at_the_commanded_positions(jumps):
    steps = StepResponse(np.array([2.0]))
    times, dt = np.arange(1, 8001) * 0.002, 0.002
    target, sent, column = 0.0, [], np.array([0])
    for place, now in enumerate(times):
        if place % 25 == 0 and place // 25 < len(jumps):  # each 0.05 s
            jump = jumps[place // 25]
            target += jump
            steps.add(now, column, np.array([jump]))
        sent.append(steps.applied(np.array([now]), np.array([[[target]], [[0.0]], [[0.0]]])))
    positions, velocities, accelerations = np.array(sent)[:, :, 0, 0].T
    assert positions[-1] == pytest.approx(sum(jumps), abs=1e-6)
    limit = 2.0 if len(jumps) == 1 else 2.0 * len(jumps)  # steps before the last are on their way
    assert np.abs(velocities).max() <= limit + 1e-9
    assert np.abs(np.diff(positions)).max() <= limit * dt + 1e-9
    assert np.allclose(np.gradient(positions, dt)[2:-2], velocities[2:-2], atol=0.03 * limit)
    assert np.isfinite(accelerations).all()


def test_what_does_not_jump_is_sent_as_it_is_commanded():
    steps, rows = StepResponse(np.array([2.0])), np.ones((3, 1, 1))
    assert steps.applied(np.array([1.0]), rows) is rows
    steps.add(1.0, np.array([0]), np.array([1e-9]))
    assert steps.applied(np.array([1.01]), rows) is rows
