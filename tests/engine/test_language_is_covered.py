"""Every verb and every predicate is carried out; none is silently accepted."""

from typing import get_args

from harness.assertions.judge import EXECUTED
from harness.spec.checks import AnyExpectation
from harness.spec.step import STEPS, Step


def test_every_verb_is_a_class_that_says_checks_and_does_it():
    for verb, step in STEPS.items():
        assert step.verb == verb
        assert step.__module__ == f"harness.steps.{verb}"
        assert step.execute is not Step.execute


def test_every_key_of_a_step_is_described_in_a_sentence():
    described = {
        f"{verb}.{name}": field.description or ""
        for verb, step in STEPS.items()
        for name, field in step.model_fields.items()
    }
    assert [
        key for key, text in described.items() if not text.endswith((".", "].")) or len(text) < 20
    ] == []


def test_every_expectation_of_the_language_is_judged():
    assert set(get_args(AnyExpectation)) <= EXECUTED
