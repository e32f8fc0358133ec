"""What a verdict of `never` says of its measures stands as its status does."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.judging.margins import against, holds
from harness.recording.verdict import Measure

numbers = st.floats(-10, 10).map(lambda value: round(value, 3))
measures = st.lists(
    st.builds(
        Measure, st.just("height"), numbers, numbers, st.sampled_from(["<=", ">="]), st.just("m"),
        st.just(1.0),
    ),
    min_size=1, max_size=4,
)  # fmt: skip


@given(measures)
def test_no_measure_of_a_verdict_contradicts_it(found):
    holds_as_predicate = all(map(holds, found))
    reported = against(found, is_passed=not holds_as_predicate)
    limited = [each for each in reported if math.isfinite(each.limit)]
    assert limited
    touching = [each for each in limited if each.value == each.limit]
    if holds_as_predicate:
        assert all(not holds(each) for each in limited if each not in touching)
    else:
        assert all(map(holds, limited))
    assert [each.value for each in reported] == [each.value for each in found]


@pytest.mark.parametrize(
    ("comparison", "below", "equal", "above"),
    [("<=", True, True, False), (">=", False, True, True), ("==", False, True, False)],
)
def test_a_value_holds_on_its_side_of_a_limit_and_at_it(comparison, below, equal, above):
    for value, expected in ((0.9, below), (1.0, equal), (1.1, above)):
        assert holds(Measure("height", value, 1.0, comparison, "m", 1.0)) is expected


def test_measures_of_a_violation_stay():
    force = Measure("contact force", 0.0, 0.0, "<=", "N", 1.0)
    assert against([force], is_passed=True) == (force,)
    hit = Measure("contact force", 4.0, 0.0, "<=", "N", 1.0)
    assert against([hit], is_passed=False) == (hit,)
