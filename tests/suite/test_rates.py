"""Success rates: against another implementation, and by their promised error."""

import math
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.printable import counted
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
    assert both == "success rate not confirmed"
    four = [
        SampledRate(f"{i}.yaml", "", required, "failed" if i < 2 else "passed") for i in range(4)
    ]
    assert missed(four) == "2 of 4 success rates not confirmed"
    assert missed(four[1:]) == "1 of 3 success rates not confirmed"


@pytest.mark.parametrize("required", [0.5, 0.8, 0.9])
def test_the_named_number_of_whole_samples_is_the_smallest_that_decides_a_rate(required):
    seen = 0
    for total in (10, 24, 37):
        for passed in range(1, total):
            rate = rate_of([number < passed for number in range(total)], required, 0.95,
                           stop_early=False)  # fmt: skip
            if rate.verdict != "open" or passed / total == required:
                continue
            seen += 1
            assert counted(rate.more, "more sample") in rate_text("a", rate)
            whole = math.floor if passed / total > required else math.ceil
            for more in range(max(1, rate.more - 20), rate.more + 1):
                all_passed = passed + whole(more * (passed / total))
                low, high = wilson_interval(all_passed, total + more, 0.95)
                assert (low >= required or high < required) is (more == rate.more)
    assert seen > 10


def test_the_samples_named_for_22_of_24_decide_when_all_but_the_expected_failures_pass():
    rate = rate_of([number < 22 for number in range(24)], 0.8, 0.95, stop_early=False)
    passed = 22 + rate.more * 22 // 24
    assert wilson_interval(passed, 24 + rate.more, 0.95)[0] >= 0.8
    assert wilson_interval(42, 46, 0.95)[0] < 0.8
    assert rate.more > 22


def test_no_number_of_samples_decides_a_rate_that_is_the_required_one():
    rate = rate_of([True] * 3 + [False], 0.75, 0.95, stop_early=False)
    assert rate.more == 0
    assert "as many pass as are required" in rate_text("a", rate)


def test_samples_that_could_not_be_run_are_counted_next_to_the_rate():
    tally = Tally(0.5, 0.95, stop_early=False)
    for number in range(4):
        tally.add(number > 0, str(number))
    assert "confidence), 2 samples invalid and not counted: at least" in rate_text(
        "x", tally.rate(6, invalid=2)
    )
