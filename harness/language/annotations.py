"""What a field's annotation holds: the models, lists and mappings a value may be."""

from __future__ import annotations

import inspect
import types
from collections.abc import Iterable
from typing import Annotated, Any, TypeGuard, Union, get_args, get_origin

from pydantic import BaseModel, BeforeValidator
from pydantic.fields import FieldInfo

from harness.language.base import SpecModel
from harness.language.plugin_field import PluginModel


def bare(annotation: Any) -> Any:
    """The annotation without `Annotated` and `| None`; of a plug-in's key its model."""
    while True:
        if get_origin(annotation) is Annotated:
            annotation = plugin_model(annotation) or get_args(annotation)[0]
            continue
        members = branches(annotation)
        if not members or type(None) not in members:
            return annotation
        rest = tuple(member for member in members if member is not type(None))
        annotation = rest[0] if len(rest) == 1 else Union[rest]  # noqa: UP007  # built at run time


def plugin_model(annotation: Any) -> Any:
    """The model of a plug-in's key, `Any` where the plug-in is missing; None of other keys."""
    keys = (each for each in get_args(annotation) if isinstance(each, PluginModel))
    return next((key.model or Any for key in keys), None)


def branches(annotation: Any) -> tuple[Any, ...]:
    """The members of a union; of anything else none."""
    return get_args(annotation) if get_origin(annotation) in (Union, types.UnionType) else ()


def is_model(annotation: Any) -> TypeGuard[type[SpecModel]]:
    """Whether this is one of the file's models."""
    return isinstance(annotation, type) and issubclass(annotation, SpecModel)


def spelling(name: str, field: FieldInfo) -> str:
    """A field's key in the file."""
    return field.alias or name


def units_of(annotation: Any, metadata: Iterable[Any] = ()) -> tuple[str, ...]:
    """SI units of a number that may carry one; none of anything else.

    Args:
        metadata: The metadata of the field, where pydantic has taken it out of the annotation.
    """
    members = [each for each in branches(annotation) if each is not type(None)]
    if len(members) == 1:
        return units_of(members[0])
    while get_origin(annotation) is Annotated:
        annotation, *more = get_args(annotation)
        metadata = (*more, *metadata)
    functions = (item.func for item in metadata if isinstance(item, BeforeValidator))
    return next((func.units for func in functions if hasattr(func, "units")), ())  # type: ignore[union-attr]


def unit_of(model: BaseModel, key: str) -> str:
    """The unit of a field of a model; empty where it has none, or depends on a joint."""
    field = type(model).model_fields[key]
    units = units_of(field.annotation, field.metadata)
    return units[0] if len(units) == 1 and units != ("1",) else ""


def description_of(model: type[SpecModel]) -> str:
    """A model's docstring, one line for each paragraph."""
    paragraphs = inspect.cleandoc(model.__doc__ or "").split("\n\n")
    return "\n\n".join(" ".join(each.split()) for each in paragraphs)


def keys_of(model: type[SpecModel]) -> dict[str, FieldInfo]:
    """A model's fields by their key in the file."""
    return {spelling(name, field): field for name, field in model.model_fields.items()}
