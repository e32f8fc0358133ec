"""Two numbers that differ are never written with the same digits."""

import math
import sys

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from harness.core.amounts import amount, amounts, percentages
from harness.planning.collision import wording
from harness.ports.scene import Touch
from harness.recording.verdict import Measure

FINITE = st.floats(allow_nan=False, allow_infinity=False, width=64, min_value=-1e6, max_value=1e6)


@pytest.mark.parametrize("unit", ["m", "rad", "rad/s", "m/s", "1", "N", "s"])
@given(first=FINITE, share=st.sampled_from([1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1]))
def test_two_unequal_amounts_have_unequal_texts(unit, first, share):
    second = first + share * max(abs(first), 1e-9)
    scale = math.degrees(1.0) if unit.startswith("rad") else 1e3 if unit in ("m", "m/s") else 1.0
    assume(first * scale != second * scale)  # equal once they are in the unit that is written
    value, limit = amounts(first, second, unit)
    assert value != limit


@pytest.mark.parametrize(
    ("first", "second", "unit", "texts"),
    [
        (-math.pi - 1e-7, -math.pi, "rad", ("-180.000006 deg", "-180.000000 deg")),
        (0.0120001, 0.012, "m", ("12.00010 mm", "12.00000 mm")),
        (99.99, 100.01, "N", ("99.99 N", "100.01 N")),
        (0.5, 0.7, "s", ("0.5 s", "0.7 s")),
        (0.25, 0.25, "m", ("250 mm", "250 mm")),
    ],
)
def test_only_as_many_digits_are_written_as_it_takes(first, second, unit, texts):
    found = amounts(first, second, unit)
    assert (found[0] == found[1]) == (first == second)
    if amount(first, unit) != amount(second, unit):
        assert found == (amount(first, unit), amount(second, unit))
    assert [len(text) for text in found] <= [len(text) + 2 for text in texts]


@pytest.mark.parametrize(("value", "limit"), [(0.95, 0.9500001), (0.3, 0.30000000000000004)])
def test_shares_measures_and_distances_show_the_digits_that_differ(value, limit):
    assert len(set(percentages(value, limit))) == 2
    said = str(Measure("height", value, limit, ">=", "m", 0.0))
    measured, least = said.removeprefix("height: ").split(")")[0].split(" (at least ")
    assert measured != least
    said = wording.touch(Touch("hand", "box", value, limit))
    apart, required = said.split("(")[1].removesuffix(" required)").split(" apart, ")
    assert apart != required


def test_equal_numbers_and_infinite_ones_are_written_as_usual():
    assert amounts(0.012, 0.012, "m") == ("12.0 mm", "12.0 mm")
    assert amounts(math.inf, 1.0, "N") == ("inf", "1.0 N") or amounts(math.inf, 1.0, "N")[0] != ""
    assert amounts(sys.float_info.max, 1.0, "1")[0] != "1.0"
