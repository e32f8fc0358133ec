"""lifted: the object is higher than at the start and nothing but the gripper holds it up."""

from dataclasses import replace

import numpy as np
import pytest

from harness.judging.expectations.lifted import Lifted
from harness.judging.hold import moves_in_hand
from harness.plugins.objects.expectations.displaced import Displaced
from tests.judging import evidence_runs as shared
from tests.judging.evidence import AT_ONCE, DRIFT, Evidence, Free, Three
from tests.judging.synthetic_run import (
    BOX,
    TABLE,
    changed,
    force,
    heights,
    lift_run,
    make_run,
    step,
    thing,
    verdict,
)

ABSENT = np.full((200, 7), np.nan)


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


def test_a_box_raised_by_the_fingers_is_lifted_with_its_margin():
    answer = verdict(lift_run(), Lifted(object="box", above=0.05))
    assert (answer.status, answer.unit) == ("passed", "m")
    assert answer.margin == pytest.approx(0.05)


def test_a_box_raised_a_millimetre_too_little_is_not_lifted():
    answer = verdict(lift_run(height=0.049), Lifted(object="box", above=0.05))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-0.001)
    assert answer.reason.startswith("lifted 49.0 mm of 50.0 mm")


@pytest.mark.parametrize(
    ("forces", "said"),
    [
        ({}, "nothing holds box"),
        (
            {("left_finger", "box"): force(200, (0, 200))},
            "but nothing holds box: left finger 1.0 N, right finger 0 N",
        ),
        (
            {
                ("left_finger", "box"): force(200, (0, 200)),
                ("right_finger", "box"): force(200, (0, 200)),
                ("Table", "box"): force(200, (0, 200)),
            },
            "box touches Table",
        ),
        (
            {
                ("left_finger", "box"): force(200, (0, 200)),
                ("right_finger", "box"): force(200, (0, 200)),
                ("arm_link", "box"): force(200, (0, 200)),
            },
            "box touches arm_link",
        ),
    ],
    ids=["thrown", "one finger", "carried by something", "carried by the arm"],
)
def test_height_without_the_fingers_alone_is_not_lifting(forces, said):
    run = lift_run(contact_forces=forces)
    answer = verdict(run, Lifted(object="box", above=0.05))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-0.05)
    assert answer.measures[0].value == pytest.approx(0.1), "the highest sample is the one shown"
    assert said in answer.reason


def test_an_object_put_on_a_shelf_by_a_step_starts_there():
    z = np.full(200, 0.02)
    z[50:] = 0.52
    run = lift_run(
        object_poses={"box": heights(z)}, tcp_pose=heights(z + 0.03), grip=(40, 200), leave=50
    )
    teleported = make_run(
        object_poses={"box": heights(z)},
        contact_forces=run.signals.contact_forces,
        steps=(step("up", 49, 51, "move_object"),),
    )
    assert verdict(teleported, Lifted(object="box", above=0.05)).status == "failed"
    assert verdict(run, Lifted(object="box", above=0.05)).status == "passed", "no step moved it"


