"""inserted: a peg is in a hole, as deep as required."""

from dataclasses import replace

import pytest

from harness.core.geometry import Box, Cylinder
from harness.core.world import Hole
from harness.plugins.contact.expectations.inserted import Inserted
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import at, make_run, thing, verdict

PEG = thing("peg", Cylinder(0.01, 0.05))
OPENING = (0.03, 0, 0.025, 1, 0, 0, 0)
BLOCK = replace(
    thing("block", Box((0.1, 0.1, 0.05)), static=True),
    holes=(Hole(OPENING, (0.0202, 0.0202), 0.04, is_round=True),),
)


def place(depth, x=0.0):
    """Where the peg's middle is, its end at a depth below the opening [m]."""
    return (0.03 + x, 0, 0.075 - depth)


def peg_at(*xyz):
    """A run in which the peg stands somewhere."""
    poses = {"peg": at(shared.N, xyz), "block": at(shared.N, (0, 0, 0.025))}
    return make_run(objects=(PEG, BLOCK), object_poses=poses)


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Inserted(peg="peg", hole="block", depth=0.02),
            peg_at(*place(0.03)),
            peg_at(*place(0.0199)),
            -1e-4,
            "m",
        ),
        Three(
            Inserted(peg="peg", hole="block", depth=0.02, tolerance=0.002),
            peg_at(*place(0.035, 0.001)),
            peg_at(*place(0.03, 0.0021)),
            -1e-4,
            "m",
        ),
    ),
    mutation_cases=(
        (
            Inserted(peg="peg", hole="block", depth=0.02),
            shared.late(
                objects=(PEG, BLOCK),
                object_poses={
                    "peg": shared.halves((0.1, 0, 0.1, 0), (*place(0.03), 0)),
                    "block": at(shared.N, (0, 0, 0.025)),
                },
            ),
            "late",
        ),
    ),
    free_shifts=(Free("a peg and its hole are round", "inserted", "object_poses peg", "+-yaw"),),
)


@pytest.mark.parametrize("x", [0.0011, 0.03, -0.2])
def test_a_peg_next_to_its_hole_is_not_inserted_however_low_it_is(x):
    answer = verdict(peg_at(*place(0.03, x)), Inserted(peg="peg", hole="block", depth=0.02))
    assert answer.status == "failed"
    assert "from the axis of the hole" in answer.reason


def test_of_a_peg_that_leaves_its_hole_below_what_is_still_in_it_counts():
    inserted = Inserted(peg="peg", hole="block", depth=0.02)
    answers = [verdict(peg_at(*place(depth)), inserted) for depth in (0.069, 0.085, 0.091)]
    assert [answer.status for answer in answers] == ["passed", "failed", "failed"]
    values = [answer.measures[0].value for answer in answers]
    assert values == pytest.approx([0.021, 0.005, -0.001])
