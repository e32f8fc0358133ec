"""The words of the file: which predicate and temporal word is which model."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, get_args

from harness.spec.annotations import keys_of
from harness.spec.base import SpecModel
from harness.spec.checks import (
    Always,
    AnyExpectation,
    AnyPredicate,
    Eventually,
    Never,
    TemporalFields,
    Until,
)
from harness.spec.step import Step


def _by_tag(models: Iterable[Any], tag: str) -> dict[str, type[SpecModel]]:
    return {model.model_fields[tag].default: model for model in models}


PREDICATES = _by_tag(get_args(AnyPredicate), "check")
TEMPORAL = _by_tag((Always, Never, Eventually), "check")
EXPECTATIONS = _by_tag((each for each in get_args(AnyExpectation) if each is not Until), "check")

BESIDE_VERB = tuple(keys_of(Step))
"""Reserved keys: they stand next to a verb, never inside its content."""

BESIDE_CHECK = tuple(keys_of(TemporalFields))
"""Words that stand beside a predicate or a temporal word (or inside, as in the models)."""

UNTIL = "until"
"""Stands beside `always`: `{always: A, until: B}` is the model `Until`."""
