"""Success rates: against another implementation, and by their promised error."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.proportion import wilson_interval
from harness.reporting.sampled import SampledRate, missed, rate_line, rate_text
from harness.suite.sampling import Tally, decided
from tests.suite.samples import rate_of


@given(st.integers(1, 400), st.floats(0, 1), st.sampled_from([0.8, 0.95, 0.99]))
def test_the_interval_is_wilsons(total, share, confidence):
    from scipy.stats import binomtest

    passed = round(share * total)
    expected = binomtest(passed, total).proportion_ci(confidence, method="wilson")
    assert wilson_interval(passed, total, confidence) == pytest.approx(tuple(expected), abs=1e-9)


@pytest.mark.parametrize("rate", [0.5, 0.9])
def test_at_the_required_rate_itself_the_sequential_test_rarely_decides(rate):
    rng = random.Random(1)
    wrong = 0
    for _ in range(400):
        passed = 0
        for count in range(1, 301):
            passed += rng.random() < rate
            if decided(passed, count, rate, 0.95) != "open":
                wrong += 1
                break
    assert 0 < wrong <= 0.05 * 400 + 3 * (400 * 0.05 * 0.95) ** 0.5


@pytest.mark.parametrize(("true", "verdict"), [(0.99, "shown"), (0.5, "refuted")])
def test_far_from_the_required_rate_it_decides_early_and_rightly(true, verdict):
    rng = random.Random(2)
    for _ in range(50):
        outcomes = [rng.random() < true for _ in range(400)]
        rate = rate_of(outcomes, 0.8, 0.95, stop_early=True)
        assert rate.verdict == verdict
        assert rate.stopped_early
        assert rate.total < 200


def test_without_an_required_rate_every_one_must_pass():
    assert rate_of([True] * 5, None, 0.95, stop_early=True).verdict == "shown"
    assert rate_of([True, False], None, 0.95, stop_early=True).verdict == "refuted"


def test_too_few_samples_show_nothing_either_way():
    rate = rate_of([True] * 5, 0.9, 0.95, stop_early=True)
    assert rate.verdict == "open"
    assert rate.low < 0.9 < rate.high


def test_a_rate_of_one_cannot_be_shown_and_is_refuted_by_one_failure():
    assert rate_of([True] * 100, 1.0, 0.95, stop_early=True).verdict == "open"
    assert rate_of([True] * 9 + [False], 1.0, 0.95, stop_early=True).verdict == "refuted"


@pytest.mark.parametrize("stop_early", [True, False])
def test_samples_that_are_one_and_the_same_run_show_no_rate(stop_early):
    same = rate_of([True] * 40, 0.5, 0.95, stop_early=stop_early, digests=["a"] * 40)
    assert (same.verdict, same.total, same.is_one_run) == ("open", 40, True)
    assert "one and the same run" in rate_line("x", same)
    failed = rate_of([False] * 40, 0.5, 0.95, stop_early=stop_early, digests=["a"] * 40)
    assert failed.verdict == "open"


def test_samples_that_repeat_some_runs_show_a_rate():
    """A choice of two values has two runs, and one sample is no repetition."""
    two = rate_of([True] * 40, 0.5, 0.95, stop_early=False, digests=["a", "b"] * 20)
    assert (two.verdict, two.is_one_run) == ("shown", False)
    one = rate_of([True], 0.5, 0.95, stop_early=False, digests=["a"])
    assert not one.is_one_run
    broken = rate_of([False] * 3, 0.5, 0.95, stop_early=False, digests=["", "", ""])
    assert not broken.is_one_run


def test_samples_none_of_which_can_be_run_show_no_rate():
    rate = Tally(None, 0.95, stop_early=True).rate(3, invalid=2)
    assert (rate.verdict, rate.total) == ("open", 0)
    assert rate_line("x", rate).endswith("no rate, 2 samples invalid")


@pytest.mark.parametrize("outcomes", [[True, False], [False] * 3])
def test_a_rate_that_is_not_required_is_not_counted_as_unconfirmed(outcomes):
    digests = [str(number) for number in range(len(outcomes))]
    rate = rate_of(outcomes, None, 0.95, stop_early=True, digests=digests)
    required = rate_of(outcomes, 0.9, 0.95, stop_early=True, digests=digests)
    free = SampledRate("a.yaml", "", rate, "failed")
    assert missed([free]) == ""
    assert "no rate is required (`expect_rate`), so every one must pass" in rate_text("a", rate)
    both = missed([free, SampledRate("b.yaml", "", required, "failed")])
    assert both == "1 of 1 success rates not confirmed"


@pytest.mark.parametrize("passed", [19, 21, 22, 23])
def test_as_many_more_samples_as_are_named_decide_an_open_rate(passed):
    outcomes = [number < passed for number in range(24)]
    rate = rate_of(outcomes, 0.85, 0.95, stop_early=False)
    assert rate.verdict == "open"
    assert f"{rate.more} more samples would decide it" in rate_text("a", rate)
    for count, is_decided in ((24 + rate.more, True), (24 + rate.more - 1, False)):
        low, high = wilson_interval(count * passed / 24, count, 0.95)
        assert (low >= 0.85 or high <= 0.85) is is_decided


def test_no_number_of_samples_decides_a_rate_that_is_the_required_one():
    rate = rate_of([True] * 3 + [False], 0.75, 0.95, stop_early=False)
    assert rate.more == 0
    assert "as many pass as are required" in rate_text("a", rate)
