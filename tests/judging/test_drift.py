"""When a gripper begins to release what is attached, and since when an object drifts in a hand."""

import numpy as np
import pytest

from harness.core.geometry import Sphere
from harness.core.spatial import SE3
from harness.judging.drift import drift_in_hand, released_at
from harness.judging.window import NotReached
from tests.judging.synthetic_run import (
    BOX,
    CYLINDER,
    TABLE,
    at,
    attachment,
    heights,
    lift_run,
    make_run,
    step,
    thing,
)


@pytest.mark.parametrize(
    ("steps", "released"),
    [
        (("move_to 40 60", "release 80 121"), 0.8),
        (("gripper 80 100", "detach_object 100 121"), 0.8),
        (("gripper 40 60", "move_to 60 80", "detach_object 100 121"), 1.0),
        (("gripper 40 50", "move_to 50 60", "gripper 80 100", "detach_object 100 121"), 0.8),
        (("gripper 35 60", "gripper 60 100", "detach_object 100 121"), 0.35),
        (("gripper 29 60", "detach_object 100 121"), 1.0),  # it began before the attachment
        (("gripper 30 60", "detach_object 100 121"), 0.3),
        (("detach_object 40 60", "release 120 140"), 1.2),  # the first one detached another object
        (("release 100 121", "release 120 140"), 1.0),
        (("parallel 90 140", "release 100 121 steps[90][0]"), 1.0),
        (("release 100 120", "move_to 100 140"), 1.2),
        (("detach_object 121 130",), 1.2),
        ((), 1.2),
    ],
)
def test_release_begins_with_the_step_that_opens_the_gripper(steps, released):
    """Steps as verb, samples and path; the object is attached from 0.3 to 1.2 s."""
    records = []
    for text in steps:
        verb, start, stop, *path = text.split()
        where = {"path": path[0]} if path else {}
        records.append(step(text, int(start), int(stop), verb, **where))
    run = make_run(steps=records)
    assert released_at(run, attachment("box", 30, 120)) == pytest.approx(released)


def held(run, *records, objects=(TABLE, BOX), **changes):
    """Drift and where it is known, of a run whose box is gripped over samples 50 to 199."""
    return drift_in_hand(lift_run(objects=objects, attachments=records, **changes), run)


def test_an_object_drifts_from_the_first_grip_of_its_attachment_to_its_end():
    moved = heights(np.linspace(0, 0.2, 200))
    _, drift, _, known = held("box", attachment("box", 60, 90), object_poses={"box": moved})
    tcp = lift_run().signals.tcp_pose
    error = moved[:, 2] - tcp[:, 2]
    assert np.flatnonzero(known).tolist() == list(range(60, 90))
    assert np.flatnonzero(np.isfinite(drift)).tolist() == list(range(60, 90))
    assert drift[60:90] == pytest.approx(np.abs(error[60:90] - error[60]))
    _, drift, _, known = held("box", attachment("box", 20, 90))
    assert np.flatnonzero(known)[0] == 50, "before the fingers hold it, nothing drifts"


def test_each_attachment_has_a_zero_of_its_own_and_one_without_a_grip_has_no_drift():
    never, short, late = (attachment("box", *span) for span in ((5, 30), (60, 80), (120, 140)))
    moved = heights(np.linspace(0, 0.2, 200))
    _, drift, _, known = held("box", never, short, late, object_poses={"box": moved})
    expected = [*range(60, 80), *range(120, 140)]
    assert np.flatnonzero(known).tolist() == expected
    assert drift[[60, 120]].tolist() == [0.0, 0.0]
    with pytest.raises(NotReached, match="the fingers never held box while"):
        held("box", never)
    with pytest.raises(NotReached, match="box was never attached"):
        held("box")


def test_what_the_fingers_held_only_while_they_opened_has_no_drift():
    steps = (step("open", 40, 60, "gripper"), step("leave", 59, 121, "detach_object"))
    with pytest.raises(NotReached, match="the fingers never held box"):
        held("box", attachment("box", 30, 120), steps=steps)


def test_the_physical_object_is_the_one_that_was_represented_last():
    stand_in = thing("stand_in", physics=False)
    first = attachment("stand_in", 60, 80, represents="cylinder")
    last = attachment("stand_in", 80, 100, represents="box")
    records = (TABLE, BOX, CYLINDER, stand_in)
    assert held("stand_in", first, last, objects=records)[0] == "box"


@pytest.mark.parametrize(
    ("geometry", "rpy", "turned"),
    [
        (None, (0.0, 0.0, 0.3), 0.3),
        (None, (0.2, 0.0, 0.0), 0.2),
        (Sphere(0.02), (0.0, 0.0, 0.3), 0.0),
        (Sphere(0.02), (0.0, 0.2, 0.3), 0.2),
    ],
)
def test_a_turn_counts_since_the_grip_but_not_about_the_axis_of_a_round_object(
    geometry, rpy, turned
):
    start = SE3.from_xyz_rpy(rpy=(0.4, -0.2, 0.1))
    poses = at(200, quat=start.quat_wxyz)
    poses[150:, 3:] = (start @ SE3.from_xyz_rpy(rpy=rpy)).quat_wxyz
    _, drift, turn, _ = held(
        "box",
        attachment("box", 60, 200),
        objects=(TABLE, thing("box", geometry)),
        object_poses={"box": poses},
        tcp_pose=at(200),
    )
    assert turn[60:150] == pytest.approx(0.0, abs=1e-7)
    assert turn[150:] == pytest.approx(turned, abs=1e-7)
    assert drift[60:] == pytest.approx(0.0)
