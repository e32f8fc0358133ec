"""always, never, eventually, `for` and `within`: what a window of samples says."""

import numpy as np
import pytest

from harness.expectations.always import Always
from harness.expectations.eventually import Eventually
from harness.expectations.lifted import Lifted
from harness.expectations.never import Never
from harness.expectations.placed import Placed
from harness.expectations.static import Static
from harness.expectations.within_limits import WithinLimits
from tests.assertions.synthetic_run import at, force, lift_run, make_run, step, verdict

STANDING = {("Table", "box"): force(200, (0, 200))}


def positions(shoulder, finger=0.0):
    return np.tile([shoulder, finger], (200, 1))


def test_a_step_that_was_not_reached_or_has_no_samples_never_passes():
    run = make_run(
        steps=(
            step("empty", 50, 50),
            step("unreached", 200, 200, status="not_reached"),
            step("move", 20, 40),
        )
    )
    for name in ("empty", "unreached", "unknown"):
        for spec in (Static(), Never(predicate=Static()), Eventually(predicate=Static())):
            assert verdict(run, spec, name).status == "not reached"
    assert verdict(run, Static(during="move")).time == pytest.approx(0.39)
    assert verdict(run, Static(during="unreached"), "move").status == "not reached"


def test_a_hold_longer_than_the_window_fails_and_says_so():
    run = make_run(steps=(step("move", 20, 40),))
    answer = verdict(run, Eventually(predicate=Static(), **{"for": 0.5}), "move")
    assert answer.status == "failed"
    assert (answer.unit, answer.margin) == ("s", pytest.approx(0.19 - 0.5))
    assert verdict(run, Never(predicate=Static(), **{"for": 0.5}), "move").status == "not reached"


def test_what_never_held_shows_where_it_came_nearest():
    spec = Lifted(object="box", above=0.2, **{"for": 0.5})
    answer = verdict(lift_run(), spec)
    assert answer.status == "failed"
    assert answer.reason.startswith("lifted 100 mm of 200 mm")
    assert answer.reason.endswith("held for 0.0 s at most, 0.5 s required")


def test_a_deadline_counts_from_the_window_s_start():
    run = lift_run()
    assert verdict(run, Lifted(object="box", above=0.05, within=1.3)).status == "passed"
    assert verdict(run, Lifted(object="box", above=0.05, within=1.2)).status == "failed"
    assert verdict(run, Lifted(object="box", above=0.05, within=0.5), "lift").status == "passed"


def test_words_inside_and_outside_a_temporal_word_both_count():
    run = lift_run()  # at 50 mm from 1.25 s on: 0.74 s
    inner = Lifted(object="box", above=0.05, **{"for": 0.8})
    assert verdict(run, Eventually(predicate=inner, **{"for": 0.1})).status == "failed"
    assert verdict(run, Eventually(predicate=inner, during="lift", points=2)).points == 2
    twice = Eventually(predicate=Lifted(object="box", during="close"), during="lift")
    assert verdict(run, twice).status == "not observable"


def test_what_is_unknown_counts_against_every_word():
    commands = positions(0.0)
    velocities = np.zeros((200, 2))
    velocities[120] = np.nan
    run = make_run(joint_velocities=velocities, joint_commands=commands)
    assert verdict(run, Always(predicate=WithinLimits())).status == "failed"
    assert verdict(run, Never(predicate=WithinLimits(position=False))).status == "failed"
    gone = at(200, (0, 0, 0.02))
    gone[150:] = np.nan
    removed = make_run(object_poses={"box": gone}, contact_forces=STANDING)
    assert verdict(removed, Placed(object="box")).status == "failed"
    assert verdict(removed, Eventually(predicate=Placed(object="box"))).status == "passed"
