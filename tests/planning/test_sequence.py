"""Sequences and Cartesian paths: blended without stops, inside their spheres, all or nothing."""

from itertools import pairwise

import numpy as np
import pytest

from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.ports.goals import JointGoal, PoseGoal, PositionGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import (
    ArcPoint,
    CartesianLimits,
    CartesianPathOptions,
    CircularMotion,
    JumpThreshold,
    LinearMotion,
    MotionSequence,
    SequenceItem,
    WaypointMotion,
)
from harness.recording.explanation import Explanation
from harness.recording.plan_statistics import WayStatistics
from tests.planning.lesson import ARM, TCP, Cell, grasp_goal, open_manipulator, ur

HALF = PlanningOptions(velocity_scaling=0.5, acceleration_scaling=0.5)
PATH = CartesianPathOptions(0.005, 0.001, 1.0, JumpThreshold(0.5, 0.1))


@pytest.fixture
def cell():
    cell = Cell(ur("ur3e"))
    cell.state = cell.with_arm([-0.858, -1.187, 0.474, -0.858, -1.5708, -1.643])
    arm = cell.kinematics.solve(ARM, grasp_goal(0.25, -0.17, 0.22), cell.state, 0)[0]
    cell.state = cell.with_arm(arm)
    return cell


def places(cell, plan):
    return np.array(
        [
            cell.kinematics.link_pose(cell.with_arm(positions), TCP).translation
            for positions in plan.trajectory.positions
        ]
    )


def near(cell, x, y, z):
    start = cell.kinematics.link_pose(cell.state, TCP).translation
    return PositionGoal(TCP, start + np.array([x, y, z]))


def mixed(cell, radius):
    """A line, an arc, a joint motion and a line back."""
    through = near(cell, 0.03, 0.09, 0.0).position
    return [
        SequenceItem("lin", near(cell, 0.06, 0, 0), None, radius),
        SequenceItem("circ", near(cell, 0.0, 0.06, 0), ArcPoint("interim", through), radius),
        SequenceItem("ptp", near(cell, 0, 0, 0.05), None, radius),
        SequenceItem("lin", near(cell, 0, 0, 0)),
    ]


def speeds(plan):
    return np.linalg.norm(plan.trajectory.velocities, axis=1)


def test_blended_motions_do_not_stop_between_and_unblended_ones_do(cell):
    blended = cell.planner.plan(
        MotionRequest(ARM, cell.state, MotionSequence(mixed(cell, 0.015)), HALF)
    )
    stopping = cell.planner.plan(
        MotionRequest(ARM, cell.state, MotionSequence(mixed(cell, 0.0)), HALF)
    )
    assert blended.result.plain() == {"items": 4, "stops": 0, "blends": 3}
    assert stopping.result.plain() == {"items": 4, "stops": 3, "blends": 0}
    assert speeds(blended)[1:-1].min() > 0.01
    assert int((speeds(stopping) < 1e-9).sum()) == 5
    assert blended.trajectory.duration < 0.85 * stopping.trajectory.duration


def test_outside_its_spheres_a_sequence_is_on_its_lines_and_arcs(cell):
    radius = 0.015
    items = mixed(cell, radius)
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, MotionSequence(items), HALF))
    track = places(cell, plan)
    start, first, second = track[0], items[0].goal.position, items[1].goal.position
    corners = np.array([item.goal.position for item in items[:-1]])
    away = np.linalg.norm(track[:, None] - corners, axis=2)
    corner_passed = int(np.argmin(away[:, 0]))
    assert 0 < away[:, 0].min() < radius / 2  # it cuts the corner, and not by much
    for place in track[:corner_passed][away[:corner_passed, 0] > radius]:
        along = (first - start) / np.linalg.norm(first - start)
        off = (place - start) - along * float((place - start) @ along)
        assert np.linalg.norm(off) < 1e-4
    arc = cell.planner.plan(
        MotionRequest(ARM, _at(cell, first), CircularMotion(items[1].goal, items[1].point), HALF)
    ).explanation.plain()
    until = int(np.argmin(away[:, 1]))
    between = slice(corner_passed, until)
    on_arc = (away[between, 0] > radius) & (away[between, 1] > radius)
    radii = np.linalg.norm(track[between][on_arc] - np.array(arc["center"]), axis=1)
    assert len(radii) > 5
    assert np.abs(radii - arc["radius"]).max() < 1e-4
    assert np.linalg.norm(track - second, axis=1).min() > 1e-4


