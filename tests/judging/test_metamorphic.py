"""What no verdict may notice: where the world is, how it is called, in which unit, how often it is
sampled, and what is far away.

Every predicate has a run that satisfies it and one that barely does not (`test_three_runs`), and
temporal words have runs of their own. Each is changed in `CHANGES` ways, with several random
shifts and turns: 32 expectations on 71 runs in 12 variants are 852 cases.
"""

from itertools import product

import numpy as np
import pytest

from harness.judging.expectations.always import Always
from harness.judging.expectations.eventually import Eventually
from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.released import Released
from harness.judging.expectations.upright import Upright
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.plugins.formulas.expectations.until import Until
from tests.judging.evidence import word_of
from tests.judging.synthetic_run import lift_run
from tests.judging.test_three_runs import THREE
from tests.judging.world_changes import (
    doubled,
    in_other_units,
    moved,
    renamed,
    with_far_object,
)

SEEDS = range(3)
CHANGES = {
    **{f"shift {n}": (lambda run, spec, n=n: moved(run, spec, rng(n), turns="")) for n in SEEDS},
    **{f"turn {n}": (lambda run, spec, n=n: moved(run, spec, rng(n), turns="alone"))
       for n in SEEDS},
    **{f"both {n}": (lambda run, spec, n=n: moved(run, spec, rng(n), turns="both"))
       for n in range(2)},
    "names": renamed,
    "units": in_other_units,
    "far object": with_far_object,
    "rate": doubled,
}  # fmt: skip
ROUNDING = {"shift": 1e-9, "turn": 1e-9, "both": 1e-9, "units": 1e-12}
"""By which a margin may differ; names and far objects change no bit of it."""
RATE = 0.01
"""Sampled twice as often, a span of time may end a sample earlier [s]."""

LIFTED = Lifted(object="box", above=0.05)
WORDS = [
    ("always until", Until(predicate=Upright(object="box"), until=LIFTED), lift_run(), ""),
    ("eventually for", Eventually(predicate=LIFTED, **{"for": 0.5}), lift_run(), ""),
    ("always in a step", Always(predicate=Released(object="box")), lift_run(), "approach"),
]
CASES = [
    *((f"{word_of(three.spec)} {kind}", three.spec, getattr(three, kind), three.during)
      for three in THREE for kind in ("satisfied", "barely")),
    *WORDS,
]  # fmt: skip
ALL = list(product(CHANGES, CASES))
SAMPLE = [
    (change, case)
    for index, case in enumerate(CASES)
    for change in (list(CHANGES)[index % len(CHANGES)],)
]


def rng(seed):
    return np.random.default_rng(seed)


def judged(run, spec, step):
    [answer] = judge(run, [PlacedExpectation(spec, step)])
    return answer


def check_unchanged(change, case):
    _, spec, run, step = case
    before = judged(run, spec, step)
    after = judged(*CHANGES[change](run, spec), step)
    assert after.status == before.status, (before, after)
    kind = change.split(" ")[0]
    if kind == "rate":
        assert after.time == pytest.approx(before.time, abs=2 * RATE, nan_ok=True)
        return
    near = ROUNDING.get(kind, 0.0)
    if near and after.unit != before.unit:  # rounding chooses between two that are as tight
        [tied] = [each for each in before.measures if each.unit == after.unit]
        assert after.margin == pytest.approx(abs(tied.limit - tied.value), rel=near, abs=near)
        return
    assert after.unit == before.unit
    assert after.margin == pytest.approx(before.margin, rel=near, abs=near, nan_ok=True)
    if not near:  # rounding chooses among samples of one margin
        assert after.time == pytest.approx(before.time, abs=0, nan_ok=True)
    names = [warning.name for warning in before.warnings]
    assert [warning.name for warning in after.warnings] == names


def name_of(pair):
    change, case = pair
    return f"{change}-{case[0]}"


@pytest.mark.parametrize("pair", SAMPLE, ids=name_of)
def test_no_verdict_depends_on_how_the_world_is_described(pair):
    check_unchanged(*pair)


@pytest.mark.nightly
@pytest.mark.parametrize("pair", ALL, ids=name_of)
def test_no_verdict_depends_on_any_description_of_the_world(pair):
    check_unchanged(*pair)


def test_there_are_as_many_cases_as_the_documentation_says():
    assert len(ALL) == 852
    assert len(SAMPLE) == len(CASES) == 71
