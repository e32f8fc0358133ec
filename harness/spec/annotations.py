"""What a field's annotation holds: the models, lists and mappings a value may be."""

from __future__ import annotations

import types
from typing import Annotated, Any, TypeGuard, Union, get_args, get_origin

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo

from harness.spec.base import SpecModel


def bare(annotation: Any) -> Any:
    """The annotation without `Annotated` and without `| None`."""
    while True:
        if get_origin(annotation) is Annotated:
            annotation = get_args(annotation)[0]
            continue
        members = branches(annotation)
        if not members or type(None) not in members:
            return annotation
        rest = tuple(member for member in members if member is not type(None))
        annotation = rest[0] if len(rest) == 1 else Union[rest]  # noqa: UP007  # built at run time


def branches(annotation: Any) -> tuple[Any, ...]:
    """The members of a union; of anything else none."""
    return get_args(annotation) if get_origin(annotation) in (Union, types.UnionType) else ()


def is_model(annotation: Any) -> TypeGuard[type[SpecModel]]:
    """Whether this is one of the file's models."""
    return isinstance(annotation, type) and issubclass(annotation, SpecModel)


def spelling(name: str, field: FieldInfo) -> str:
    """A field's key in the file."""
    return field.alias or name


def keys_of(model: type[SpecModel]) -> dict[str, FieldInfo]:
    """A model's fields by their key in the file."""
    return {spelling(name, field): field for name, field in model.model_fields.items()}


def units_of(field: FieldInfo) -> tuple[str, ...]:
    """The SI units in which a field's number may be written; empty where it has none."""
    waiting: list[Any] = [*field.metadata, field.annotation]
    for part in waiting:
        if isinstance(part, BeforeValidator):
            units: tuple[str, ...] | None = getattr(part.func, "units", None)
            if units is not None:
                return units
        if get_origin(part) is Annotated or branches(part):
            waiting += get_args(part)
    return ()
