"""static: the object, or everything, moves slower than a limit."""

from dataclasses import replace

import numpy as np
import pytest

from harness.judging.expectations.always import Always
from harness.judging.expectations.eventually import Eventually
from harness.judging.expectations.placed import Placed
from harness.plugins.objects.expectations.static import Static
from tests.judging import evidence_runs as shared
from tests.judging.evidence import AT_ONCE, Evidence, Free, Three
from tests.judging.synthetic_run import BOX, DT, TABLE, at, changed, make_run, step, verdict

ABSENT = np.full((200, 7), np.nan)


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


def test_everything_stands_still_until_one_thing_moves():
    run = make_run()
    assert verdict(run, Always(predicate=Static())).status == "passed"
    creeping = at(200, (0, 0, 0.02))
    creeping[:, 0] = np.arange(200) * DT * 0.0051
    answer = verdict(changed(run, object_poses={"box": creeping}), Static(max_velocity=0.005))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-1e-4)
    assert answer.reason.startswith("box moves")
    turning = np.zeros((200, 2))
    turning[:, 0] = 0.06
    assert "shoulder" in verdict(changed(run, joint_velocities=turning), Static()).reason
    assert verdict(absent_box(), Static(object="box")).status == "not reached"


def thrown(apex):
    """A box at its turning point at a time [s]: under 5 mm/s for one sample alone."""
    seconds = np.arange(200) * DT - apex
    return make_run(
        object_poses={"box": at(200, np.outer(1.0 - 4.9 * seconds**2, (0, 0, 1)))},
        steps=(step("top", 99, 103), step("first", 0, 3)),
    )


def test_a_window_that_begins_at_the_top_of_a_throw_does_not_cut_the_motion_before_it_off():
    run = thrown(1.005)
    assert verdict(run, Static(object="box", max_velocity=0.06), "top").status == "failed"
    assert verdict(run, Placed(object="box", max_velocity=0.06), "top").status == "failed"
    still = replace(make_run(), steps=run.steps)
    assert verdict(still, Static(object="box"), "top").status == "passed"


def test_what_was_seen_for_less_than_50_ms_is_not_known_to_stand_still():
    run = thrown(0.005)  # let go in the air
    assert verdict(run, Static(object="box", max_velocity=0.2), "first").status == "not reached"
    assert verdict(run, Placed(object="box", max_velocity=0.2), "first").status == "not reached"
    assert verdict(run, Eventually(predicate=Static(object="box"))).status == "failed"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Static(object="box"),
            make_run(),
            make_run(object_poses={"box": shared.creeping(0.0051)}),
            -1e-4,
            "m/s",
            shared.NO_BOX,
        ),
    ),
    mutation_cases=(
        (Static(object="box"), shared.late(object_poses={"box": shared.SWING}), "late"),
        (
            Static(),
            shared.late(
                object_poses={"box": shared.SWING}, joint_velocities=shared.columns((1, 0), (1, 0))
            ),
            "late",
        ),
    ),
    picture=(
        ("pick", "red_box"),
        ("pick", "always: {static: {object: red_box, during: lift}}"),
    ),
    free_shifts=(
        Free(
            "what stood elsewhere all the time has not moved",
            "static, static 2",
            "object_poses",
            "+-x +-y +-z +-roll +-pitch +-yaw",
            (AT_ONCE,),
        ),
    ),
)
