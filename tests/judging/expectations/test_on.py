"""on: the object stands on another."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.geometry import Box
from harness.judging.expectations.placed import Placed
from harness.plugins.objects.expectations.on import On
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import BOX, CYLINDER, TABLE, at, force, make_run, thing, verdict

ABSENT = np.full((200, 7), np.nan)


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


def test_leaning_on_a_wall_is_no_support_from_below():
    wall = thing("wall", Box((0.02, 1.0, 1.0)), static=True, pose=(0.03, 0, 0.5, 1, 0, 0, 0))
    run = make_run(objects=(wall, BOX), contact_forces={("box", "wall"): force(200, (0, 200))})
    assert verdict(run, Placed(object="box")).status == "failed"
    assert verdict(run, On(object="box", support="wall")).status == "failed"


def test_a_box_that_is_pressed_against_something_does_not_stand_on_it():
    contact = {("Table", "box"): force(200, (0, 200), value=30.0)}
    carried = {("Table", "box"): force(200, (0, 200), value=0.4)}
    run = make_run(contact_forces=contact, support_forces=carried)
    answer = verdict(run, On(object="box", support="Table"))
    assert (answer.status, answer.margin) == ("failed", pytest.approx(0.4 - 0.99 * 0.49))
    turned = make_run(
        objects=(TABLE, BOX, CYLINDER),
        contact_forces={("box", "cylinder"): contact["Table", "box"]},
        support_forces={("box", "cylinder"): -carried["Table", "box"] - 1},
        object_poses={"cylinder": at(200, (0, 0, -0.05))},
    )
    assert verdict(turned, On(object="box", support="cylinder")).status == "passed"
    assert verdict(turned, On(object="cylinder", support="box")).status == "failed"


def test_standing_on_something_means_that_it_carries_half_the_weight():
    weight = 0.1 * 9.8
    for value, status in ((weight, "passed"), (0.49 * weight, "failed"), (0.0, "failed")):
        run = make_run(contact_forces={("Table", "box"): force(200, (0, 200), value=value)})
        answer = verdict(run, On(object="box", support="Table"))
        assert answer.status == status
        assert answer.margin == pytest.approx(value - 0.495 * weight)
    assert verdict(absent_box(), On(object="box", support="Table")).status == "not reached"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            On(object="box", support="Table"),
            shared.on_table(0.98),
            shared.on_table(0.48),
            0.48 - 0.4851,
            "N",
            shared.NO_BOX,
        ),
    ),
    mutation_cases=((On(object="box", support="Table"), shared.standing(), "late"),),
    picture=(
        ("pick", "{object: red_box, support: ground_plane}"),
        ("pick", "{object: red_box, support: ground_plane, during: lift}"),
    ),
    free_shifts=(
        Free("to stand more heavily is to stand", "on", "contact_forces Table", "+"),
        Free("to stand more heavily is to stand", "on", "support_forces", "+"),
    ),
)
