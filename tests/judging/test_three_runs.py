"""For every predicate a run that satisfies it, one that barely does not, one it never applied to.

One expectation is judged on three runs, so what differs is what happened. The barely failing one is
past the limit by less than a tenth of it, and the margin says by how much, in the unit that the
reference names.
"""

import numpy as np
import pytest

from harness.language.language import PREDICATES
from harness.plugins.cameras.expectations.sees import Sees
from tests.judging.evidence import collected, word_of
from tests.judging.picture_mutants import SUBJECTS, seen_run
from tests.judging.synthetic_run import (
    make_run,
    step,
    verdict,
)

N = 200


def quantity_of(word, measure):
    """The quantity that a verdict's measure is one of; None if the predicate has no such one."""
    for quantity in sorted(PREDICATES[word].quantities, key=lambda each: -len(each.name)):
        if quantity.name in measure.name and measure.unit in quantity.unit.split(" or "):
            return quantity
    return None


UNREACHED = make_run(steps=(step("later", N, N, status="not reached"),))


THREE = [three for evidence in collected() for three in evidence.three_runs]


def test_every_predicate_has_its_three_runs():
    assert {type(getattr(each.spec, "predicate", each.spec)) for each in THREE} | {Sees} == set(
        PREDICATES.values()
    )


@pytest.mark.parametrize("three", THREE, ids=lambda three: word_of(three.spec))
def test_it_passes_barely_fails_and_says_nothing_of_what_it_never_met(three):
    assert verdict(three.satisfied, three.spec, three.during).status == "passed"
    failed = verdict(three.barely, three.spec, three.during)
    assert (failed.status, failed.unit) == ("failed", three.unit)
    assert failed.margin == pytest.approx(three.by, rel=1e-3)
    assert failed.measures
    assert np.isfinite(failed.time)
    if three.never is not None:
        assert verdict(three.never, three.spec).status == "not reached"
    unreached = verdict(UNREACHED, three.spec, "later")
    assert unreached.status == "not reached"
    assert "before step 'later'" in unreached.reason


@pytest.mark.parametrize("three", THREE, ids=lambda three: word_of(three.spec))
def test_the_numbers_of_a_verdict_are_those_of_the_reference(three):
    for run in (three.satisfied, three.barely):
        answer = verdict(run, three.spec, three.during)
        named = [quantity_of(word_of(three.spec), m) for m in answer.measures]
        assert None not in named, answer.measures
        units = " or ".join(each.unit for each in PREDICATES[word_of(three.spec)].quantities)
        assert answer.unit in units.split(" or ")


@pytest.mark.parametrize("kind", SUBJECTS)
def test_what_a_camera_sees_is_measured_as_the_reference_says(kind):
    spec, run, _ = seen_run(kind)
    answer = verdict(run, spec)
    assert answer.status == "passed"
    assert all(quantity_of("sees", m) for m in answer.measures)
    assert verdict(UNREACHED, spec, "later").status == "not reached"


@pytest.mark.parametrize("model", PREDICATES.values(), ids=lambda model: model.__name__)
def test_a_predicate_is_defined_in_one_sentence(model):
    definition = " ".join(model.__doc__.split("\n\n")[0].split())
    assert definition.endswith(".")
    assert definition.count(". ") == 0
