"""Every verb and every predicate is carried out; none is silently accepted."""

from typing import get_args

from harness.assertions.judge import EXECUTED
from harness.engine import executors as executors
from harness.engine.registry import is_available
from harness.spec.checks import AnyExpectation
from harness.spec.steps import AnyStep


def test_every_verb_of_the_language_is_carried_out():
    assert [model.__name__ for model in get_args(AnyStep) if not is_available(model)] == []


def test_every_expectation_of_the_language_is_judged():
    assert set(get_args(AnyExpectation)) <= EXECUTED
