"""What each kind of motion promises, on problems that hypothesis makes up.

A few of each in every run; a hundred of each with `python -m pytest -m nightly`.
"""

from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from harness.core.spatial import SE3
from harness.ports.goals import (
    AnyGoal,
    JointBand,
    JointGoal,
    OrientationBand,
    PathConstraints,
    PoseGoal,
    PositionBox,
    PositionGoal,
)
from harness.ports.motions import (
    ArcPoint,
    CartesianPathOptions,
    CircularMotion,
    FreeMotion,
    JointMotion,
    JumpThreshold,
    LinearMotion,
    MotionSequence,
    RelativeMotion,
    SequenceItem,
    WaypointMotion,
)
from tests.planning.problem import OPTIONS, Problem

FEW, MANY = 3, 100
ON_PATH, TURNED = 1e-4, np.radians(0.1)
"""How far a link may leave its line or circle [m], and be turned away [rad]."""
REACHED = 1e-6  # [m, rad]

PROPERTIES = {}


def motion(**strategies):
    """Register a property: true when the motion was planned, false when it lawfully was not."""

    def register(function):
        PROPERTIES[function.__name__] = (function, strategies)
        return function

    return register


def holds(name, examples):
    """Put a property to many problems, of which at least a quarter must be solvable.

    Which problems hypothesis draws changes with the constants that it finds in the code.
    """
    function, strategies = PROPERTIES[name]
    found = Counter()

    @settings(
        max_examples=examples,
        phases=(Phase.generate,),  # shrinking a plan takes minutes
        suppress_health_check=list(HealthCheck),
    )
    @given(**strategies)
    def every(**drawn):
        found[function(**drawn)] += 1

    every()
    assert 3 * found[True] >= found[False], found


def around(size, count):
    """`count` numbers from -size to size; shrinks to zeros."""
    return st.lists(st.floats(-size, size), min_size=count, max_size=count).map(np.array)


any_arm = st.sampled_from(["ur3e", "ur5e", "open_manipulator_x"])
six_joints = st.sampled_from(["ur3e", "ur5e"])
nearby, far = around(0.3, 6), around(1.2, 6)
TURN_OF_BASE = np.eye(6)[0]
boxes = st.lists(
    st.tuples(
        around(0.08, 3).map(lambda size: size + 0.12),
        around(0.25, 3).map(lambda place: place + np.array([0.45, 0.15, 0.3])),
    ),
    max_size=3,
)


@motion(
    model=any_arm,
    off=nearby,
    boxes=boxes,
    swing=st.floats(-1.6, -1.2),
    target=nearby,
    block=st.floats(0.04, 0.08),
    seed=st.integers(0, 2**32 - 1),
)
def a_motion_round_a_block_ends_at_its_goal_and_comes_out_the_same_again(
    model, off, boxes, swing, target, block, seed
):
    options = replace(OPTIONS, seed=seed)
    plans = []
    for _ in range(2):
        problem = Problem(model, off, boxes)
        goal = problem.from_home(target + swing * TURN_OF_BASE)
        problem.block(goal, block)
        plans.append(problem.plan(FreeMotion(JointGoal(goal)), options))
    first, second = plans
    if first is None or second is None:
        assert first is second
        return False
    assert np.abs(first.trajectory.positions[-1] - goal).max() < 1e-9
    for name in ("times", "positions", "velocities", "accelerations"):
        assert np.array_equal(getattr(first.trajectory, name), getattr(second.trajectory, name))
    return True


@motion(model=six_joints, off=nearby, boxes=boxes, target=far)
def a_motion_to_a_pose_ends_there(model, off, boxes, target):
    problem = Problem(model, off, boxes)
    pose = problem.pose(problem.from_home(target))
    plan = problem.plan(FreeMotion(PoseGoal(problem.link, pose)))
    if plan is None:
        return False
    assert max(pose.distance_to(problem.poses(plan)[-1])) < REACHED
    return True


@motion(off=nearby, target=nearby, room=st.floats(0.01, 0.05), turns=around(0.4, 3))
def a_motion_to_a_region_ends_inside_it(off, target, room, turns):
    problem = Problem("ur3e", off)
    pose = problem.pose(problem.from_home(target))
    allowed = tuple(0.06 + np.abs(turns))
    goal = PoseGoal(problem.link, pose, room, max(allowed), allowed)
    plan = problem.plan(FreeMotion(goal))
    if plan is None:
        return False
    end = problem.poses(plan)[-1]
    assert np.linalg.norm(end.translation - pose.translation) <= room
    assert np.all(np.abs(pin.log3(pose.rotation.T @ end.rotation)) <= np.array(allowed) + REACHED)
    return True


@motion(model=any_arm, off=nearby, targets=st.lists(far, min_size=1, max_size=4))
def of_several_goals_one_is_reached(model, off, targets):
    problem = Problem(model, off)
    goals = [problem.from_home(target) for target in targets]
    plan = problem.plan(FreeMotion(AnyGoal(tuple(map(JointGoal, goals)))))
    if plan is None:
        return False
    end = plan.trajectory.positions[-1]
    assert min(np.abs(end - goal).max() for goal in goals) < 1e-9
    return True


