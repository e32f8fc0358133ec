"""Temporal words against their definitions, written as loops."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.assertions.temporal import (
    TooShort,
    always,
    at_end,
    episodes,
    eventually,
    longest_hold,
    never,
    range_min,
    trailing_max,
    until,
)

EPS = 1e-9


@st.composite
def signals(draw):
    """Margins (ties likely), and rising times on a grid of 10 ms with gaps."""
    n = draw(st.integers(1, 40))
    values = draw(st.lists(st.integers(-3, 3), min_size=n, max_size=n))
    gaps = draw(st.lists(st.integers(1, 4), min_size=n, max_size=n))
    return np.array(values, dtype=float), np.cumsum(gaps) * 0.01


spans = st.none() | st.integers(0, 60).map(lambda ticks: ticks * 0.01)


def held_minima(values, times, hold, within):
    """Least margin of every span that may be the one, in order of its start."""
    found = []
    for i, start in enumerate(times):
        if within is not None and start > times[0] + within + EPS:
            continue
        ends = [j for j in range(i, len(times)) if times[j] >= start + (hold or 0.0) - EPS]
        if ends:
            found.append(min(values[i : ends[0] + 1]))
    return found


@settings(deadline=None, derandomize=True)
@given(signals(), spans, spans)
def test_eventually_is_the_best_span_and_never_its_opposite(signal, hold, within):
    values, times = signal
    minima = held_minima(values, times, hold, within)
    if not minima:
        for word in (eventually, never):
            with pytest.raises(TooShort):
                word(values, times, hold, within)
        return
    decision = eventually(values, times, hold, within)
    assert decision.value == max(minima)
    assert decision.holds == any(least >= 0 for least in minima)
    assert values[decision.index] == decision.value
    opposite = never(values, times, hold, within)
    assert opposite.value == -decision.value
    assert opposite.holds != decision.holds


@settings(deadline=None, derandomize=True)
@given(signals(), spans, spans)
def test_always_is_the_worst_sample_from_the_latest_start_allowed(signal, hold, within):
    values, times = signal
    starts = [
        i
        for i, start in enumerate(times)
        if start <= times[0] + (within or 0.0) + EPS and times[-1] - start >= (hold or 0.0) - EPS
    ]
    if not starts:
        with pytest.raises(TooShort):
            always(values, times, hold, within)
        return
    decision = always(values, times, hold, within)
    assert decision.value == max(min(values[i:]) for i in starts)
    assert decision.holds == (decision.value >= 0)
    assert values[decision.index] == decision.value


@settings(deadline=None, derandomize=True)
@given(signals(), spans)
def test_at_the_end_all_of_the_last_seconds_count(signal, hold):
    values, times = signal
    begins = [i for i, start in enumerate(times) if times[-1] - start >= (hold or 0.0) - EPS]
    if not begins:
        with pytest.raises(TooShort):
            at_end(values, times, hold)
        return
    decision = at_end(values, times, hold)
    assert decision.value == min(values[max(begins) :])
    assert values[decision.index] == decision.value


@settings(deadline=None, derandomize=True)
@given(signals(), spans)
def test_a_deadline_never_makes_at_the_end_easier(signal, within):
    values, times = signal
    assert at_end(values, times, None, within).value <= at_end(values, times).value
    assert (
        at_end(values, times, None, within).value <= eventually(values, times, None, within).value
    )


@settings(deadline=None, derandomize=True)
@given(signals(), st.integers(0, 50).map(lambda ticks: ticks * 0.01))
def test_the_trailing_maximum_looks_back_and_not_ahead(signal, span):
    values, times = signal
    expected = [
        max(v for v, t in zip(values, times, strict=True) if now - span - EPS <= t <= now)
        for now in times
    ]
    assert trailing_max(values, times, span).tolist() == expected


@settings(deadline=None, derandomize=True)
@given(signals(), st.data())
def test_the_minimum_of_ranges_is_exact(signal, data):
    values, _ = signal
    last = np.array(data.draw(st.lists(st.integers(0, len(values) - 1), min_size=1, max_size=9)))
    first = np.array([data.draw(st.integers(0, int(stop))) for stop in last])
    expected = [values[a : b + 1].min() for a, b in zip(first, last, strict=True)]
    assert range_min(values, first, last).tolist() == expected


def test_a_hold_counts_from_its_first_sample_to_its_last():
    times = np.arange(6) * 0.1
    values = np.array([-1.0, 1, 1, 1, -1, 1])
    assert episodes(values >= 0) == [(1, 4), (5, 6)]
    assert longest_hold(values, times) == pytest.approx(0.2)
    assert eventually(values, times, hold=0.2).holds
    assert not eventually(values, times, hold=0.3).holds


def test_minus_infinity_stays_where_it_is():
    values = np.array([1.0, -np.inf, 2.0, 3.0])
    times = np.arange(4) * 0.1
    assert eventually(values, times, hold=0.1).value == 2.0
    assert always(values, times).value == -np.inf


@pytest.mark.parametrize("hold", [None, 0.02])
def test_an_until_is_decided_inside_the_span_in_which_the_second_held(hold):
    """Held from sample 4 on: samples after the span of the hold do not decide, however low."""
    times = np.arange(8) * 0.01
    second = np.array([-1, -1, -1, -1, 0.5, 0.4, 0.6, -2.0])
    first = np.full(8, 3.0)
    decision, is_second = until(first, second, times, hold, None)
    assert is_second
    assert decision.holds
    expected = (0.4, 5) if hold else (0.6, 6)
    assert (decision.value, decision.index) == expected


def test_an_until_that_does_not_hold_before_is_decided_by_the_first():
    times = np.arange(5) * 0.01
    first = np.array([1.0, -0.3, 1.0, 9.0, -9.0])
    second = np.array([-1.0, -1.0, -1.0, 0.5, 0.5])
    decision, is_second = until(first, second, times, None, None)
    assert (is_second, decision.holds) == (False, False)
    assert (decision.value, decision.index) == (-0.3, 1)
