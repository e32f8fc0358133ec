"""tcp_path: how far the TCP strays from a line or an arc, and how much of it it travels."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.judging.window import NotObservable
from harness.plugins.paths.expectations.fraction import FractionCheck
from harness.plugins.paths.expectations.tcp_path import TcpPath, along_arc, along_line
from harness.reporting.margins import allowance_used, margin_share
from harness.robot.mechanism import fixed_joint
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import (
    ROBOT,
    at,
    changed,
    followed,
    heights,
    joint,
    make_run,
    step,
    verdict,
)

LINE = {"start": {"xyz": [0, 0, 0.3]}, "end": {"xyz": [0, 0, 0.5]}}


ARC = {
    "start": {"xyz": [0.2, 0, 0]},
    "interim": {"xyz": [0, 0.2, 0]},
    "end": {"xyz": [-0.2, 0, 0]},
}


def along_z(offset=0.0, start=0.3, end=0.5):
    tcp = heights(np.linspace(start, end, 200))
    tcp[100, 0] = offset
    return make_run(tcp_pose=tcp)


def around(radius, first=0.0, last=np.pi):
    angle = np.linspace(first, last, 200)
    path = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)
    return make_run(tcp_pose=at(200, path))


def test_a_line_is_followed_near_enough_and_from_end_to_end():
    spec = TcpPath(line=LINE, max_deviation=0.002)
    answer = verdict(along_z(0.0015), spec)
    assert (answer.status, answer.unit) == ("passed", "m"), "all of the line was travelled"
    assert answer.margin == pytest.approx(5e-4)
    short = verdict(along_z(0.0015, end=0.492), spec)
    assert (short.status, short.unit) == ("passed", "1"), "the share is the tighter of the two"
    assert short.margin == pytest.approx(0.01, abs=1e-6)
    strayed = verdict(along_z(0.0021), spec)
    assert (strayed.status, strayed.unit) == ("failed", "m")
    assert strayed.margin == pytest.approx(-1e-4)
    assert strayed.time == pytest.approx(1.0)
    assert verdict(along_z(end=0.5019), spec).status == "passed", "2 mm beyond the end"
    assert verdict(along_z(end=0.5021), spec).status == "failed"


def test_a_tcp_that_stands_on_the_line_has_not_followed_it():
    spec = TcpPath(line=LINE)
    standing = verdict(make_run(), spec)
    assert (standing.status, standing.unit) == ("failed", "1")
    assert standing.margin == pytest.approx(-0.95)
    assert "travelled 0.0 % of the line forwards" in standing.reason
    assert verdict(along_z(end=0.489), spec).status == "failed"
    assert verdict(along_z(end=0.489), TcpPath(line=LINE, min_fraction=0.9)).status == "passed"
    assert verdict(along_z(), TcpPath(line=LINE, during="later")).status == "not reached"


def test_a_line_or_an_arc_travelled_backwards_has_not_been_followed():
    for run, spec in (
        (along_z(start=0.5, end=0.3), TcpPath(line=LINE)),
        (around(0.2, np.pi, 0), TcpPath(arc=ARC)),
    ):
        backwards = verdict(run, spec)
        assert (backwards.status, backwards.unit) == ("failed", "1")
        assert backwards.margin == pytest.approx(-0.95)
    turned = {"start": LINE["end"], "end": LINE["start"]}
    assert verdict(along_z(start=0.5, end=0.3), TcpPath(line=turned)).status == "passed"


def test_a_line_travelled_to_and_fro_has_been_followed_once():
    there = np.linspace(0.3, 0.5, 100)
    for z in (np.concatenate([there, there[::-1]]), np.concatenate([there[::-1], there])):
        assert verdict(make_run(tcp_pose=heights(z)), TcpPath(line=LINE)).status == "passed"
    half = np.concatenate([np.linspace(0.4, 0.3, 100), np.linspace(0.3, 0.4, 100)])
    answer = verdict(make_run(tcp_pose=heights(half)), TcpPath(line=LINE))
    assert answer.margin == pytest.approx(0.5 - 0.95)


def test_an_arc_is_followed_on_its_own_side_only():
    spec = TcpPath(arc=ARC, max_deviation=0.002)
    inside = around(0.2)
    inside.signals.tcp_pose[100, 2] = 1e-3  # elsewhere only rounding errors
    assert verdict(inside, spec).status == "passed"
    outside = verdict(around(0.2021), spec)
    assert (outside.status, outside.margin) == ("failed", pytest.approx(-1e-4))
    other_way = verdict(around(0.2, 0, -np.pi), spec)
    assert other_way.margin == pytest.approx(0.002 - np.hypot(0.2, 0.2), abs=2e-3)
    half = verdict(around(0.2, 0, np.pi / 2), spec)
    assert (half.status, half.margin) == ("failed", pytest.approx(0.5 - 0.95))


def test_an_arc_through_points_on_a_line_cannot_be_judged():
    flat = {**ARC, "interim": {"xyz": [0.1, 0, 0]}}
    assert verdict(make_run(), TcpPath(arc=flat)).status == "not observable"
    point = {"start": LINE["start"], "end": LINE["start"]}
    assert verdict(make_run(), TcpPath(line=point)).status == "not observable"
    with pytest.raises(ValueError, match="takes `line` or `arc`, not both"):
        TcpPath(line=LINE, arc=ARC)


def test_a_line_in_the_frame_of_an_object_moves_with_it():
    run = along_z()
    carried = changed(run, object_poses={"box": run.signals.tcp_pose})
    in_box = {"start": {"frame": "box"}, "end": {"frame": "box", "xyz": [0, 0, 0.1]}}
    answer = verdict(carried, TcpPath(line=in_box))
    assert (answer.status, answer.unit) == ("failed", "1"), "it stands at the line's start"


@pytest.mark.parametrize("at_least", [0.95, 1.0])
def test_a_path_that_was_followed_to_its_end_has_the_largest_margin(at_least):
    path = step("path", 0, 200, "cartesian_path", result=followed(1.0))
    answer = verdict(make_run(steps=(path,)), FractionCheck(at_least=at_least))
    assert (answer.status, margin_share(answer)) == ("passed", 1.0)
    assert allowance_used(answer.measures[0]) == 0.0


def sliding(z, planned, verb="lin"):
    """A robot whose TCP slides along z by its joint `shoulder`; planned positions of a step."""
    joints = (
        fixed_joint("base_joint", "world", "base_link", SE3.from_xyz_rpy((0.1, 0.2, 0.3))),
        joint("shoulder", "prismatic", "base_link", "palm", -1.0, 1.0, 2.0, 5.0, 10.0),
        *ROBOT.joints[3:],
    )
    tcp = at(200, (0.1, 0.2, 0.3))
    tcp[:, 2] += z
    positions = np.asarray(planned, dtype=float)[:, None]
    still = np.zeros_like(positions)
    times = np.linspace(0, 1.99, len(planned))
    trajectory = JointTrajectory(("shoulder",), times, positions, still, still)
    moving = step("go", 0, 200, verb, trajectory=trajectory)
    return make_run(tcp_pose=tcp, robot=replace(ROBOT, joints=joints), steps=(moving,))


def test_a_step_s_own_path_is_the_line_from_its_start_to_its_goal():
    whole = np.linspace(0.0, 0.2, 200)
    answer = verdict(sliding(whole, [0.0, 0.05, 0.2]), TcpPath(), "go")
    assert (answer.status, answer.unit) == ("passed", "m")
    assert answer.margin == pytest.approx(0.001)
    half = verdict(sliding(whole / 2, [0.0, 0.2]), TcpPath(), "go")
    assert (half.status, half.margin) == ("failed", pytest.approx(0.5 - 0.95))
    aside = sliding(whole, [0.0, 0.2])
    aside.signals.tcp_pose[100, 0] += 0.002
    assert verdict(aside, TcpPath(), "go").margin == pytest.approx(-0.001)
    beyond = verdict(sliding(1.02 * whole, [0.0, 0.2]), TcpPath(during="go"))
    assert beyond.margin == pytest.approx(0.001 - 0.004)


@pytest.mark.parametrize("planned", [[0.0, 0.4, 1.5], [0.0, 0.2, 0.9, 1.2, 1.5]])
def test_a_circ_step_s_own_path_is_the_arc_from_its_start_to_its_goal(planned):
    """The palm turns about the world's z axis, 0.2 m away from it."""
    joints = (
        joint("shoulder", "revolute", "world", "arm_link", -2.0, 2.0, 2.0, 5.0, 10.0),
        fixed_joint("palm_joint", "arm_link", "palm", SE3.from_xyz_rpy((0.2, 0.0, 0.0))),
        *ROBOT.joints[3:],
    )
    for last, status in ((1.5, "passed"), (1.4, "failed")):
        run = sliding(np.zeros(200), planned, "circ")
        run = replace(run, robot=replace(ROBOT, joints=joints))
        run = changed(run, tcp_pose=around(0.2, 0.0, last).signals.tcp_pose)
        assert verdict(run, TcpPath(), "go").status == status
    answer = verdict(
        changed(run, tcp_pose=around(0.2, 0.0, 1.45).signals.tcp_pose), TcpPath(), "go"
    )
    assert answer.margin == pytest.approx(1.45 / 1.5 - 0.95)


