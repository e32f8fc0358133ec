"""CIRC: on its circle, turning evenly, under Cartesian limits; points on no circle are refused."""

import numpy as np
import pytest

from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.ports.goals import PoseGoal, PositionGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import ArcPoint, CartesianLimits, CircularMotion, LinearMotion
from harness.recording.explanation import Explanation
from tests.planning.lesson import ARM, TCP, Cell, grasp_goal, open_manipulator, ur

ABOVE = [-0.858, -1.187, 0.474, -0.858, -1.5708, -1.643]
FAST = PlanningOptions()


@pytest.fixture(scope="module")
def cell():
    cell = Cell(ur("ur3e"))
    cell.state = cell.with_arm(ABOVE)
    arm = cell.kinematics.solve(ARM, grasp_goal(0.25, -0.17, 0.22), cell.state, 0)[0]
    cell.state = cell.with_arm(arm)
    return cell


def poses(cell, plan):
    return [
        cell.kinematics.link_pose(cell.with_arm(positions), TCP)
        for positions in plan.trajectory.positions
    ]


def here(cell):
    return cell.kinematics.link_pose(cell.state, TCP)


def moved(point, x, y, z):
    return point + np.array([x, y, z])


def on_circle(start, center, axis, angle):
    """A point of the circle through the start, turned by an angle: Rodrigues' formula."""
    spoke = start - center
    return (
        center
        + np.cos(angle) * spoke
        + np.sin(angle) * np.cross(axis, spoke)
        + (1 - np.cos(angle)) * axis * float(axis @ spoke)
    )


@pytest.mark.parametrize("seed", range(6))
def test_every_sample_is_on_the_circle_and_turned_in_proportion(cell, seed):
    rng = np.random.default_rng(seed)
    start = here(cell)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    across = np.cross(axis, rng.normal(size=3))
    radius = rng.uniform(0.02, 0.05)
    center = start.translation + radius * across / np.linalg.norm(across)
    sweep = rng.uniform(0.5, 1.9 * np.pi)
    turn = SE3.from_xyz_rpy((0, 0, 0), (0, 0, rng.uniform(-0.3, 0.3)))
    end = on_circle(start.translation, center, axis, sweep)
    goal = PoseGoal(TCP, SE3((start @ turn).rotation, end))
    interim = ArcPoint("interim", on_circle(start.translation, center, axis, sweep / 3))
    plan = cell.planner.plan(MotionRequest(ARM, cell.state, CircularMotion(goal, interim), FAST))
    track = poses(cell, plan)
    whole = start.distance_to(goal.pose)[1]
    assert track[-1].distance_to(goal.pose)[0] < 1e-6
    before = 0.0
    for pose in track:
        out = pose.translation - center
        height = float(out @ axis)
        assert np.hypot(height, np.linalg.norm(out) - radius) < 1e-4
        spoke = (start.translation - center) / radius
        round_it = np.arctan2(float(np.cross(spoke, out) @ axis), float(spoke @ out)) % (2 * np.pi)
        round_it = 0.0 if round_it > 1.99 * np.pi else round_it
        assert round_it >= before - 1e-6
        before = round_it
        turned = start.distance_to(pose)[1]
        assert turned == pytest.approx(whole * round_it / sweep, abs=np.radians(0.1))
    assert before == pytest.approx(sweep, abs=1e-4)


def test_about_a_centre_the_shorter_arc_is_taken(cell):
    start = here(cell).translation
    center = moved(start, 0.05, 0, 0)
    end = moved(center, 0.05 * np.cos(2.0), 0.05 * np.sin(2.0), 0)  # 1.14 rad from the start
    goal = PositionGoal(TCP, end)
    plan = cell.planner.plan(
        MotionRequest(ARM, cell.state, CircularMotion(goal, ArcPoint("center", center)), FAST)
    )
    assert plan.explanation.plain()["sweep"] == pytest.approx(np.pi - 2.0)
    assert plan.explanation.plain()["radius"] == pytest.approx(0.05)
    turned = [here(cell).distance_to(pose)[1] for pose in poses(cell, plan)]
    assert max(turned) < 1e-6  # a position goal keeps the link turned as it is


@pytest.mark.parametrize("kind", ["arc", "line"])
def test_cartesian_limits_hold_on_the_final_samples_and_are_used(cell, kind):
    """By differences of the poses of the samples, centripetal acceleration included."""
    limits = CartesianLimits(0.05, 0.08, 2.0)
    options = PlanningOptions(cartesian_limits=limits)
    start = here(cell).translation
    goal = PositionGoal(TCP, moved(start, 0.04, 0.04, 0.0))
    if kind == "arc":
        point = ArcPoint("center", moved(start, 0.04, 0, 0))
        plan = cell.planner.plan(
            MotionRequest(ARM, cell.state, CircularMotion(goal, point), options)
        )
    else:
        plan = cell.planner.plan(MotionRequest(ARM, cell.state, LinearMotion(goal), options))
    places = np.array([pose.translation for pose in poses(cell, plan)])
    steps = np.diff(plan.trajectory.times)[:, None]
    velocities = np.diff(places, axis=0) / steps
    accelerations = np.diff(velocities, axis=0) / (0.5 * (steps[1:] + steps[:-1]))
    assert np.linalg.norm(velocities, axis=1).max() <= 0.05 * 1.001
    assert np.linalg.norm(velocities, axis=1).max() > 0.045
    assert np.linalg.norm(accelerations, axis=1).max() <= 0.08 * 1.005
    assert np.linalg.norm(accelerations, axis=1).max() > 0.07