def test_steps_that_put_it_up_bit_by_bit_lift_nothing():
    z = 0.02 + 0.004 * np.clip((np.arange(200) - 100) // 10, 0, 9)
    steps = [
        step(f"up{k}", k, k, "move_object", result={"moved": ["box"]}) for k in range(110, 200, 10)
    ]
    run = lift_run(object_poses={"box": heights(z)}, tcp_pose=heights(z), leave=0, steps=steps)
    assert verdict(run, Lifted(object="box", above=0.01)).status == "failed"
    assert verdict(run, Displaced(object="box", at_least=0.01)).status == "failed"
    unmoved = replace(run, steps=())
    assert verdict(unmoved, Lifted(object="box", above=0.01)).status == "passed"


def test_what_rests_on_a_lifted_object_and_the_palm_hold_nothing_up():
    run = lift_run()
    top = thing("top", mass=0.01)
    z = run.signals.object_poses["box"][:, 2] + 0.04
    loads = {**run.signals.contact_forces, ("box", "top"): force(200, (0, 200), value=0.1)}
    poses = {**run.signals.object_poses, "top": heights(z)}
    loaded = changed(
        replace(run, objects=(TABLE, BOX, top)), contact_forces=loads, object_poses=poses
    )
    spec = Lifted(object="box", above=0.05)
    assert verdict(loaded, spec).status == "passed"
    hung = {**loads, ("shelf", "top"): force(200, (0, 200), value=0.1)}
    assert verdict(changed(loaded, contact_forces=hung), spec).status == "failed"
    assert verdict(loaded, Lifted(object="top", above=0.05)).status == "failed"
    palm = {**run.signals.contact_forces, ("palm", "box"): force(200, (90, 200))}
    assert verdict(changed(run, contact_forces=palm), spec).status == "passed"


def test_an_absent_object_was_never_up_for_lifting():
    assert verdict(absent_box(), Lifted(object="box")).status == "not reached"


def test_contact_that_flickers_for_less_than_the_debounce_is_one_contact():
    run = lift_run(n=1000, leave=500, grip=(250, 1000))
    fine = np.arange(1000) * 0.002
    flicker = force(1000, (250, 1000))
    flicker[::4] = 0.0  # every eighth millisecond nothing
    longer = force(1000, (250, 1000))
    longer[800:808] = 0.0
    table = run.signals.contact_forces["Table", "box"]
    for left, status in ((flicker, "passed"), (longer, "failed")):
        forces = {("left_finger", "box"): left, ("right_finger", "box"): left}
        flickering = changed(run, times=fine, contact_forces={**forces, ("Table", "box"): table})
        spec = Lifted(object="box", above=0.05, **{"for": 0.9})
        assert verdict(flickering, spec).status == status


def test_a_hand_that_carries_less_than_half_of_the_weight_lifts_nothing():
    pairs = [("left_finger", "box"), ("right_finger", "box")]
    for newton, status in ((0.25, "passed"), (0.24, "failed")):
        frictions = {pair: np.tile([0, 0, newton], (200, 1)) for pair in pairs}
        answer = verdict(lift_run(frictions=frictions), Lifted(object="box", above=0.05))
        assert answer.status == status
    assert "the hand carries 0.48 N of 0.98 N" in answer.reason
    older = verdict(lift_run(frictions={}), Lifted(object="box", above=0.05))
    assert older.status == "passed", "friction was not recorded"


def test_height_that_the_hand_did_not_give_does_not_count():
    caught = lift_run(grip=(150, 200), leave=50)
    answer = verdict(caught, Lifted(object="box", above=0.05))
    assert (answer.status, answer.margin) == ("failed", pytest.approx(-0.05))
    later = lift_run(grip=(90, 200), leave=50)
    answer = verdict(later, Lifted(object="box", above=0.05))
    assert (answer.status, answer.margin) == ("failed", pytest.approx(-0.03)), "from sample 90 on"
    assert "the hand raised it by 20.0 mm" in answer.reason, answer


@pytest.mark.parametrize(("limit", "which"), [("STEADY", 0), ("STEADY_TURN", 1)])
def test_a_motion_in_the_hand_may_be_as_large_as_its_limit(limit, which, monkeypatch):
    """The box moves and turns evenly in the hand; the limit is set to what one sample has."""
    base = lift_run()
    poses = base.signals.object_poses["box"].copy()
    share = np.arange(200) ** 2 / 200**2
    poses[:, 0] = 0.02 * share
    poses[:, 3], poses[:, 6] = np.cos(0.2 * share), np.sin(0.2 * share)
    run = changed(base, object_poses={"box": poses})
    up = poses[:, 2] >= 0.07
    least = moves_in_hand(run, "box")[which][up].min()
    for value, expected in ((least, "passed"), (np.nextafter(least, 0), "failed")):
        monkeypatch.setattr(f"harness.judging.expectations.lifted.{limit}", value)
        assert verdict(run, Lifted(object="box", above=0.05)).status == expected


def test_an_object_that_moves_through_the_hand_is_not_lifted():
    run = lift_run()
    sliding = run.signals.object_poses["box"].copy()
    sliding[100:, 0] = 0.06 * np.arange(100) * 0.01  # 60 mm/s
    spec = Lifted(object="box", above=0.05, during="lift")
    assert verdict(changed(run, object_poses={"box": sliding}), spec).status == "failed"
    sliding[100:, 0] /= 1.5  # 40 mm/s
    assert verdict(changed(run, object_poses={"box": sliding}), spec).status == "passed"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Lifted(object="box", above=0.05),
            lift_run(),
            lift_run(height=0.049),
            -0.001,
            "m",
            shared.NO_BOX,
        ),
    ),
    mutation_cases=((Lifted(object="box", above=0.05), lift_run(), "lift"),),
    picture=(
        ("pick", "{object: red_box, above: 5 cm, for: 0.5 s}"),
        ("slippery", "{object: red_box, above: 5 cm, for: 1 s}"),
    ),
    free_shifts=(
        Free(
            "higher is lifted too; where, and how it is turned, is not spoken of",
            "lifted",
            "object_poses box",
            "+-x +-y +z +-roll +-pitch +-yaw",
            (AT_ONCE,),
        ),
        Free(
            "a hand that stands elsewhere, or higher, raises it as much",
            "lifted",
            "tcp_pose",
            "+-x +-y +z +-roll +-pitch +-yaw",
            (AT_ONCE,),
        ),
        Free(
            "friction sideways carries nothing, and more of it upwards carries more",
            "lifted",
            "frictions",
            "+-x +-y +z",
        ),
        Free("less of a support's force is no support", "lifted", "contact_forces Table", "-"),
        Free(
            "a firmer grip is a grip",
            "lifted",
            "contact_forces left_finger, contact_forces right_finger",
            "+",
        ),
        Free(
            "where a finger presses is free, only that they press against each other as far"
            " apart as the object is thick",
            "lifted",
            "presses left_finger",
            "+-x +-z -y +force_y",
        ),
        Free(
            "the same from the other side", "lifted", "presses right_finger", "+-x +-z +y -force_y"
        ),
        Free(
            "past the other finger: a ring that is held from inside",
            "lifted",
            "presses left_finger",
            "+y",
            (DRIFT,),
        ),
        Free("the same from the other side", "lifted", "presses right_finger", "-y", (DRIFT,)),
    ),
)
