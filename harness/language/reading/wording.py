"""pydantic's errors as problems of the file, in a roboticist's words."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from typing import Any, cast

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from harness.core.errors import Problem
from harness.core.suggestion import did_you_mean
from harness.language.base import SpecModel
from harness.language.files.mistakes import LONGEST_VALUE, MistakeError, value_text
from harness.language.files.source import Found, Loc, SourceMap

Wording = Callable[[ErrorDetails, dict[str, Any], str], tuple[str, str]]  # (message, hint)


def problems_of(errors: Iterable[ErrorDetails], lines: SourceMap) -> list[Problem]:
    """One problem for each place and message."""
    problems: dict[tuple[int, int, str], Problem] = {}
    for error in errors:
        if is_follow_up(error):
            continue
        problem = _problem(error, lines)
        problems.setdefault((problem.line, problem.column, problem.message), problem)
    return list(problems.values())


def is_follow_up(error: ErrorDetails) -> bool:
    """Whether pydantic calls a list too short because items of it are wrong."""
    given: object = error["input"]
    length = len(cast("list[Any]", given)) if isinstance(given, list) else 0
    return error["type"] == "too_short" and length >= error.get("ctx", {})["min_length"]


def _problem(error: ErrorDetails, lines: SourceMap) -> Problem:
    loc: Loc = error["loc"]
    found = lines.find(loc)
    place = found.item.place
    if error["type"] == "missing":
        return place.problem(*_missing(loc, found))
    is_key = bool(loc) and loc[-1] == "[key]" and found.key is not None
    if is_key and found.key is not None:
        place = found.key
    word = WORDINGS.get(error["type"], _as_said)
    message, hint = word(error, error.get("ctx", {}), value_text(error["input"]))
    raised = error.get("ctx", {}).get("error")
    if isinstance(raised, MistakeError) and raised.span is not None:
        place = place.part(str(found.item.plain()), *raised.span)
    if error["type"] != "value_error" or message.startswith("is "):
        message = f"a name {message}" if is_key else f"`{_subject(found)}` {message}"
    return place.problem(message, hint)


def _subject(found: Found) -> str:
    """The key that the value belongs to: `xyz`, for its third item too."""
    names = [part for part in found.path if isinstance(part, str)]
    return names[-1] if names else "the file"


def _missing(loc: Loc, found: Found) -> tuple[str, str]:
    part = loc[-1]
    if isinstance(part, int):
        size = len(found.item.items())
        noun = "item" if size == 1 else "items"
        return f"`{_subject(found)}` has {size} {noun}; item {part + 1} is missing", ""
    where = found.item.tag or next((p for p in reversed(found.path) if isinstance(p, str)), "")
    inside = f" in `{where}`" if where else ""
    steps = " with a list of steps" * (part in ("steps", "during"))
    return f"`{part}` is missing{inside}", f"add `{part}:`{steps}"


def _value_error(error: ErrorDetails, context: dict[str, Any], _: str) -> tuple[str, str]:
    raised = context.get("error")
    if isinstance(raised, MistakeError):
        return raised.message, raised.hint
    text = str(raised) if raised is not None else error["msg"]
    message, _, hint = text.partition("; ")
    return message, hint


def _literal(error: ErrorDetails, context: dict[str, Any], value: str) -> tuple[str, str]:
    valid = re.findall(r"'([^']*)'", str(context.get("expected", "")))
    hint = did_you_mean(str(error["input"]), valid, "valid")
    return f"cannot be {value}", hint


def _not_a(what: str, hint: str = "") -> Wording:
    return lambda _error, _context, value: (f"is {what}, not {value}", hint)


def _bound(words: str, key: str) -> Wording:
    return lambda _, context, value: (f"must be {words} {context[key]:g}, not {value}", "")


def _length(words: str, key: str) -> Wording:
    def word(error: ErrorDetails, context: dict[str, Any], _: str) -> tuple[str, str]:
        count, actual = context[key], context.get("actual_length")
        noun = "item" if count == 1 else "items"
        found = f", not {actual}" if actual is not None else ""
        given: object = error["input"]
        items = cast("list[Any]", given) if isinstance(given, list) else []
        is_comma = key == "max_length" and items and all(isinstance(item, int) for item in items)
        hint = "a decimal number has a point: `0.2`, not `0,2`" if is_comma else ""
        return f"has {words} {count} {noun}{found}", hint

    return word


def _characters(words: str, key: str) -> Wording:
    def word(_: ErrorDetails, context: dict[str, Any], value: str) -> tuple[str, str]:
        noun = "character" if context[key] == 1 else "characters"
        return f"has {words} {context[key]} {noun}, not {value}", ""

    return word


def _text(error: ErrorDetails, _: dict[str, Any], value: str) -> tuple[str, str]:
    is_scalar = isinstance(error["input"], int | float)
    hint = f'write "{value.strip("`")}" to mean text' if is_scalar else ""
    return f"is text, not {value}", hint


def _as_said(error: ErrorDetails, _: dict[str, Any], value: str) -> tuple[str, str]:
    text = error["msg"]
    return f"cannot be {value}: {text[0].lower()}{text[1:]}", ""


def _mapping(error: ErrorDetails, context: dict[str, Any], value: str) -> tuple[str, str]:
    """A value in place of a mapping; the keys under which this value can stand."""
    message = f"is a mapping of keys and values, not {value}"
    name = context.get("class_name")
    given: object = error["input"]
    values = cast("list[object]", given) if isinstance(given, list) else []
    if name is None and values and (first := on_one_line(values[0])):
        return message, f"write a name before each value: `{{NAME: {first}, ...}}`"
    models = [model for model in _models(SpecModel) if model.__name__ == name]
    if len(models) != 1 or error["input"] is None:
        return message, ""
    keys = [field.alias or key for key, field in models[0].model_fields.items()]
    return message, written_under(models[0], keys, error["input"]) or f"keys: {', '.join(keys)}"


def written_under(model: type[SpecModel], keys: Iterable[str], value: object) -> str:
    """How to write a bare value as a mapping, by the keys that it fits; empty if none is known."""
    written = on_one_line(value)
    fitting = [key for key in keys if _fits(model, {key: value})] if written else []
    return (
        f"write {' or '.join(f'`{{{key}: {written}}}`' for key in fitting[:3])}" if fitting else ""
    )


def _models(base: type[SpecModel]) -> Iterator[type[SpecModel]]:
    for model in base.__subclasses__():
        yield model
        yield from _models(model)


def _fits(model: type[SpecModel], content: dict[str, Any]) -> bool:
    try:
        model.model_validate(content)
    except ValidationError:
        return False
    return True


def _list(error: ErrorDetails, _: dict[str, Any], value: str) -> tuple[str, str]:
    """A value in place of a list, and how it is written as one."""
    given: object = error["input"]
    message = f"is a list, not {value}"
    if isinstance(given, bool):
        return message, ""  # no list has such items
    if isinstance(given, dict):
        axes = cast("dict[str, object]", given)
        if list(axes) in (["x", "y", "z"], ["x", "y", "z", "w"], ["roll", "pitch", "yaw"]):
            return message, f"write `{on_one_line(list(axes.values()))}`"
        return message, "begin every item with `- `"
    items = re.split(r"[\s,;]+", given.strip()) if isinstance(given, str) else []
    is_numbers = len(items) > 1 and all(re.fullmatch(r"[-+.\de]+", item) for item in items)
    written = ", ".join(items) if is_numbers else on_one_line(given)
    if error["type"] == "tuple_type" and re.match(r"[-+.]?\d", written) and not is_numbers:
        written += ", ..."  # lists of numbers have several items
    return message, f"write `[{written}]`" if written else ""


def on_one_line(value: object) -> str:
    """A value on one line of YAML; empty for what is long or has parts of its own."""
    if isinstance(value, list):
        items = [on_one_line(item) for item in cast("list[object]", value)]
        text = f"[{', '.join(items)}]" if items and all(items) else ""
    else:
        text = str(value) if isinstance(value, str | int | float) else ""
    return text if len(text) <= LONGEST_VALUE and text.isprintable() else ""


BOOLEAN = "YAML 1.2: `yes`, `no`, `on`, `off` are text"
NUMBER = _not_a("a number")

WORDINGS: dict[str, Wording] = {
    "value_error": _value_error,
    "literal_error": _literal,
    "float_type": NUMBER,
    "float_parsing": NUMBER,
    "finite_number": _not_a("a finite number"),
    "int_type": _not_a("a whole number"),
    "int_from_float": _not_a("a whole number"),
    "int_parsing": _not_a("a whole number"),
    "int_parsing_size": _not_a("a whole number of sensible size"),
    "bool_type": _not_a("true or false", BOOLEAN),
    "bool_parsing": _not_a("true or false", BOOLEAN),
    "string_type": _text,
    "string_too_short": _characters("at least", "min_length"),
    "string_too_long": _characters("at most", "max_length"),
    "dict_type": _mapping,
    "model_type": _mapping,
    "model_attributes_type": _mapping,
    "tuple_type": _list,
    "list_type": _list,
    "too_short": _length("at least", "min_length"),
    "too_long": _length("at most", "max_length"),
    "greater_than": _bound("more than", "gt"),
    "greater_than_equal": _bound("at least", "ge"),
    "less_than": _bound("less than", "lt"),
    "less_than_equal": _bound("at most", "le"),
}
