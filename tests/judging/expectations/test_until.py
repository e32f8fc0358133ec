"""until: one predicate holds at every sample before the one at which another comes true."""

from dataclasses import replace

import numpy as np
import pytest

from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.upright import Upright
from harness.plugins.formulas.expectations.until import Until
from harness.plugins.objects.expectations.displaced import Displaced
from harness.plugins.objects.expectations.in_contact import InContact
from harness.plugins.objects.expectations.on import On
from harness.plugins.objects.expectations.static import Static
from tests.judging.evidence import AT_ONCE, Evidence, Free
from tests.judging.synthetic_run import (
    BOX,
    CYLINDER,
    TABLE,
    at,
    heights,
    lift_run,
    make_run,
    verdict,
)

ABSENT = np.full((200, 7), np.nan)


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


def test_one_thing_holds_until_another_comes():
    run = lift_run()  # gripped at 0.5 s, off the table at 1 s, at 50 mm from 1.25 s on
    still = Static(object="box", max_velocity=0.01)
    on_table = On(object="box", support="Table")
    touched = InContact(between=("gripper", "box"))
    answer = verdict(run, Until(predicate=still, until=touched))
    assert (answer.status, answer.unit) == ("passed", "m/s")
    came = verdict(run, Until(predicate=on_table, until=Lifted(object="box", above=0.05)))
    assert came.status == "failed", "it was off the table before it was at 50 mm"
    assert (came.unit, came.time) == ("N", pytest.approx(1.0))
    assert came.reason.startswith("`on` did not hold until then")
    never = verdict(run, Until(predicate=still, until=InContact(between=("box", "arm_link"))))
    assert (never.status, never.unit) == ("failed", "N")
    assert "`in_contact` never came" in never.reason
    late = Until(predicate=still, until=touched, within=0.4)
    assert verdict(run, late).status == "failed"
    assert verdict(run, Until(predicate=still, until=touched, within=0.5)).status == "passed"
    held = Until(predicate=still, until=touched, **{"for": 1.5})
    assert verdict(run, held).status == "failed"
    assert verdict(run, Until(predicate=still, until=touched), "gone").status == "not reached"
    assert verdict(absent_box(), Until(predicate=still, until=touched)).status == "not reached"
    long = verdict(run, Until(predicate=still, until=touched, **{"for": 3.0}))
    assert long.reason == "judged over 1.990 s, which leaves no room for 3.000 s"
    with pytest.raises(ValueError, match="no `for` and no `within`"):
        Until(predicate=Static(**{"for": 1.0}), until=touched)


def test_a_hold_is_named_where_the_second_decides_and_not_where_the_first_does():
    still = Static(object="box", max_velocity=0.01)
    touched = InContact(between=("gripper", "box"))
    for spec, said in (
        (
            Until(predicate=still, until=touched, **{"for": 1.5}),
            "`in_contact` never came for 1.5 s: ",
        ),
        (Until(predicate=still, until=touched), "`static` held before it: "),
        (
            Until(predicate=Upright(object="box"),
                  until=Lifted(object="box", above=0.05), **{"for": 0.3}),
            "`lifted` came for 0.3 s: ",
        ),
        (
            Until(predicate=On(object="box", support="Table"),
                  until=Lifted(object="box", above=0.05), **{"for": 0.3}),
            "`on` did not hold until then: ",
        ),
    ):  # fmt: skip
        assert verdict(lift_run(), spec).reason.startswith(said), verdict(lift_run(), spec).reason


EVIDENCE = Evidence(
    mutation_cases=(
        (
            Until(
                predicate=On(object="box", support="Table"), until=Lifted(object="box", above=0.05)
            ),
            lift_run(
                leave=140,
                object_poses={"box": heights([0.02] * 140 + [0.12] * 60)},
                tcp_pose=heights([0.05] * 140 + [0.15] * 60),
            ),
            "",
        ),
    ),
    free_shifts=(
        Free(
            "higher is lifted too; where, and how it is turned, is not spoken of",
            "until",
            "object_poses box",
            "+-x +-y +z +-roll +-pitch +-yaw",
            (AT_ONCE,),
        ),
        Free(
            "a hand that stands elsewhere all the time raises it as much",
            "until",
            "tcp_pose",
            "+-x +-y +-z +-roll +-pitch +-yaw",
            (AT_ONCE,),
        ),
        Free(
            "friction sideways carries nothing, and more of it upwards carries more",
            "until",
            "frictions",
            "+-x +-y +z",
        ),
        Free(
            "a firmer grip is a grip",
            "until",
            "contact_forces left_finger, contact_forces right_finger",
            "+",
        ),
        Free(
            "where a finger presses is free, only that they press against each other as far"
            " apart as the object is thick",
            "until",
            "presses left_finger",
            "+-x +-z -y +force_y",
        ),
        Free(
            "the same from the other side", "until", "presses right_finger", "+-x +-z +y -force_y"
        ),
        Free(
            "the support may be lower, elsewhere and turned: `lifted` ends the wait all the same",
            "until",
            "object_poses Table",
            "+-x +-y -z +-roll +-pitch +-yaw",
        ),
    ),
)


def test_samples_at_which_either_part_is_unknown_are_counted():
    """After the second came, one sample of each part is unknown, and one of both."""
    poses = {name: at(200, (0, 0, 0.02)) for name in ("box", "cylinder")}
    poses["box"][100:, 2] = 0.1
    poses["box"][[120, 140]] = poses["cylinder"][[130, 140]] = np.nan
    run = make_run(objects=(TABLE, BOX, CYLINDER), object_poses=poses)
    spec = Until(predicate=Upright(object="cylinder"), until=Displaced(object="box", at_least=0.05))
    answer = verdict(run, spec)
    assert answer.status == "passed"
    assert (answer.observed.samples, answer.observed.unknown) == (197, 3)
