"""Parameters of a file, `${name}`, and values set from outside, `--set a.b=c`."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping

from harness.core.errors import Problem, SpecError
from harness.spec.mistakes import describe, did_you_mean
from harness.spec.short_forms import course_words
from harness.spec.source import Entry, Located, Place, Source
from harness.spec.yaml_file import parse_value

REFERENCE = re.compile(r"\$(?P<escape>\$?)\{(?P<name>[^{}]*)\}")
PARAMS = "params"


def override(
    root: Located,
    overrides: Mapping[str, str],
    keys: Iterable[str],
    known: Mapping[str, Located] | None = None,
) -> Located:
    """A file's values with others set from outside.

    Args:
        root: The file as written.
        overrides: Dotted path -> value as YAML. A list's items go by index from 0; a bare name
            that is a parameter sets the parameter; a key that may stand there is added.
        keys: The keys that the whole file may have.
        known: Path -> its value where the file itself says it, so that mistakes are told there.

    Raises:
        SpecError: With every path that leads nowhere and every value that is not YAML.
    """
    problems: list[Problem] = []
    for path, text in overrides.items():
        source = Source(f"--set {path}={text}")
        try:
            value = known[path] if known and path in known else parse_value(text, source)
            place = value.place if known and path in known else Place(source)
            root = _set(root, _parts(root, path, source, tuple(keys)), value, place, path)
        except SpecError as error:
            problems += error.problems
    if problems:
        raise SpecError(problems)
    return root


def substitute(root: Located, problems: list[Problem]) -> Located:
    """A file's values with `${name}` replaced by the parameter's value.

    A text that is one reference alone takes the value with its type; inside a longer text the
    value is written out. `$${name}` stays `${name}`. Nothing is calculated.
    """
    entry = root.mapping().get(PARAMS)
    if entry is None:
        params: dict[str, Entry] = {}
    else:
        params = entry.value.mapping()
    entries = {
        key: item if key == PARAMS else Entry(item.key, filled(item.value, params, problems))
        for key, item in root.mapping().items()
    }
    return Located(entries, root.place)


def escaped(item: Located) -> Located:
    """The inverse for a file that is written again: text that looks like a reference, escaped."""
    if isinstance(item.value, str):
        return Located(REFERENCE.sub(r"$\g<0>", item.value), item.place)
    return _mapped(item, escaped)


def filled(item: Located, params: Mapping[str, Entry], problems: list[Problem]) -> Located:
    """A value with every `${name}` in it replaced by the parameter of that name."""
    text = item.value
    if not isinstance(text, str):
        return _mapped(item, lambda child: filled(child, params, problems))
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
            message = f"`{match[0]}` is {describe(value.plain())}; it cannot stand inside a text"
            problems.append(item.place.problem(message))
            return match[0]
        return describe(value.value).strip("`") if value.value is not None else ""

    return Located(REFERENCE.sub(written, text), item.place)


def _value(
    name: str, params: Mapping[str, Entry], place: Place, problems: list[Problem]
) -> Located | None:
    if name in params:
        return params[name].value
    hint = did_you_mean(name, params, "params")
    problems.append(place.problem(f"no parameter is called `{name}`", hint))
    return None


def _parts(root: Located, path: str, source: Source, keys: tuple[str, ...]) -> list[str]:
    """The path's parts; a bare name may be a parameter's."""
    parts = path.split(".")
    entry = root.mapping().get(PARAMS)
    params = tuple(entry.value.mapping()) if entry is not None else ()
    if parts[0] in params and parts[0] not in keys:
        return [PARAMS, *parts]
    if len(parts) == 1 and parts[0] in params:
        return [PARAMS, *parts]
    if parts[0] in keys:
        return parts
    message = f"the file has no `{parts[0]}` to set"
    raise SpecError(
        [
            Place(source).problem(
                message, did_you_mean(parts[0], (*params, *keys), "what can be set")
            )
        ]
    )


def _set(item: Located, parts: list[str], value: Located, place: Place, path: str) -> Located:
    if not parts:
        return value
    part, rest = parts[0], parts[1:]
    if part == "robot" and isinstance(item.value, dict) and rest and part in item.value:
        robot = item.value[part]
        item = Located(
            {**item.value, part: Entry(robot.key, course_words(robot.value))}, item.place
        )
        rest = ["model" if each == "ur_type" else each for each in rest]
    if isinstance(item.value, dict):
        old = item.value.get(part)
        below = old.value if old is not None else Located({} if rest else None, place)
        if part == "" or (below.value is None and rest):
            below = Located({}, place)
        new = Entry(old.key if old is not None else place, _set(below, rest, value, place, path))
        return Located({**item.value, part: new}, item.place)
    if isinstance(item.value, list):
        size = len(item.value)
        if not part.isdecimal() or len(part) > 9 or int(part) >= size:
            indices = f"0 to {size - 1}" if size else "none, it is empty"
            message = f"`{part}` in `{path}` is no index of this list of {size}"
            raise SpecError([place.problem(message, f"indices: {indices}")])
        items = list(item.value)
        items[int(part)] = _set(items[int(part)], rest, value, place, path)
        return Located(items, item.place)
    above = path[: len(path) - len(".".join(parts)) - 1]
    message = f"`{above}` is {describe(item.value)}; it has no `{part}`"
    raise SpecError([place.problem(message, f"set the whole of it: --set {above}=...")])


def _mapped(item: Located, change: Callable[[Located], Located]) -> Located:
    if isinstance(item.value, dict):
        entries = {key: Entry(entry.key, change(entry.value)) for key, entry in item.value.items()}
        return Located(entries, item.place, item.tag)
    if isinstance(item.value, list):
        return Located([change(child) for child in item.value], item.place, item.tag)
    return item