def test_a_step_without_a_path_of_its_own_is_not_observable():
    run = sliding(np.linspace(0.0, 0.2, 200), [0.0, 0.2])
    assert verdict(run, TcpPath()).status == "not observable"
    waiting = make_run(steps=(step("wait", 0, 200, "wait"),))
    assert verdict(waiting, TcpPath(), "wait").status == "not observable"
    straight = verdict(sliding(np.linspace(0, 0.2, 200), [0.0, 0.1, 0.2], "circ"), TcpPath(), "go")
    assert straight.status == "not observable"
    assert straight.reason.startswith("the three points of the arc lie on a line")
    still = sliding(np.zeros(200), [0.1, 0.1])
    assert verdict(still, TcpPath(), "go").status == "not observable", "it has no length"
    failed = make_run(
        steps=(step("go", 0, 200, "lin", status="failed", error_code="PLANNING_FAILED"),),
        ended_early="PLANNING_FAILED: no line",
    )
    assert verdict(failed, TcpPath(), "go").status == "not reached"


@pytest.mark.parametrize("turn", [0.3, 2.0, 3.5, 6.0])
@pytest.mark.parametrize("seed", range(3))
def test_the_distance_to_an_arc_is_that_of_its_nearest_point(turn, seed):
    """Compared with the nearest of many points of the arc, in a plane that is turned at random."""
    rng = np.random.default_rng(seed)
    plane = SE3.from_xyz_rpy(rng.uniform(-0.5, 0.5, 3), rng.uniform(-3, 3, 3))
    radius = rng.uniform(0.05, 0.5)

    def on_arc(share):
        angle = turn * np.atleast_1d(share)
        flat = radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        return flat @ plane.rotation.T + plane.translation

    points = plane.translation + rng.uniform(-2 * radius, 2 * radius, (12, 3))
    start, interim, end = (
        np.tile(on_arc(share), (12, 1)) for share in (0.0, rng.uniform(0.2, 0.8), 1.0)
    )
    distances, places = along_arc(points, start, interim, end)
    shares = np.linspace(0, 1, 20001)
    apart = np.linalg.norm(points[:, None] - on_arc(shares)[None], axis=2)
    assert distances == pytest.approx(apart.min(axis=1), abs=1e-6)
    assert places == pytest.approx(shares[apart.argmin(axis=1)], abs=2e-4)