@motion(model=any_arm, off=nearby, target=far)
def a_ptp_is_straight_in_joint_space(model, off, target):
    problem = Problem(model, off)
    goal = problem.from_home(target)
    plan = problem.plan(JointMotion(goal))
    if plan is None:
        return False
    track, way = plan.trajectory.positions, goal - problem.start
    shares = (track - problem.start) @ way / max(float(way @ way), 1e-18)
    assert np.abs(track - problem.start - shares[:, None] * way).max() < 1e-9
    assert np.abs(track[-1] - goal).max() < 1e-9
    return True


@motion(model=six_joints, off=nearby, shift=around(0.08, 3), turn=around(0.4, 3))
def a_lin_is_on_its_line_and_turned_in_proportion(model, off, shift, turn):
    problem = Problem(model, off)
    goal = problem.moved(shift + np.array([0, 0, 0.1]), turn)
    plan = problem.plan(LinearMotion(goal))
    if plan is None:
        return False
    start, *rest = problem.poses(plan)
    way = goal.pose.translation - start.translation
    for pose in rest:
        gone = pose.translation - start.translation
        share = float(gone @ way) / float(way @ way)
        assert np.linalg.norm(gone - share * way) <= ON_PATH
        assert turned(pose, share, start, goal.pose) <= TURNED
    assert max(goal.pose.distance_to(rest[-1])) < REACHED
    return True


def turned(pose, share, start, end):
    """How far a pose is turned from a share of the way between two others [rad]."""
    turn = pin.log3(end.rotation @ start.rotation.T)
    return float(
        np.linalg.norm(pin.log3(pose.rotation.T @ pin.exp3(share * turn) @ start.rotation))
    )


@motion(
    model=six_joints,
    off=nearby,
    lean=around(0.6, 2),
    angle=st.floats(-3, 3),
    radius=st.floats(0.02, 0.08),
    sweep=st.floats(0.3, 5),
    turn=around(0.4, 3),
    kind=st.sampled_from(["interim", "center"]),
)
def a_circ_is_on_its_circle_and_turned_in_proportion(
    model, off, lean, angle, radius, sweep, turn, kind
):
    problem = Problem(model, off)
    sweep = sweep if kind == "interim" else 0.6 * sweep
    tilt = pin.exp3(np.array([*lean, 0.0])) @ pin.exp3(np.array([0, 0, angle]))
    axis, spoke = tilt[:, 2], radius * tilt[:, 0]
    start = problem.pose(problem.start)
    center = start.translation - spoke

    def place(share):
        return center + pin.exp3(share * sweep * axis) @ spoke

    goal = problem.moved(place(1.0) - start.translation, turn)
    point = place(0.5) if kind == "interim" else center
    plan = problem.plan(CircularMotion(goal, ArcPoint(kind, point)))
    if plan is None:
        return False
    before = 0.0
    for pose in problem.poses(plan):
        out = pose.translation - center
        height = float(out @ axis)
        assert np.hypot(height, np.linalg.norm(out - height * axis) - radius) <= ON_PATH
        gone = float(np.arctan2(np.cross(spoke, out) @ axis, spoke @ out)) % (2 * np.pi)
        gone = 0.0 if gone > 2 * np.pi - 1e-3 else gone
        assert before - 1e-6 <= gone <= sweep + 1e-6
        assert turned(pose, gone / sweep, start, goal.pose) <= TURNED
        before = gone
    assert before == pytest.approx(sweep, abs=1e-5)
    return True


@motion(model=any_arm, off=nearby, direction=around(1, 3), most=st.floats(0.01, 0.2))
def a_relative_motion_goes_its_distance_along_its_line(model, off, direction, most):
    problem = Problem(model, off)
    unit = direction + np.array([0, 0, 1.5])
    unit = unit / np.linalg.norm(unit)
    twist = np.concatenate([unit, np.zeros(3)])
    plan = problem.plan(RelativeMotion(problem.link, twist, (0.01, most + 0.01)))
    if plan is None:
        return False
    track = np.array([pose.translation for pose in problem.poses(plan)])
    gone = (track - track[0]) @ unit
    assert np.linalg.norm(track - track[0] - gone[:, None] * unit, axis=1).max() <= ON_PATH
    assert 0.01 - REACHED <= gone[-1] <= most + 0.01 + REACHED
    assert plan.result.plain()["distance"] == pytest.approx(gone[-1], abs=1e-6)
    return True


corners = st.lists(around(0.06, 3), min_size=2, max_size=4)