def _at(cell, point):
    pose = cell.kinematics.link_pose(cell.state, TCP)
    goal = PoseGoal(TCP, SE3(pose.rotation, point))
    return cell.with_arm(cell.kinematics.solve(ARM, goal, cell.state, 0)[0])


def test_a_sequence_keeps_joint_and_cartesian_limits_on_every_sample(cell):
    slow = CartesianLimits(0.04, 0.1, 1.0)
    items = [
        SequenceItem("lin", near(cell, 0.06, 0, 0), None, 0.02, slow),
        SequenceItem("lin", near(cell, 0.06, 0.06, 0), None, 0.0, slow),
    ]
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, MotionSequence(items), HALF))
    track, steps = places(cell, plan), np.diff(plan.trajectory.times)[:, None]
    velocities = np.diff(track, axis=0) / steps
    accelerations = np.diff(velocities, axis=0) / (0.5 * (steps[1:] + steps[:-1]))
    assert np.linalg.norm(velocities, axis=1).max() <= 0.04 * 1.002
    assert np.linalg.norm(accelerations, axis=1).max() <= 0.1 * 1.01
    assert np.linalg.norm(velocities, axis=1)[20:-20].min() > 0.02  # and does not crawl
    limits = [cell.description.joint_by_name[name] for name in plan.trajectory.joint_names]
    most = np.array([[joint.velocity, joint.acceleration] for joint in limits]).T / 2
    assert np.all(np.abs(plan.trajectory.velocities) <= most[0] * (1 + 1e-9))
    assert np.all(np.abs(plan.trajectory.accelerations) <= most[1] * (1 + 1e-9))


def failure(call, *arguments):
    with pytest.raises(PlanningFailed) as caught:
        call(*arguments)
    return caught.value


def test_what_cannot_be_blended_is_refused_and_nothing_moves(cell):
    turn = near(cell, 0.03, 0.03, 0).position
    arc = SequenceItem("circ", near(cell, 0.0, 0.001, 0), ArcPoint("interim", turn), 0.05)
    items = [arc, SequenceItem("lin", near(cell, 0, 0.02, 0))]
    too_large = failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, MotionSequence(items), HALF)
    )
    assert too_large.code == "INVALID_MOTION_PLAN"
    assert "blend radius of 50.0 mm is larger than item" in too_large.message
    far = [
        SequenceItem("ptp", JointGoal(cell.named("up"))),
        SequenceItem("lin", near(cell, 9, 0, 0)),
    ]
    second = failure(cell.planner.plan, MotionRequest(ARM, cell.state, MotionSequence(far), HALF))
    assert second.code == "NO_IK_SOLUTION"
    assert second.message.startswith("item 2 (lin): ")
    assert second.facts["item"] == 1


def test_a_cartesian_path_rounds_its_corners_within_the_precision(cell):
    corners = [(0.05, 0, 0), (0.05, 0.05, 0), (0, 0.05, 0)]
    goals = [near(cell, *corner) for corner in corners]
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, WaypointMotion(goals, PATH), HALF))
    track = places(cell, plan)
    points = [track[0], *(goal.position for goal in goals)]
    worst = 0.0
    for place in track:
        gaps = []
        for first, second in pairwise(points):
            share = float((place - first) @ (second - first)) / float(
                (second - first) @ (second - first)
            )
            near_by = first + min(max(share, 0), 1) * (second - first)
            gaps.append(float(np.linalg.norm(place - near_by)))
        worst = max(worst, min(gaps))
    assert plan.result.plain()["deviation"] == pytest.approx(worst, abs=1e-9)
    assert 1e-4 < worst <= PATH.precision
    assert plan.result.plain()["fraction"] == 1.0
    assert 0 < plan.result.plain()["largest_joint_step"] < 0.1
    assert speeds(plan)[1:-1].min() > 1e-3
    assert np.allclose(track[-1], points[-1], atol=1e-6)


def test_a_cartesian_path_goes_as_far_as_it_can_and_says_how_far(cell):
    goals = [near(cell, 0.05, 0, 0), near(cell, 0.55, 0, 0)]
    refused = failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, WaypointMotion(goals, PATH), HALF)
    )
    assert refused.code == "PLANNING_FAILED"
    assert "at least 100 % is required" in refused.message
    part = CartesianPathOptions(0.005, 0.001, 0.2, PATH.jump)
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, WaypointMotion(goals, part), HALF))
    assert plan.result.plain()["fraction"] == pytest.approx(refused.facts["fraction"])
    track = places(cell, plan)
    assert np.linalg.norm(track[-1] - track[0]) == pytest.approx(
        0.55 * plan.result.plain()["fraction"]
    )
    more = CartesianPathOptions(0.005, 0.001, 0.9, PATH.jump)
    assert failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, WaypointMotion(goals, more), HALF)
    )


