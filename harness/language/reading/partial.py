"""What is valid of a part of a file with mistakes, so that the rest of the part is checked too."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal, cast, get_args, get_origin

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from harness.core.registry import registry
from harness.language.annotations import branches, is_model
from harness.language.base import SpecModel
from harness.language.plugin_field import PluginField

ABSENT: Any = object()
"""In place of a value that cannot be read and that nothing can stand in for."""

NO_NAME = "?"
"""Stands in for a name that cannot be read; problems with it follow from that."""

STAND_INS = (1, 0, True, NO_NAME)
"""Values of which the first valid one stands in for a value that a model needs."""


def partial_plugin(kind: str, tag: str, data: Any, words: set[str]) -> SpecModel | None:
    """Build the model of what is valid of a step or an expectation.

    The validators of the model do not run. A required field that cannot be read has a value that
    stands in for it, or none, so that reading it raises AttributeError.

    Args:
        tag: The key of its name in the shape of the models.
        words: The words of what cannot be read are added here.

    Returns:
        The model; None where no plug-in has the name.
    """
    given = cast("dict[str, Any]", data) if isinstance(data, dict) else {}
    name = given.get(tag)
    if not isinstance(name, str) or name not in registry(kind):
        words.update(texts(data))
        return None
    return partial_model(registry(kind)[name], given, words)


def partial_model(model: type[SpecModel], data: dict[str, Any], words: set[str]) -> SpecModel:
    """Build a model of what is valid of a mapping; see `partial_plugin`."""
    values: dict[str, Any] = {}
    for name, field in model.model_fields.items():
        given = [data[key] for key in (name, field.alias) if key in data]
        is_needed = field.is_required()
        if given:
            values[name] = _value(_annotation(field), given[0], words, is_needed)
        elif is_needed:
            values[name] = _stand_in(_annotation(field), words)
    valid = {name: value for name, value in values.items() if value is not ABSENT}
    return model.model_construct(_fields_set=set(valid), **valid)


def _annotation(field: FieldInfo) -> Any:
    """The annotation of a field with its metadata, of which pydantic has taken it apart."""
    return Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation


def _value(annotation: Any, value: Any, words: set[str], is_needed: bool = True) -> Any:
    """Read a value, or what is valid of it; only where it is needed another stands in for it."""
    valid = _read(annotation, value)
    if valid is ABSENT:
        valid = _part(annotation, value, words)
    if valid is not ABSENT:
        return valid
    words.update(texts(value))
    return _stand_in(annotation, words) if is_needed else ABSENT


def _read(annotation: Any, value: Any) -> Any:
    try:
        return TypeAdapter[Any](annotation).validate_python(value)
    except ValidationError:
        return ABSENT


def _part(annotation: Any, value: Any, words: set[str]) -> Any:
    """Read what is valid of a mapping or a list."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        plugin = next((each for each in arguments if isinstance(each, PluginField)), None)
        if plugin is None:
            return _part(arguments[0], value, words)
        return partial_plugin(plugin.kind, plugin.tag, value, words) or ABSENT
    for branch in branches(annotation):
        part = _part(branch, value, words)
        if part is not ABSENT:
            return part
    if is_model(annotation) and annotation.short and not isinstance(value, dict | list):
        value = {annotation.short: value}
    if isinstance(value, dict):
        given = cast("dict[str, Any]", value)
        if is_model(annotation):
            return partial_model(annotation, given, words)
        if origin is dict:
            items = {key: _value(arguments[1], item, words) for key, item in given.items()}
            return {key: item for key, item in items.items() if item is not ABSENT}
    if isinstance(value, list) and origin is tuple:
        return _items(arguments, cast("list[Any]", value), words)
    return ABSENT


def _items(arguments: tuple[Any, ...], values: list[Any], words: set[str]) -> Any:
    """Read the items of a list up to one that nothing can stand in for."""
    if arguments[-1] is Ellipsis:
        arguments = (arguments[0],) * len(values)
    items = [
        _value(argument, values[index], words)
        if index < len(values)
        else _stand_in(argument, words)
        for index, argument in enumerate(arguments)
    ]
    return tuple(items[: items.index(ABSENT)] if ABSENT in items else items)


def _stand_in(annotation: Any, words: set[str]) -> Any:
    """Give a value that is valid for an annotation; `ABSENT` where none is known."""
    words.add(NO_NAME)
    choices = get_args(annotation) if get_origin(annotation) is Literal else ()
    values = (_read(annotation, each) for each in (*choices, *STAND_INS))
    empty: tuple[Any, Any] = {}, []
    models = (_part(annotation, each, words) for each in empty)
    return next((each for each in (*values, *models) if each is not ABSENT), ABSENT)


def texts(value: Any) -> Iterator[str]:
    """Yield every text of a part of a file, its keys included."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, item in cast("dict[str, Any]", value).items():
            yield key
            yield from texts(item)
    elif isinstance(value, list):
        for item in cast("list[Any]", value):
            yield from texts(item)
