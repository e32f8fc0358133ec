"""displaced: the object is away from where it started."""

from dataclasses import replace

import numpy as np
import pytest

from harness.judging.expectations.never import Never
from harness.judging.expectations.upright import Upright
from harness.plugins.formulas.expectations.formula import Formula
from harness.plugins.objects.expectations.displaced import Displaced
from harness.plugins.objects.expectations.in_ import In
from harness.plugins.objects.expectations.static import Static
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import BOX, TABLE, at, heights, make_run, thing, verdict

ABSENT = np.full((200, 7), np.nan)


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


def test_displaced_is_measured_from_the_start():
    moved = at(200, (0, 0, 0.02))
    moved[100:, 1] = 0.02
    run = make_run(object_poses={"box": moved})
    assert verdict(run, Displaced(object="box", at_least=0.019)).margin == pytest.approx(0.001)
    assert verdict(run, Displaced(object="box", at_least=0.021)).status == "failed"
    assert verdict(run, Never(predicate=Displaced(object="box", at_least=0.02))).status == "failed"
    assert verdict(absent_box(), Displaced(object="box")).status == "not reached"


def test_what_only_the_planner_believes_is_no_observation():
    belief = thing("belief", physics=False, pose=(0, 0, 1, 1, 0, 0, 0))
    run = make_run(objects=(TABLE, BOX, belief))
    for spec in (
        Upright(object="belief"),
        Static(object="belief"),
        Displaced(object="belief"),
        In(object="belief", container="box"),
        Formula(formula="always z(belief) > 0.5"),
    ):
        answer = verdict(run, spec)
        assert answer.status == "not observable", answer
        assert "belief is not in the physics" in answer.reason


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Displaced(object="box", at_least=0.05),
            make_run(object_poses={"box": heights(np.linspace(0.02, 0.08, shared.N))}),
            make_run(object_poses={"box": heights(np.linspace(0.02, 0.069, shared.N))}),
            -0.001,
            "m",
            shared.NO_BOX,
        ),
    ),
    mutation_cases=(
        (
            Displaced(object="box", at_least=0.05),
            shared.late(object_poses={"box": shared.halves((0.3, 0, 0.02, 0), (0, 0, 0.02, 0))}),
            "late",
        ),
    ),
    picture=(
        ("pick", "{object: red_box, at_least: 5 cm, during: lift}"),
        ("pick", "{object: red_box, at_least: 5 cm}"),
    ),
    free_shifts=(
        Free(
            "further away, and aside, is displaced too",
            "displaced",
            "object_poses",
            "-x +-y +-z +-roll +-pitch +-yaw",
        ),
    ),
)
