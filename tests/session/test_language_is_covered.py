"""Every verb and every predicate is carried out; none is silently accepted."""

import re

from harness.cell.step import Step
from harness.core.registry import registry
from harness.judging.expectation import Expectation, Predicate
from harness.language.step import STEPS

EXPECTATIONS = registry("expectation")


def test_every_verb_is_a_class_that_says_checks_and_does_it():
    for verb, step in STEPS.items():
        assert step.verb == verb
        assert re.fullmatch(rf"harness\.(plugins\.\w+\.)?steps\.{verb}", step.__module__)
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


def test_every_expectation_is_a_class_that_says_checks_and_judges_it():
    for word, model in EXPECTATIONS.items():
        module = model.__module__.rpartition(".")[2]
        assert model.word == word == module.rstrip("_")
        assert model.verdict is not Expectation.verdict
        if issubclass(model, Predicate):
            assert model.signal is not Predicate.signal
            assert model.quantities


def test_every_key_of_an_expectation_is_described_in_a_sentence():
    described = {
        f"{word}.{name}": field.description or ""
        for word, model in EXPECTATIONS.items()
        for name, field in model.model_fields.items()
    }
    assert [
        key for key, text in described.items() if not text.endswith((".", "].")) or len(text) < 20
    ] == []