@pytest.mark.parametrize(("height", "is_judged"), [(1.1e-6, True), (0.9e-6, False)])
def test_three_points_are_on_a_line_where_one_is_a_micrometre_from_the_line_of_the_others(
    height, is_judged
):
    """Whatever the length of the arc: here 30 cm."""
    points = np.zeros((4, 3))
    start, interim, end = (
        np.tile(place, (4, 1)) for place in ([0, 0, 0], [0.1, height, 0], [0.3, 0.0, 0])
    )
    if is_judged:
        assert along_arc(points, start, interim, end)[0] == pytest.approx([0.0] * 4, abs=1e-7)
    else:
        with pytest.raises(NotObservable, match="lie on a line"):
            along_arc(points, start, interim, end)


def test_three_times_the_same_point_is_no_arc():
    points = np.ones((4, 3))
    with pytest.raises(NotObservable, match="lie on a line"):
        along_arc(points, points, points, points)


@pytest.mark.parametrize(("length", "is_judged"), [(1.1e-6, True), (0.9e-6, False)])
def test_a_line_is_longer_than_a_micrometre(length, is_judged):
    start, end = np.zeros((2, 3)), np.tile([0, length, 0], (2, 1))
    if is_judged:
        assert along_line(end, start, end)[1].tolist() == [1.0, 1.0]
    else:
        with pytest.raises(NotObservable, match="one point"):
            along_line(end, start, end)


PICTURED_LINE = "{line: {start: {xyz: [0.2, -0.08, 0.1]}, end: {xyz: [0.2, 0.08, 0.1]}}, "
PICTURED_BACK = "{line: {start: {xyz: [0.2, 0.08, 0.1]}, end: {xyz: [0.2, -0.08, 0.1]}}, "
EVIDENCE = Evidence(
    three_runs=(
        Three(
            TcpPath(line=shared.LINE, max_deviation=0.002),
            shared.straying(0),
            shared.straying(0.0021),
            -1e-4,
            "m",
        ),
    ),
    mutation_cases=((TcpPath(line=shared.LINE), shared.late(tcp_pose=shared.ALONG), "late"),),
    picture=(
        ("paths", PICTURED_LINE + "max_deviation: 2 mm, during: straight}"),
        ("paths", PICTURED_BACK + "max_deviation: 2 mm, during: bent}"),
    ),
    free_shifts=(
        Free("a path has no orientation", "tcp_path", "tcp_pose", "+-roll +-pitch +-yaw"),
    ),
)
