"""Where things stood, when they were there, where they started, and how fast they were."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.judging.body_motion import body_speeds, calm, rates
from harness.judging.poses import (
    JUMP,
    frame_poses,
    frame_present,
    link_poses,
    object_poses,
    observed_for,
    physical_poses,
    present,
    start_poses,
)
from harness.judging.window import NotObservable
from tests.judging.synthetic_run import BOX, DT, TABLE, at, heights, make_run, step, thing

N = 40


def where(mask):
    return np.flatnonzero(mask).tolist()


def test_links_stand_where_they_were_recorded_or_fixed():
    elbow = heights(np.linspace(0, 1, N))
    run = make_run(N, frames={"arm_link": elbow})
    assert link_poses(run, "world").tolist() == at(N).tolist()
    assert link_poses(run, "palm").tolist() == run.signals.tcp_pose.tolist()
    assert link_poses(run, "arm_link").tolist() == elbow.tolist()
    assert link_poses(run, "base_link").tolist() == at(N, (0, 0, 0.5)).tolist()
    with pytest.raises(NotObservable, match="left_finger"):
        link_poses(run, "left_finger")
    assert frame_poses(run, "world").tolist() == at(N).tolist()
    assert frame_poses(run, "arm_link").tolist() == elbow.tolist()
    assert frame_poses(run, "box").tolist() == at(N, (0, 0, 0.02)).tolist()


def test_an_object_without_a_track_stands_at_its_pose_while_it_is_there():
    pose = (0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0)
    shelf = replace(thing("shelf", static=True, physics=False, pose=pose), present=((0.1, 0.2),))
    run = make_run(N, objects=(shelf,))
    poses = object_poses(run, "shelf")
    assert where(np.isfinite(poses).all(axis=1)) == list(range(10, 21))
    assert poses[15].tolist() == list(pose)
    with pytest.raises(NotObservable, match="the planner's belief"):
        physical_poses(run, "shelf")
    assert physical_poses(make_run(N), "box").tolist() == at(N, (0, 0, 0.02)).tolist()
    nowhere = replace(shelf, pose=())
    with pytest.raises(NotObservable, match="where 'shelf' stood"):
        object_poses(make_run(N, objects=(nowhere,)), "shelf")
    assert where(frame_present(run, "shelf")) == list(range(10, 21))
    assert frame_present(run, "palm").all()


def shown(spans, missing=()):
    """Samples at which a box with spans of presence is there; its pose is missing at some."""
    poses = heights(np.zeros(N))
    poses[list(missing)] = np.nan
    box = replace(BOX, present=spans)
    return where(present(make_run(N, objects=(box,), object_poses={"box": poses}), "box"))


def test_an_object_is_there_in_its_spans_even_where_its_pose_is_missing():
    assert shown(((0.1, 0.15), (0.3, 9.0))) == [10, 11, 12, 13, 14, 15, *range(30, 40)]
    assert shown(((0.1, 0.15),), missing=[12, 15]) == list(range(10, 16))
    assert shown(((0.1, 0.15),), missing=[10, 11]) == list(range(11, 16)), "added just before"
    assert shown(((0.0, 0.05),), missing=[0]) == list(range(6)), "it was never added"
    assert shown(((0.1, 0.15), (0.15, 0.2)), missing=[15]) == list(range(10, 21)), "it stayed"
    assert shown(((0.1, 0.15), (0.16, 0.2)), missing=[16]) == list(range(10, 21))
    assert shown(((0.1 + 5e-10, 0.15 - 5e-10),)) == list(range(10, 16)), "times nearer than 1 ns"
    assert shown(((5.0, 6.0),)) == []


def starts(poses, *steps, spans=((0.0, 1e9),)):
    box = replace(BOX, present=spans)
    run = make_run(N, objects=(TABLE, box), object_poses={"box": poses}, steps=steps)
    return start_poses(run, "box")[:, 0]


def test_a_start_is_where_an_object_appears_or_is_put():
    poses = at(N)
    poses[:, 0] = np.arange(N)
    assert starts(poses).tolist() == [0.0] * N, "what moves by itself has no new start"
    come = starts(poses, spans=((0.1, 0.2), (0.3, 0.4)))
    assert np.isnan(come[:10]).all()
    assert come[10:].tolist() == [10.0] * 20 + [30.0] * 10
    put = at(N)
    put[20:, 0] = JUMP + 1e-6
    for first, last, moves in ((20, 25, True), (10, 20, True), (10, 19, False), (21, 25, False)):
        moved = starts(put, step("put", first, last, "move_object"))
        assert (moved[-1] > 0) == moves
        assert moved[:20].tolist() == [0.0] * 20
    for other in (step("go", 15, 25, "move_to"),
                  step("put", 15, 25, "move_object", status="not reached")):  # fmt: skip
        assert not starts(put, other).any()


def test_what_a_step_moves_has_a_new_start_however_little_and_others_only_by_a_jump():
    for name, distance, is_new in (("box", 1e-4, True), ("cup", 1e-4, False), ("cup", 0.0051, True),
                                   ("cup", 0.0049, False)):  # fmt: skip
        poses = at(N)
        poses[20:, 1] = distance
        change = step("put", 15, 25, "move_object", result={"moved": [name]})
        run = make_run(N, object_poses={"box": poses}, steps=(change,))
        assert (start_poses(run, "box")[-1, 1] > 0) == is_new


def _shift(before, after):
    return np.linalg.norm(after[:, :3] - before[:, :3], axis=1)


def test_speeds_are_those_since_the_sample_before():
    poses = at(N)
    poses[10:, :3] = (0.003, 0.0, 0.004)
    poses[20:, 3:] = SE3.from_xyz_rpy(rpy=(0, 0.02, 0)).quat_wxyz
    poses[25:, 3:] *= -1
    poses[:3] = np.nan
    poses[30:32] = np.nan
    run = make_run(N)
    linear, angular = rates(run, "box", poses, None, _shift), body_speeds(run, "box", poses)[1]
    unknown = [0, 1, 2, 30, 31]
    assert where(np.isnan(linear)) == where(np.isnan(angular)) == unknown
    expected = np.zeros(N)
    expected[10] = 0.005 / DT
    assert np.delete(linear, unknown) == pytest.approx(np.delete(expected, unknown))
    expected[[10, 20]] = 0.0, 0.02 / DT
    assert np.delete(angular, unknown) == pytest.approx(np.delete(expected, unknown), abs=1e-9)
    one = make_run(1)
    assert rates(one, "box", at(1), None, _shift).tolist() == [0.0]
    assert [values.tolist() for values in body_speeds(one, "box", at(1))] == [[0.0], [0.0]]
    half = at(N)
    half[20:, 3:] = (0.0, 1.0, 0.0, 0.0)
    assert body_speeds(run, "box", half)[1][20] == pytest.approx(np.pi / DT)


def test_what_is_calm_has_been_slow_for_fifty_milliseconds():
    speed = np.zeros(N)
    speed[10], speed[20], speed[30] = 0.5, 0.2, np.nan
    known = calm(make_run(N), speed)
    assert where(known == 0.5) == list(range(10, 16))
    assert where(known == 0.2) == list(range(20, 26))
    assert where(np.isnan(known)) == [30]


def test_something_is_observed_for_a_time_since_it_came():
    here = np.zeros(N, dtype=bool)
    here[5:20] = here[25:28] = True
    assert where(observed_for(make_run(N), here, 0.04)) == list(range(9, 20))
    assert where(observed_for(make_run(N), here, 0.0)) == where(here)