@pytest.mark.parametrize(
    ("kind", "radius", "sweep"), [("interim", 0.02, np.pi / 6), ("center", 0.002, np.pi / 2)]
)
def test_a_small_arc_is_no_line(cell, kind, radius, sweep):
    start = here(cell).translation
    center, axis = moved(start, radius, 0, 0), np.array([0, 0, 1.0])
    end, middle = (on_circle(start, center, axis, share * sweep) for share in (1.0, 0.5))
    point = ArcPoint(kind, middle if kind == "interim" else center)
    plan = cell.planner.plan(
        MotionRequest(ARM, cell.state, CircularMotion(PositionGoal(TCP, end), point), FAST)
    )
    assert plan.explanation.plain()["sweep"] == pytest.approx(sweep)
    assert plan.explanation.plain()["radius"] == pytest.approx(radius)
    track = np.array([pose.translation for pose in poses(cell, plan)])
    assert np.linalg.norm(track - center, axis=1) == pytest.approx(radius, abs=1e-4)


def no_circle(cell, goal, point):
    with pytest.raises(PlanningFailed) as caught:
        cell.planner.plan(
            MotionRequest(ARM, cell.state, CircularMotion(PositionGoal(TCP, goal), point), FAST)
        )
    assert caught.value.code == "INVALID_MOTION_PLAN"
    advice = caught.value.details.find(Explanation).advice
    assert "in the way" not in advice
    return f"{caught.value.message}; {advice}"


def test_points_that_make_no_circle_are_refused(cell):
    start = here(cell).translation
    x = np.array([1.0, 0, 0])
    on_a_line = no_circle(cell, start + 0.06 * x, ArcPoint("interim", start + 0.03 * x))
    assert "start, interim point and goal are on one line" in on_a_line
    half = no_circle(cell, start + 0.06 * x, ArcPoint("center", start + 0.03 * x))
    assert "give an `interim` point" in half
    uneven = no_circle(cell, moved(start, 0.05, 0.03, 0), ArcPoint("center", start + 0.05 * x))
    assert "the start is 50.0 mm from the centre, the goal 30.0 mm" in uneven
    full = no_circle(cell, start, ArcPoint("interim", moved(start, 0.03, 0.03, 0)))
    assert "start and goal are the same point" in full
    assert "two `circ` steps" in full
    about = no_circle(cell, start, ArcPoint("center", moved(start, 0.03, 0.03, 0)))
    assert "start and goal are the same point" in about
    twice = no_circle(cell, start + 0.06 * x, ArcPoint("interim", start + 0.06 * x))
    assert "goal and interim point are the same point" in twice
    central = no_circle(cell, start + 1e-3 * x, ArcPoint("center", start))
    assert "start and centre are the same point" in central


def test_an_arc_out_of_reach_says_how_far_it_goes(cell):
    start = here(cell).translation
    point = ArcPoint("interim", moved(start, 0.0, 0.6, 0.4))
    with pytest.raises(PlanningFailed) as caught:
        cell.planner.plan(
            MotionRequest(
                ARM,
                cell.state,
                CircularMotion(PositionGoal(TCP, moved(start, 0, 0.1, 0)), point),
                FAST,
            )
        )
    assert caught.value.code in ("NO_IK_SOLUTION", "PLANNING_FAILED", "INVALID_MOTION_PLAN")
    assert "can follow the arc for" in caught.value.message
    assert 0 < caught.value.facts["free_share"] < 1


def test_four_joints_go_round_with_position_and_pitch():
    cell = Cell(open_manipulator())
    cell.state[:4] = [0.0, 0.1, 0.6, -0.7]
    start = cell.kinematics.link_pose(cell.state, TCP)
    goal = PositionGoal(TCP, moved(start.translation, 0.0, 0.06, 0.0))
    interim = ArcPoint("interim", moved(start.translation, 0.0, 0.03, 0.03))
    plan = cell.planner.plan(MotionRequest("arm", cell.state, CircularMotion(goal, interim), FAST))
    center = moved(start.translation, 0, 0.03, 0)
    for positions in plan.trajectory.positions:
        pose = cell.kinematics.link_pose(cell.with_arm(positions), TCP)
        assert np.linalg.norm(pose.translation - center) == pytest.approx(0.03, abs=1e-4)
        assert pose.rotation[2, 0] == pytest.approx(start.rotation[2, 0], abs=1e-3)