@motion(model=six_joints, off=nearby, corners=corners, radius=st.floats(0.002, 0.02))
def a_sequence_leaves_its_lines_inside_its_blends_alone(model, off, corners, radius):
    problem = Problem(model, off)
    points = through(problem, corners)
    goals = [PositionGoal(problem.link, point) for point in points[1:]]
    radii = [radius] * (len(goals) - 1) + [0.0]
    items = [
        SequenceItem("lin", goal, None, blend) for goal, blend in zip(goals, radii, strict=True)
    ]
    plan = problem.plan(MotionSequence(items))
    if plan is None:
        return False
    track = [pose.translation for pose in problem.poses(plan)]
    for place in track:
        blending = any(np.linalg.norm(place - corner) <= radius for corner in points[1:-1])
        assert blending or off_lines(place, points) <= ON_PATH
    assert np.linalg.norm(track[-1] - points[-1]) < REACHED
    return True


@motion(model=any_arm, off=nearby, corners=corners, precision=st.floats(0.0005, 0.01))
def a_cartesian_path_keeps_its_precision(model, off, corners, precision):
    problem = Problem(model, off)
    points = through(problem, corners)
    goals = [PositionGoal(problem.link, point) for point in points[1:]]
    path_options = CartesianPathOptions(0.005, precision, 0.2, JumpThreshold(0.5, 0.1))
    plan = problem.plan(WaypointMotion(goals, path_options))
    if plan is None:
        return False
    track = [pose.translation for pose in problem.poses(plan)]
    worst = max(off_lines(place, points) for place in track)
    assert worst <= precision
    assert plan.result.plain()["deviation"] == pytest.approx(worst, abs=1e-7)
    if plan.result.plain()["fraction"] == 1.0:
        assert np.linalg.norm(track[-1] - points[-1]) < REACHED
    return True


def through(problem, corners):
    """The link's place at the start, and corners relative to it, each away from the one before."""
    start = problem.pose(problem.start).translation
    away = np.array([[0.0, 0.09, 0.04], [0.09, 0.0, 0.04], [0.0, -0.09, 0.04], [-0.09, 0.0, 0.04]])
    return [start, *(start + corner + shift for corner, shift in zip(corners, away, strict=False))]


def off_lines(place, points):
    """Distance of a place from a polyline [m]."""
    gaps = []
    for first, second in pairwise(points):
        way = second - first
        share = float(np.clip((place - first) @ way / (way @ way), 0, 1))
        gaps.append(np.linalg.norm(place - first - share * way))
    return min(gaps)


@motion(
    model=six_joints,
    off=nearby,
    shift=around(0.1, 3),
    across=st.floats(0.2, 0.35),
    tilt=st.floats(0.02, 0.5),
    yaw=st.sampled_from([0.3, 4.0]),
)
def a_cone_a_box_and_a_band_hold_on_every_sample_and_between(model, off, shift, across, tilt, yaw):
    problem = Problem(model, off)
    shift = shift + np.array([0, across, 0.1])  # the straight joint motion bulges out of the box
    here, goal = problem.pose(problem.start), problem.moved(shift)
    middle = 0.5 * (here.translation + goal.pose.translation)
    size = np.abs(shift) + 0.02
    names = [joint.name for joint in problem.joints]
    held = PathConstraints(
        OrientationBand(problem.link, here.rotation, (tilt, tilt, yaw)),
        PositionBox(problem.link, SE3(np.eye(3), middle), tuple(size)),
        (JointBand(names[0], problem.start[0] - 1.0, problem.start[0] + 1.0),),
    )
    plan = problem.plan(FreeMotion(goal, held))
    if plan is None:
        return False
    track = plan.trajectory.positions
    for before, after in pairwise(track):
        for share in (0.0, 1 / 3, 2 / 3):
            positions = before + share * (after - before)
            pose = problem.pose(positions)
            assert np.all(np.abs(pose.translation - middle) <= 0.5 * size + REACHED)
            assert abs(positions[0] - problem.start[0]) <= 1.0 + REACHED
            turn = here.rotation.T @ pose.rotation
            swing = tilted(turn) if yaw > np.pi else pin.log3(turn)
            assert np.all(np.abs(swing) <= np.array([tilt, tilt, yaw]) + REACHED)
    assert max(goal.pose.distance_to(problem.pose(track[-1]))) < REACHED
    return True


def tilted(rotation):
    """The least rotation vector that brings z where a rotation brings it."""
    x, y, z = rotation[:, 2]
    size = np.hypot(x, y)
    return np.zeros(3) if size < 1e-12 else np.arctan2(size, z) / size * np.array([-y, x, 0.0])


@pytest.mark.nightly(
    only=[
        8,
        9,
        0,
        "a_cone_a_box_and_a_band_hold_on_every_sample_and_between",
        "a_motion_to_a_region_ends_inside_it",
        "a_relative_motion_goes_its_distance_along_its_line",
    ]
)
@pytest.mark.parametrize("name", PROPERTIES)
def test_on_a_few_problems(name):
    holds(name, FEW)


@pytest.mark.nightly
@pytest.mark.parametrize("name", PROPERTIES)
def test_on_many_problems(name):
    holds(name, MANY)
