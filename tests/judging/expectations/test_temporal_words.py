"""always, never, eventually, `for` and `within`: what a window of samples says."""

from dataclasses import replace

import numpy as np
import pytest

from harness.judging.expectations.always import Always
from harness.judging.expectations.collision import Collision
from harness.judging.expectations.eventually import Eventually
from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.never import Never
from harness.judging.expectations.placed import Placed
from harness.judging.expectations.released import Released
from harness.judging.expectations.upright import Upright
from harness.judging.expectations.within_limits import WithinLimits
from harness.language.poses import Pose
from harness.plugins.formulas.expectations.formula import Formula
from harness.plugins.formulas.expectations.until import Until
from harness.plugins.objects.expectations.displaced import Displaced
from harness.plugins.objects.expectations.in_contact import InContact
from harness.plugins.objects.expectations.static import Static
from tests.judging.synthetic_run import (
    BOX,
    TABLE,
    at,
    changed,
    force,
    lift_run,
    make_run,
    step,
    thing,
    verdict,
)

STANDING = {("Table", "box"): force(200, (0, 200))}


def positions(shoulder, finger=0.0):
    return np.tile([shoulder, finger], (200, 1))


def test_a_step_that_was_not_reached_or_has_no_samples_never_passes():
    run = make_run(
        steps=(
            step("empty", 50, 50),
            step("unreached", 200, 200, status="not reached"),
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
    assert answer.reason.endswith("true for 0 s at a time at most, and `for` requires 0.5 s")


def test_a_deadline_counts_from_the_window_s_start():
    run = lift_run()
    assert verdict(run, Lifted(object="box", above=0.05, within=1.3)).status == "passed"
    assert verdict(run, Lifted(object="box", above=0.05, within=1.2)).status == "failed"
    assert verdict(run, Lifted(object="box", above=0.05, within=0.5), "lift").status == "passed"


@pytest.mark.parametrize(
    ("touching", "words", "status"),
    [
        (slice(140, 200), {"for": 1.0}, "not reached"),  # 0.6 s so far
        (slice(130, 190), {"for": 1.0}, "passed"),
        (slice(199, 200), {"for": 0.1}, "not reached"),
        (slice(90, 200), {"for": 1.0}, "failed"),
        (slice(0, 0), {"within": 2.5}, "not reached"),
        (slice(0, 0), {"within": 1.99}, "passed"),
        (slice(150, 200), {"within": 1.0}, "passed"),
        (slice(95, 200), {"within": 1.0, "for": 1.2}, "not reached"),
        (slice(105, 200), {"within": 1.0, "for": 1.2}, "passed"),
        (slice(100, 200), {}, "failed"),
    ],
)
def test_never_is_decided_only_where_its_time_has_passed(touching, words, status):
    """Its formula says the same of each of these runs."""
    forces = np.zeros(200)
    forces[touching] = 3.0
    run = make_run(contact_forces={("arm_link", "box"): forces})
    spec = Never(predicate=InContact(between=("robot", "box")), **words)
    assert verdict(run, spec).status == status
    within = f"[0, {words['within']}]" if "within" in words else ""
    hold = f"always[0, {words['for']}] " if "for" in words else ""
    formula = f"not eventually{within} {hold}force(robot, box) > 0.1"
    assert verdict(run, Formula(formula=formula)).status == status


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
    answer = verdict(run, Always(predicate=WithinLimits()))
    assert answer.status == "not observable"
    assert "1 samples from t=1.200 s" in answer.reason
    assert verdict(run, Never(predicate=WithinLimits(position=False))).status == "failed"
    gone = at(200, (0, 0, 0.02))
    gone[150:] = np.nan
    unknown = make_run(object_poses={"box": gone}, contact_forces=STANDING)
    assert verdict(unknown, Placed(object="box")).status == "not observable"
    removed = replace(unknown, objects=(TABLE, replace(BOX, present=((0.0, 1.49),))))
    assert verdict(removed, Placed(object="box")).status == "not reached"
    assert verdict(removed, Eventually(predicate=Placed(object="box"))).status == "passed"


def test_what_is_unknown_decides_nothing_that_the_known_samples_decide():
    """A violation stands, whatever the unknown samples were; what came true has come true."""
    poses = at(200, (0, 0, 0.02))
    poses[50, 0] = np.nan
    poses[120:, 0] += 0.05
    run = make_run(object_poses={"box": poses})
    spec = Displaced(object="box", at_least=0.02)
    assert verdict(run, Never(predicate=spec)).status == "failed"
    assert verdict(run, Eventually(predicate=spec)).status == "passed"
    far = Displaced(object="box", at_least=0.2)
    assert verdict(run, Eventually(predicate=far)).status == "not observable"
    assert verdict(run, Never(predicate=far)).status == "not observable"


def test_the_unknown_samples_that_would_decide_are_counted_from_the_first_to_the_last():
    poses = at(200, (0, 0, 0.02))
    poses[[50, 70, 120]] = np.nan
    run = make_run(object_poses={"box": poses}, steps=(step("late", 40, 200),))
    for during in ("", "late"):
        answer = verdict(run, Always(predicate=Upright(object="box")), during)
        assert answer.status == "not observable"
        assert answer.reason == (
            "3 samples from t=0.500 s to t=1.200 s are not known, and would decide it"
        )


ALREADY = "already true at the start"


def warned(run, spec, during=""):
    answer = verdict(run, spec, during)
    assert answer.status == "passed", answer
    return [warning.name for warning in answer.warnings]


def test_what_comes_true_before_its_window_begins_is_reported():
    run = lift_run()  # at 50 mm from 1.25 s on
    up = Lifted(object="box", above=0.05)
    late = replace(run, steps=(*run.steps, step("hold", 150, 200)))
    assert warned(run, up) == warned(run, up, "lift") == []
    assert warned(late, up, "hold") == [ALREADY]
    assert warned(late, Eventually(predicate=up), "hold") == [ALREADY]
    assert warned(late, Always(predicate=up), "hold") == []
    held = Lifted(object="box", above=0.05, **{"for": 0.3})
    assert warned(late, held, "hold") == [ALREADY]
    assert warned(late, Displaced(object="box"), "hold") == [ALREADY]
    assert warned(run, Displaced(object="box")) == []


def test_what_stands_where_it_stood_was_not_placed():
    run = make_run(contact_forces=STANDING)
    assert warned(run, Placed(object="box")) == [ALREADY]
    assert warned(run, Released(object="box")) == [ALREADY]
    touch = {**STANDING, ("left_finger", "box"): force(200, (50, 60))}
    touched = make_run(contact_forces=touch)
    assert warned(touched, Placed(object="box")) == []
    assert warned(touched, Released(object="box")) == []
    poses = at(200, (0, 0, 0.02))
    poses[50:, 0] += 0.1
    pushed = make_run(contact_forces=STANDING, object_poses={"box": poses})
    assert warned(pushed, Placed(object="box")) == []


def test_what_rides_on_a_moving_support_was_not_placed():
    """A cart moves by 10 cm with the box on it; what slides on the cart is placed there."""
    aside = np.linspace(0, 0.1, 100)
    for slip, expected in ((0.004, [ALREADY]), (0.006, [])):
        box, cart = at(200, (0, 0, 0.02)), at(200, (0, 0, -0.015))
        cart[:100, 0], cart[100:, 0] = aside, 0.1
        box[:, 0] = cart[:, 0] + slip * np.minimum(np.arange(200) / 50, 1)
        run = make_run(contact_forces=STANDING, object_poses={"box": box, "Table": cart})
        assert warned(run, Placed(object="box")) == expected
        on_table = Pose(frame="Table", xyz=(0.0, 0.0, 0.035))
        assert warned(run, Placed(object="box", pose=on_table)) == expected
    elsewhere = {("Table", "box"): force(200, (0, 150)), ("shelf", "box"): force(200, (150, 200))}
    still = at(200, (0, 0, 0.02))
    still[:, 0] = cart[:, 0]
    shelf = thing("shelf", static=True, pose=(0.1, 0, -0.1, 1, 0, 0, 0))
    poses = {"box": still, "Table": cart}
    run = make_run(contact_forces=elsewhere, object_poses=poses, objects=(TABLE, BOX, shelf))
    assert warned(run, Placed(object="box")) == [], "the cart carries it no longer"


def test_an_until_that_comes_at_once_judges_nothing_before_it():
    run = lift_run()
    at_once = Until(predicate=Upright(object="box"), until=Released(object="box"))
    later = Until(predicate=Upright(object="box"), until=Lifted(object="box"))
    assert warned(run, at_once) == [ALREADY]
    touched = make_run(contact_forces={("left_finger", "box"): force(200, (20, 60))})
    for hold, expected in ((0.1, [ALREADY]), (0.5, [])):
        free = Until(predicate=Upright(object="box"), until=Released(object="box"), **{"for": hold})
        assert warned(touched, free) == expected, "it was free for 0.2 s at first"
    late = replace(run, steps=(*run.steps, step("late", 10, 200)))
    [warning] = verdict(late, at_once, "late").warnings
    assert "`released` held at t=0.100 s, the first sample" in warning.message
    assert warned(run, later) == []


@pytest.mark.parametrize(
    ("formula", "names", "premises"),
    [
        ("always (z(box) > 1 implies tilt(box) < 0.1)", ["premise never held"], 0),
        ("always (z(box) > 0.05 implies tilt(box) < 0.1)", [], 84),
        ("always (z(box) > 0.05 implies (z(box) > 1 implies z(box) < 2))",
         ["premise never held"], 0),
        ("always (not z(box) > 1 or tilt(box) < 0.1)", ["premise never held"], 0),
        ("always (tilt(box) < 0.1 or not z(box) > 1)", ["premise never held"], 0),
        ("always (not z(box) > 0.05 or tilt(box) < 0.1)", [], 84),
        ("always (not z(box) > 1 or not z(box) > 2)", [], None),
        ("eventually z(box) > 0.01", [ALREADY], None),
        ("eventually z(box) > 0.05", [], None),
        ("(z(box) < 1) until z(box) > 0.01", [ALREADY], None),
        ("(z(box) < 1) until z(box) > 0.05", [], None),
        ("always z(box) > 0.01", [], None),
    ],
)  # fmt: skip
def test_a_formula_says_how_often_its_premise_held(formula, names, premises):
    answer = verdict(lift_run(), Formula(formula=formula))
    assert answer.status == "passed"
    assert [warning.name for warning in answer.warnings] == names
    assert answer.observed.premises == premises
    assert answer.observed.samples == 200


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("puts", "the step takes no time: it has one sample only"),
        ("", "the run takes no time: it has one sample only"),
        ("edge", "what it is about was there at 1 of 101 samples"),
    ],
)
def test_a_window_of_one_sample_is_a_step_that_takes_no_time(name, said):
    late = replace(thing("late"), present=((1.0, 1e9),))
    run = make_run(
        1 if not name else 200, objects=(TABLE, BOX, late),
        object_poses={"late": at(1 if not name else 200, (1, 1, 1))},
        steps=(step("puts", 5, 6), step("edge", 0, 101))[: 2 if name else 0],
    )  # fmt: skip
    other = "late" if name == "edge" else "box"
    [warning] = verdict(run, Never(predicate=InContact(between=(other, "robot"))), name).warnings
    assert warning.message == said


