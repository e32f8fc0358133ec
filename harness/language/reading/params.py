"""Parameters of a file: `${name}`."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from harness.core.errors import Problem
from harness.core.suggestion import did_you_mean
from harness.language.files.mistakes import value_text
from harness.language.files.source import Entry, Located, Place

REFERENCE = re.compile(r"\$(?P<escape>\$?)\{(?P<name>[^{}]*)\}")
PARAMS = "params"


def substitute(root: Located, problems: list[Problem]) -> Located:
    """A file's values with `${name}` replaced by the parameter's value.

    A text that is one reference alone takes the value with its type; inside a longer text the
    value is written out. `$${name}` stays `${name}`. Nothing is calculated.
    """
    params = parameters(root)
    entries = {
        key: item if key == PARAMS else Entry(item.key, filled(item.value, params, problems))
        for key, item in root.mapping().items()
    }
    return Located(entries, root.place)


def parameters(root: Located) -> dict[str, Entry]:
    """The parameters of a file by their names; none where it has no `params`."""
    entry = root.mapping().get(PARAMS)
    return {} if entry is None else entry.value.mapping()


def escaped(item: Located) -> Located:
    """The inverse for a file that is written again: text that looks like a reference, escaped."""
    if isinstance(item.value, str):
        return Located(REFERENCE.sub(r"$\g<0>", item.value), item.place)
    return mapped(item, escaped)


def filled(item: Located, params: Mapping[str, Entry], problems: list[Problem]) -> Located:
    """A value with every `${name}` in it replaced by the parameter of that name."""
    text = item.value
    if not isinstance(text, str):
        return mapped(item, lambda child: filled(child, params, problems))
    whole = REFERENCE.fullmatch(text)
    if whole and not whole["escape"]:
        value = _value(whole["name"], params, item.place, problems)
        return item if value is None else value.moved(item.place)

    def written(match: re.Match[str]) -> str:
        if match["escape"]:
            return match[0][1:]
        value = _value(match["name"], params, item.place, problems)
        if value is None:
            return match[0]
        if isinstance(value.value, dict | list):
            message = f"`{match[0]}` is {value_text(value.plain())}; it cannot stand inside a text"
            problems.append(item.place.problem(message))
            return match[0]
        return value_text(value.value).strip("`") if value.value is not None else ""

    return Located(REFERENCE.sub(written, text), item.place)


def _value(
    name: str, params: Mapping[str, Entry], place: Place, problems: list[Problem]
) -> Located | None:
    if name in params:
        return params[name].value
    hint = did_you_mean(name, params, "params")
    problems.append(place.problem(f"no parameter is called `{name}`", hint))
    return None


def mapped(item: Located, change: Callable[[Located], Located]) -> Located:
    """A mapping or a list with each of its values changed; another value as it is."""
    if isinstance(item.value, dict):
        entries = {key: Entry(entry.key, change(entry.value)) for key, entry in item.value.items()}
        return Located(entries, item.place, item.tag)
    if isinstance(item.value, list):
        return Located([change(child) for child in item.value], item.place, item.tag)
    return item