def test_a_jump_threshold_ends_a_path_where_a_joint_steps_farther(cell):
    goals = [near(cell, 0.1, 0, 0)]
    free = cell.planner.plan(MotionRequest(ARM, cell.state, WaypointMotion(goals, PATH), HALF))
    tight = JumpThreshold(0.9 * free.result.plain()["largest_joint_step"], 0.1)
    path_options = CartesianPathOptions(0.005, 0.001, 1.0, tight)
    refused = failure(
        cell.planner.plan, MotionRequest(ARM, cell.state, WaypointMotion(goals, path_options), HALF)
    )
    assert "would jump" in refused.message
    assert refused.facts["reason"] == "jump"


def test_four_joints_follow_a_sequence_and_a_path():
    cell = Cell(open_manipulator())
    cell.state[:4] = [0.0, 0.1, 0.6, -0.7]
    goals = [near(cell, 0, 0.03, 0.02), near(cell, 0, 0.03, -0.02), near(cell, 0, 0, 0)]
    items = [SequenceItem("lin", goal, None, 0.008) for goal in goals]
    items[-1] = SequenceItem("lin", goals[-1])
    plan = cell.planner.plan(MotionRequest("arm", cell.state, MotionSequence(items), HALF))
    assert plan.result.plain()["blends"] == 2
    assert np.allclose(plan.trajectory.positions[-1], cell.state[:4], atol=1e-6)
    path = cell.planner.plan(MotionRequest("arm", cell.state, WaypointMotion(goals, PATH), HALF))
    assert path.result.plain()["fraction"] == 1.0


SINGULAR = {
    "elbow": [0.3, -1.4, 0.0, -1.4, -1.57, 0.0],
    "wrist": [0.3, -1.4, 1.5, -1.7, 0.0, 0.0],
    "shoulder": [0.3, -1.97, 1.4, 1.96, -1.57, 0.0],
}


@pytest.mark.parametrize("kind", SINGULAR)
@pytest.mark.parametrize("seed", range(3))
def test_a_line_by_a_singularity_is_slowed_or_refused_without_a_spike(kind, seed):
    """Of a UR3e stretched, with its last axes in line, with its wrist above its base."""
    cell = Cell(ur("ur3e"), with_tables=False)
    rng = np.random.default_rng(seed)
    singular = cell.kinematics.link_pose(cell.with_arm(SINGULAR[kind]), TCP)
    along = rng.normal(size=3)
    along *= 0.04 / np.linalg.norm(along)
    inside = singular.rotation @ np.array([0, 0, -0.003 * seed])
    first, last = (
        PoseGoal(TCP, SE3(singular.rotation, singular.translation + inside + sign * along))
        for sign in (-1, 1)
    )
    starts = cell.kinematics.solve(ARM, first, cell.with_arm(SINGULAR[kind]), 0)
    if not starts:  # beyond the reach: begin in the singularity itself
        starts = [np.array(SINGULAR[kind])]
    cell.state = cell.with_arm(starts[0])
    outcome = attempt(cell, last)
    if isinstance(outcome, PlanningFailed):
        assert outcome.code in ("NO_IK_SOLUTION", "PLANNING_FAILED")
        assert any(
            words in outcome.message for words in ("singularity", "reaches no farther", "away")
        )
        return
    trajectory = outcome.trajectory
    joints = [cell.description.joint_by_name[name] for name in trajectory.joint_names]
    by_differences = np.diff(trajectory.positions, axis=0) / np.diff(trajectory.times)[:, None]
    assert np.all(np.abs(by_differences) <= [joint.velocity * 1.001 for joint in joints])
    assert outcome.statistics.find(WayStatistics).position_deviation < 1e-4


def attempt(cell, goal):
    try:
        return cell.planner.plan(
            MotionRequest(ARM, cell.state, LinearMotion(goal), PlanningOptions())
        )
    except PlanningFailed as failed:
        return failed


TINY = 1e-8  # [m] the error of a pose that inverse kinematics solved