def test_contact_with_what_is_not_in_the_physics_is_not_observable():
    ghost = thing("ghost", physics=False)
    late = replace(thing("late"), present=((1.0, 1e9),))
    run = make_run(
        objects=(TABLE, BOX, ghost, late), object_poses={"late": at(200, (1, 1, 1))},
        steps=(step("early", 0, 50), step("edge", 0, 101)),
    )  # fmt: skip
    for spec in (InContact, Collision):
        assert verdict(run, Never(predicate=spec(between=("ghost", "robot")))).status == (
            "not observable"
        )
        never = Never(predicate=spec(between=("late", "robot")))
        assert verdict(run, never, "early").status == "not reached"
        assert warned(run, never, "edge") == ["hardly observed"]
        assert warned(run, never) == []
        assert verdict(run, never).observed.samples == 100
        assert verdict(run, never).observed.pairs == 6
    assert verdict(run, Formula(formula="always force(ghost, robot) < 1")).status == (
        "not observable"
    )


@pytest.mark.parametrize(("speed", "names"), [(9.0, ["contact may be missed"]), (7.0, [])])
def test_a_body_that_moves_by_more_than_both_widths_may_have_passed_through(speed, names):
    """The box and the post are 4 cm thick: at 100 samples a second that is 8 m/s."""
    poses = at(200, (0, 0, 0.02))
    poses[60:, 0] = 0.01 * speed
    post = thing("post", static=True, pose=(1, 0, 0, 1, 0, 0, 0))
    run = make_run(object_poses={"box": poses}, objects=(TABLE, BOX, post))
    pair = InContact(between=("box", "post"))
    assert warned(run, Never(predicate=pair)) == names
    hand = Never(predicate=Collision(between=("palm", "box")))
    assert warned(run, hand) == ["contact may be missed"], "a link has no least width"
    touch = changed(run, contact_forces={("box", "post"): force(200, (60, 90))})
    assert warned(touch, pair) == [], "they touched: nothing was missed"
