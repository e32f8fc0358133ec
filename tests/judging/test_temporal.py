"""Temporal words against their definitions, written as loops."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.judging.temporal import (
    TIME_RESOLUTION,
    Decision,
    TooShort,
    always,
    at_end,
    bridged,
    episodes,
    eventually,
    later,
    longest_hold,
    never,
    range_min,
    trailing_max,
    with_future,
    without_gaps,
)
from harness.plugins.formulas.expectations.until import until_decision

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


@pytest.mark.parametrize("word", [always, eventually, at_end, never])
def test_a_span_may_be_as_long_as_all_that_is_known_and_no_longer(word):
    values, times = np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.1, 0.3])
    assert abs(word(values, times, 0.3).value) == 1.0
    with pytest.raises(TooShort):
        word(values, times, 0.31)


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


@given(signals(), spans)
def test_a_deadline_never_makes_at_the_end_easier(signal, within):
    values, times = signal
    assert at_end(values, times, None, within).value <= at_end(values, times).value
    assert (
        at_end(values, times, None, within).value <= eventually(values, times, None, within).value
    )


@given(signals(), st.integers(0, 50).map(lambda ticks: ticks * 0.01))
def test_the_trailing_maximum_looks_back_and_not_ahead(signal, span):
    values, times = signal
    expected = [
        max(v for v, t in zip(values, times, strict=True) if now - span - EPS <= t <= now)
        for now in times
    ]
    assert trailing_max(values, times, span).tolist() == expected


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


@pytest.mark.parametrize(
    ("progress", "index"),
    [([0, 0, 2, 9, 1, 0], 3), ([0, 5, 2, 1, 4, 3], 1), ([np.nan, 1, np.nan, 2, 1, 0], 3)],
)
def test_a_hold_that_never_comes_is_decided_where_it_came_furthest(progress, index):
    times = np.arange(6) * 0.1
    missed = eventually(np.full(6, -1.0), times, hold=0.2, progress=np.array(progress, float))
    assert (missed.index, missed.value, missed.holds) == (index, -1.0, False)


def test_a_hold_that_breaks_is_decided_next_to_what_held():
    values, times = np.array([-1.0, -1, 1, 1, -1, -1]), np.arange(6) * 0.1
    missed = eventually(values, times, hold=0.3, progress=np.array([0.0, 1, 8, 9, 2, 0]))
    assert missed.index in (1, 4)


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
    decision, is_second = until_decision(first, second, times, hold, None)
    assert is_second
    assert decision.holds
    expected = (0.4, 5) if hold else (0.6, 6)
    assert (decision.value, decision.index) == expected


def test_an_until_that_does_not_hold_before_is_decided_by_the_first():
    times = np.arange(5) * 0.01
    first = np.array([1.0, -0.3, 1.0, 9.0, -9.0])
    second = np.array([-1.0, -1.0, -1.0, 0.5, 0.5])
    decision, is_second = until_decision(first, second, times, None, None)
    assert (is_second, decision.holds) == (False, False)
    assert (decision.value, decision.index) == (-0.3, 1)


def test_among_equal_margins_the_first_sample_is_shown_or_the_one_that_came_furthest():
    times, values = np.arange(5) * 0.1, np.array([-2.0, -1.0, -2.0, -1.0, -1.0])
    assert eventually(values, times).index == 1
    assert always(values, times).index == 0
    progress = np.array([9.0, np.nan, 9.0, 1.0, 2.0])
    assert eventually(values, times, progress=progress).index == 4
    assert never(values, times, progress=progress).index == 4
    assert eventually(values, times, within=0.3, progress=progress).index == 3
    assert eventually(values, times, progress=np.array([1.0, 5, 9, 5, 4])).index == 1
    lone = np.array([-2.0, -1.0, -2.0, -2.0, -2.0])
    assert eventually(lone, times, progress=np.array([9.0, 1.0, 9, 9, 9])).index == 1


def test_among_equal_spans_the_one_with_most_samples_that_hold_is_shown():
    values = np.array([-1.0, -1.0, 0.0, -1.0, 2.0, 3.0])
    decision = eventually(values[:4], np.arange(4) * 0.1, hold=0.1)
    assert (decision.value, decision.index) == (-1.0, 1)
    decision = eventually(values, np.arange(6) * 0.1, hold=0.2)
    assert (decision.value, decision.index) == (-1.0, 3)


def test_at_the_end_with_a_deadline_shows_the_smaller_of_the_two_margins():
    times = np.arange(3) * 0.1
    assert at_end(np.array([0.5, 1.0, 1.0]), times, within=0.0).index == 0
    assert at_end(np.array([1.0, 2.0, 1.0]), times, within=0.0).index == 2
    assert at_end(np.array([-1.0, 1.0, 0.0]), times, within=0.1).index == 2


def test_only_gaps_shorter_than_a_tenth_of_a_second_are_bridged():
    times = np.array([0.0, 0.1, 0.15, 0.2499, 0.3])
    assert bridged(times, [(0, 1), (1, 2)]) == [(0, 1), (1, 2)]
    assert bridged(times, [(1, 2), (2, 3), (3, 5)]) == [(1, 5)]
    assert bridged(times, []) == []


def test_the_longest_hold_from_the_first_sample_counts_only_what_begins_there():
    times, values = np.arange(6) * 0.1, np.array([0.0, 1, -1, 0, 1, 1])
    assert longest_hold(values, times) == pytest.approx(0.2)
    assert longest_hold(values, times, is_first=True) == pytest.approx(0.1)
    assert longest_hold(-1 - values, times) == longest_hold(values[2:], times, is_first=True) == 0


def test_a_window_that_was_cut_short_has_a_next_sample_and_one_after_any_span():
    times, values = np.array([0.0, 1.5]), np.array([0.25, 0.5])
    future = later(times)
    assert future[:2].tolist() == times.tolist()
    assert TIME_RESOLUTION < future[2] - 1.5 < 10 * TIME_RESOLUTION
    assert future[3] - 1.5 >= 1e8
    assert with_future(values, -1.0).tolist() == [0.25, 0.5, -1.0, -1.0]


def test_an_until_in_which_both_decide_is_decided_by_the_second():
    times = np.arange(3) * 0.1
    decision, is_second = until_decision(np.full(3, 0.5), np.array([-1, -1, 0.5]), times)
    assert (decision, is_second) == (Decision(0.5, 2, holds=True), True)
    decision, is_second = until_decision(np.array([0.5, 0.0, 9]), np.array([-1, -1, 0.5]), times)
    assert (decision, is_second) == (Decision(0.0, 1, holds=True), False)
    decision, is_second = until_decision(np.full(3, -1.0), np.array([0.0, 1.0, 2.0]), times)
    assert (decision, is_second) == (Decision(0.0, 0, holds=True), True), "nothing is before it"
    decision, _ = until_decision(np.ones(3), np.array([-1, -0.5, 3.0]), times, within=0.1)
    assert (decision.value, decision.index) == (-0.5, 1)


@given(signals(), st.integers(0, 8).map(lambda ticks: ticks * 0.01))
def test_gaps_of_a_span_are_closed_with_the_smaller_value_around_them(signal, span):
    """At each level what is reached lasts until it was not for longer than the span."""
    values = np.abs(signal[0])
    times = np.arange(len(values)) * 0.01
    closed = without_gaps(values, times, span)
    for level in range(1, 4):
        expected = values >= level
        ends = np.flatnonzero(expected)
        for before, after in pairwise(ends.tolist()):
            if all(times[j] <= times[before] + span + EPS for j in range(before, after)):
                expected[before:after] = True
        assert (closed >= level).tolist() == expected.tolist()


def test_what_is_not_known_is_no_gap_and_closes_none():
    values = np.array([1.0, 0.0, np.nan, 0.0, 2.0, 0.0])
    closed = without_gaps(values, np.arange(6) * 0.01, 0.03)
    assert closed == pytest.approx([1.0, 1.0, np.nan, 1.0, 2.0, 0.0], nan_ok=True)
