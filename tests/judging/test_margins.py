"""Margins of the parts of a predicate, and how several become one."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harness.judging.margins import MarginSignal, Part, all_of, measured
from harness.language.expectation import Quantity

LENGTH, COUNT = Quantity("distance", "m", "far"), Quantity("closed", "1", "shut")
VALUES = np.array([0.0, 1.0, 3.0])
WINDOW = SimpleNamespace(time=lambda index: 10.0 + index)


@pytest.mark.parametrize(
    ("comparison", "limit", "margins", "shares"),
    [
        ("<=", 2.0, [2, 1, -1], [1, 0.5, -0.5]),
        (">=", 2.0, [-2, -1, 1], [-1, -0.5, 0.5]),
        ("<=", -2.0, [-2, -3, -5], [-1, -1.5, -2.5]),
        ("<=", 0.0, [0, -1, -3], [0, -1, -3]),  # a limit of zero is no scale
        ("==", 3.0, [-1, -1, 1], [-1, -1, 1]),
        ("==", 0.5, [-1, -1, -1], [-1, -1, -1]),
    ],
)
def test_a_margin_is_the_distance_to_the_limit_and_its_share_that_of_the_limit(
    comparison, limit, margins, shares
):
    part = Part(LENGTH, VALUES, limit, comparison)
    assert part.margins().tolist() == margins
    assert part.shares().tolist() == shares


def test_a_share_is_that_of_the_scale_and_of_the_room_below_the_ceiling():
    assert Part(LENGTH, VALUES, 2.0, "<=", scale=4.0).shares().tolist() == [0.5, 0.25, -0.25]
    assert Part(LENGTH, VALUES, 2.0, "<=", scale=0.5).shares().tolist() == [4, 2, -2]
    assert Part(LENGTH, VALUES, 2.0, "<=", scale=0.0).shares().tolist() == [2, 1, -1]
    assert Part(LENGTH, VALUES, 2.0, "==", scale=4.0).shares().tolist() == [-1, -1, -1]
    assert Part(LENGTH, VALUES, 1.0, ">=", ceiling=5.0).shares().tolist() == [-1, 0, 0.5]
    assert Part(LENGTH, VALUES, 2.0, ">=", ceiling=4.0).shares().tolist() == [-1, -0.5, 0.5]
    assert Part(LENGTH, VALUES, 3.0, ">=", ceiling=3.0).shares()[2] == 1.0
    relevant = np.array([True, False, True])
    chosen = Part(LENGTH, VALUES, 2.0, "<=", relevant=relevant).shares()
    assert chosen.tolist() == [1, math.inf, -0.5]


def signal(*parts, **changes):
    return all_of(WINDOW, parts, lambda index, measure: f"{index} {measure.name}", **changes)


def test_one_part_keeps_its_unit_and_several_are_compared_as_shares():
    near = Part(LENGTH, VALUES, 2.0, "<=", detail="near")
    far = Part(LENGTH, 2 * VALUES, 8.0, "<=", measured_name="far", measured_unit="mm")
    alone = signal(near)
    assert (alone.unit, alone.values.tolist()) == ("m", [2, 1, -1])
    assert alone.evidence(1).margin == 1.0
    both = signal(far, near)
    assert (both.unit, both.values.tolist()) == ("1", [1, 0.5, -0.5])
    shown = both.evidence(1)
    assert [measure.name for measure in shown.measures] == ["distance", "far"], "one quantity"
    assert [measure.unit for measure in shown.measures] == ["m", "mm"]
    first = Part(replace(LENGTH, name="length"), 2 * VALUES, 8.0, "<=")
    several = signal(first, near)
    assert [each.name for each in several.evidence(1).measures] == ["length", "distance"]
    assert several.evidence(1).margin == 1, "of the tightest"
    assert [each.name for each in several.evidence(2).measures] == ["distance", "length"]
    broken = both.evidence(2).measures
    assert [measure.name for measure in broken] == ["distance", "far"], "what decided"
    assert [measure.time for measure in shown.measures] == [11.0, 11.0]
    assert (shown.text, shown.margin, shown.unit, shown.is_moment) == ("1 distance", 1, "m", True)
    assert signal(far, near, shown=1).evidence(1).measures == shown.measures[:1]
    assert not signal(near, is_moment=False).evidence(0).is_moment


def test_only_parts_that_count_at_a_sample_are_shown_and_an_equality_has_no_unit():
    never = Part(LENGTH, VALUES, 2.0, "<=", relevant=np.zeros(3, dtype=bool))
    same = Part(COUNT, VALUES, 3.0, "==", measured_unit="m")
    both = signal(never, same)
    assert both.values.tolist() == [-1, -1, 1]
    assert [(m.name, m.limit) for m in both.evidence(2).measures] == [("closed", 3.0)]
    assert both.evidence(2).unit == "1"
    assert signal(never).values.tolist() == [math.inf] * 3
    assert signal(never).unit == "m"


def test_samples_that_are_not_present_or_not_judged_have_no_value():
    part = Part(LENGTH, VALUES, 2.0, "<=")
    some, others = np.array([True, True, False]), np.array([False, True, True])
    masked = signal(part, present=some, applies=others)
    assert np.isnan(masked.values).tolist() == [True, False, True]
    assert (masked.applies is others, masked.present is some) == (True, True)
    holes = np.array([np.nan, np.nan, np.nan])
    plain = MarginSignal(holes, "m", masked.evidence)
    assert plain.unknown().all()
    both = MarginSignal(holes, "m", masked.evidence, applies=others, present=some)
    assert both.unknown().tolist() == [False, True, False]
    assert not signal(part).unknown().any()
    assert np.isnan(signal(Part(LENGTH, holes, 2.0, "<="), part).values).all()


def test_a_measure_has_the_points_and_the_ceiling_of_its_part():
    ends = (np.arange(9.0).reshape(3, 3), np.ones((3, 3)))
    part = Part(LENGTH, VALUES, 2.0, "<=", points=ends, ceiling=7.0, detail="pair")
    measure = part.measure(2, 4.5)
    assert (measure.value, measure.limit, measure.time, measure.ceiling) == (3.0, 2.0, 4.5, 7.0)
    assert (measure.expected, measure.actual) == ((6, 7, 8), (1, 1, 1))
    assert (measure.detail, measure.comparison, measure.unit) == ("pair", "<=", "m")
    assert Part(LENGTH, VALUES, 2.0, "<=").points_at(0) == ((), ())
    assert measured(LENGTH, 1.0, 2.0, ">=", 0.5, name="gap").name == "gap"
