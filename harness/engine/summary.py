"""How files spell models."""

from __future__ import annotations

from collections.abc import Iterable

from harness.language.base import SpecModel


def words(models: Iterable[type], tag: str) -> list[str]:
    """How files spell some models, sorted: `words(judged, "check")` are the judged predicates."""
    return sorted(
        str(model.model_fields[tag].default) for model in models if issubclass(model, SpecModel)
    )