@pytest.mark.parametrize("off", [0.0, TINY])
@pytest.mark.parametrize("repeated", [0, 1, 2])
def test_repeated_waypoints_change_nothing(cell, repeated, off):
    """The first waypoint is the present pose; another one is repeated."""
    corners = [(0, 0, 0), (0.05, 0, 0), (0.05, 0.05, 0)]
    again = [*corners[: repeated + 1], *corners[repeated:]]
    shifted = [near(cell, x + off * index, y, z) for index, (x, y, z) in enumerate(again)]
    plain = [near(cell, *corner) for corner in corners[1:]]
    plans = [
        cell.planner.plan(MotionRequest(ARM, cell.state, WaypointMotion(goals, PATH), HALF))
        for goals in (plain, shifted)
    ]
    first, second = (plan.result.plain() for plan in plans)
    assert second["fraction"] == 1
    # durations a step of 2 ms apart put the set points elsewhere on the rounded corner
    assert second["deviation"] == pytest.approx(first["deviation"], abs=5e-5)
    assert places(cell, plans[1])[-1] == pytest.approx(plain[-1].position, abs=1e-6)
    assert plans[1].trajectory.duration == pytest.approx(plans[0].trajectory.duration, abs=0.01)


@pytest.mark.parametrize("off", [0.0, TINY])
def test_a_path_to_where_the_link_is_moves_nothing(cell, off):
    goals = [near(cell, off, 0, 0), near(cell, 0, 0, 0)]
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, WaypointMotion(goals, PATH), HALF))
    still = {"fraction": 1.0, "largest_joint_step": 0.0, "deviation": 0.0}
    assert plan.result.plain() == still
    assert np.all(plan.trajectory.positions == plan.trajectory.positions[0])


def test_a_path_that_is_blocked_at_once_fails_unless_nothing_of_it_is_required(cell):
    goals, state = [near(cell, 0, 0, 9)], cell.with_arm([0, -np.pi / 2, 0, 0, 0, 0])
    request = MotionRequest(ARM, state, WaypointMotion(goals, PATH), HALF)
    blocked = failure(cell.planner.plan, request)
    assert "can follow 0.0 % of its path" in blocked.message
    none = CartesianPathOptions(0.005, 0.001, 0.0, JumpThreshold(0.5, 0.1))
    plan = cell.planner.plan(MotionRequest(ARM, state, WaypointMotion(goals, none), HALF))
    assert plan.result.plain()["fraction"] == 0
    assert np.all(plan.trajectory.positions == plan.trajectory.positions[0])


@pytest.mark.parametrize("off", [0.0, TINY])
@pytest.mark.parametrize("radius", [0.0, 0.01])
def test_items_that_stay_neither_stop_nor_blend(cell, radius, off):
    def line(x, y, blend=0.0):
        return SequenceItem("lin", near(cell, x, y, 0), None, blend)

    stay = SequenceItem("ptp", near(cell, 0.05, off, 0), None, 0.02)
    items = [line(off, 0, 0.02), line(0.05, 0, radius), stay, line(0.05, off, 0.02)]
    items.append(line(0.05, 0.05))
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, MotionSequence(items), HALF))
    corner = {"stops": int(radius == 0), "blends": int(radius > 0)}
    assert plan.result.plain() == {"items": 5, **corner}
    end = near(cell, 0.05, 0.05, 0).position
    assert places(cell, plan)[-1] == pytest.approx(end, abs=1e-6)


def test_a_sequence_of_items_that_stay_moves_nothing(cell):
    items = [SequenceItem("ptp", near(cell, 0, 0, 0), None, 0.02)]
    items.append(SequenceItem("lin", near(cell, 0, 0, 0)))
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, MotionSequence(items), HALF))
    assert plan.result.plain() == {"items": 2, "stops": 0, "blends": 0}
    assert np.all(plan.trajectory.positions == plan.trajectory.positions[0])


@pytest.mark.parametrize("item", ["circ", "lin"])
def test_geometry_is_not_blamed_on_obstacles(cell, item):
    """An arc of a whole turn, and a blend that is larger than its line."""
    here = near(cell, 0, 0, 0)
    items = {
        "circ": [SequenceItem("circ", here, ArcPoint("interim", near(cell, 0.03, 0, 0).position))],
        "lin": [SequenceItem("lin", near(cell, 0.01, 0, 0), None, 0.05)],
    }[item]
    items.append(SequenceItem("lin", near(cell, 0, 0.1, 0)))
    request = MotionRequest(ARM, cell.state, MotionSequence(items), HALF)
    refused = failure(cell.planner.plan, request)
    advice = refused.details.find(Explanation).advice
    assert {"circ": "two `circ`", "lin": "`blend_radius` smaller"}[item] in advice
    assert "in the way" not in advice
