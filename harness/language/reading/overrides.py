"""Values set by dotted path (`objects.cube.pose.xyz.2`), with `--set` or from case to case."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, get_args, get_origin

from harness.core.errors import Problem, SpecError
from harness.core.suggestion import did_you_mean
from harness.language.annotations import bare, branches, is_model, keys_of
from harness.language.base import Rpy
from harness.language.expectation import ExpectationFields, PredicateFields
from harness.language.files.mistakes import value_text
from harness.language.files.source import Entry, Located, Place, Source, located
from harness.language.files.yaml_file import parse_value
from harness.language.language import EXPECTATIONS, KEYS_BY_PREDICATE, TEMPORAL, UNTIL
from harness.language.reading.params import PARAMS, parameters
from harness.language.reading.short_forms import expanded
from harness.language.reading.written import as_written
from harness.language.scenario import Scenario
from harness.language.step import STEPS, StepFields

NO_ROTATION = (0.0, 0.0, 0.0)  # where `rpy` is absent and an angle is set

WORLDS_OBJECT = "add it to `objects` with `replace: true` to change an object of the world"


class Override(NamedTuple):
    """A value and the path where it goes.

    Attributes:
        path: Keys, indices from 0 and names of list items (objects, cameras, ids of steps), joined
            by dots.
        place: Where mistakes in the path are reported.
    """

    path: str
    value: Located
    place: Place

    @property
    def is_option(self) -> bool:
        """Whether it was given on the command line."""
        return not self.place.line


NAMES_OF_CASES = ("name", "title", "case", "cases")  # what people write for named cases
NAMED_CASES = "named cases are a list below `parametrize:`, each with its name as `id`:"
NAMED_CASE = "`- {id: small, params.size: 2 cm}`"


class _PathError(Exception):
    """A path that leads nowhere: message and hint."""


def from_options(overrides: Mapping[str, str], problems: list[Problem]) -> list[Override]:
    """Overrides as given with `--set`: path -> value as YAML."""
    found: list[Override] = []
    for path, text in overrides.items():
        source = Source(f"--set {path}={text}")
        try:
            found.append(Override(path, parse_value(text, source), Place(source)))
        except SpecError as error:
            problems += error.problems
    return found


def apply_overrides(root: Located, overrides: list[Override], problems: list[Problem]) -> Located:
    """A scenario's values with others in their place; mistakes are added to `problems`.

    A key that may stand where the path says is added; below a key that is absent, its default is
    changed. A bare name that is a parameter sets the parameter.
    """
    for each in overrides:
        try:
            parts = _parts(root, each.path)
            root = _Setter(each).set(root, Scenario, parts)
        except _PathError as error:
            message, hint = error.args
            if each.path in NAMES_OF_CASES and not each.is_option:
                hint = f"{NAMED_CASES} {NAMED_CASE}"
            problems.append(each.place.problem(message, hint))
    return root


def value_at(root: Located, path: str) -> Any:
    """The value that an override of a path would replace; None where the file has none.

    Args:
        root: The scenario's values, parameters substituted.
        path: Path of a value, as `--set` takes it.
    """
    reader = _Reader(Override(path, Located(None, root.place), root.place))
    try:
        reader.set(root, Scenario, _parts(root, path))
    except _PathError:
        return None
    return reader.found


def _parts(root: Located, path: str) -> list[str]:
    """The path's parts; a bare name may be a parameter's."""
    parts = path.split(".")
    params = parameters(root)
    keys = keys_of(Scenario)
    if parts[0] in params and (parts[0] not in keys or len(parts) == 1):
        return [PARAMS, *parts]
    if parts[0] == PARAMS and len(parts) > 1 and parts[1] not in params:
        raise _PathError(
            f"no parameter is called `{parts[1]}`", did_you_mean(parts[1], params, "params")
        )
    if parts[0] in keys:
        return parts
    hint = did_you_mean(parts[0], (*params, *keys), "what can be set")
    raise _PathError(f"the file has no `{parts[0]}` to set", hint)


class _Setter:
    def __init__(self, apply_overrides: Override) -> None:
        self.override = apply_overrides

    def set(self, item: Located, annotation: Any, parts: list[str]) -> Located:
        """The value with the override's at the end of the path; raises _PathError."""
        if not parts:
            return self.override.value
        kind = _kind(item, annotation)
        if is_model(kind):
            item = item if isinstance(item.value, dict) else expanded(item, kind)
        if isinstance(item.value, dict):
            return self._in_mapping(item, kind, parts)
        if isinstance(item.value, list):
            return self._in_list(item, kind, parts)
        above = self._above(parts)
        message = f"`{above}` is {value_text(item.value)}; it has no `{parts[0]}`"
        way = f"--set {above}=..." if self.override.is_option else f"`{above}`"
        raise _PathError(message, f"set the whole of it: {way}")

    def _in_mapping(self, item: Located, kind: Any, parts: list[str]) -> Located:
        entries = item.mapping()
        part, rest = _key(parts, item)
        annotation, default = _field(kind, part)
        place = self.override.value.place
        old = entries.get(part)
        if old is not None and old.value.value is not None:
            key, below = old
        else:
            key = old.key if old is not None else place
            below = located(default, place)
        if below.value is None and rest and (annotation is None or _is_mapping(annotation)):
            below = Located({}, place)
        if below.value is None and rest:
            message = f"the file does not say `{self._above(rest)}`, and it has no default"
            raise _PathError(message, "write it in the file, so that a part of it can be set")
        new = Entry(key, self.set(below, annotation, rest))
        return Located({**entries, part: new}, item.place, item.tag)

    def _in_list(self, item: Located, kind: Any, parts: list[str]) -> Located:
        items = item.items()
        index, taken = _index(items, parts)
        if index is None:
            names = [name for each in items for name in _names(each)]
            message = f"`{parts[0]}` in `{self.override.path}` is no index of this list of"
            message += f" {len(items)}" + (", and no name in it" if names else "")
            indices = f"indices: 0 to {len(items) - 1}" if items else "indices: none, it is empty"
            hints = [did_you_mean(parts[0], names, "names")] * bool(names) + [indices]
            hints += [WORLDS_OBJECT] * (self._above(parts) == "objects")
            raise _PathError(message, "; ".join(hints))
        items = list(items)
        items[index] = self.set(items[index], _item_kind(kind, index), parts[taken:])
        return Located(items, item.place, item.tag)

    def _above(self, rest: list[str]) -> str:
        """The part of the path in front of the rest."""
        return self.override.path[: len(self.override.path) - len(".".join(rest)) - 1]


class _Reader(_Setter):
    """Follows a path as an override does, and keeps the value at its end."""

    found: Any = None

    def set(self, item: Located, annotation: Any, parts: list[str]) -> Located:
        if not parts:
            self.found = item.plain()
        return super().set(item, annotation, parts)


def _kind(item: Located, annotation: Any) -> Any:
    """The annotation without unions: the branch that a value of this shape belongs to."""
    annotation = bare(annotation)
    members = [bare(each) for each in branches(annotation)]
    if not members:
        return annotation
    models = [each for each in members if is_model(each)]
    lists = [each for each in members if get_origin(each) is tuple]
    chosen = lists if isinstance(item.value, list) else models
    return chosen[0] if chosen else None


def _key(parts: list[str], item: Located) -> tuple[str, list[str]]:
    """The key that a path continues with, and the rest of the path.

    A key of the file may have dots, as those of `randomize` have: `randomize.params.w.choice`.
    """
    entries = item.mapping()
    for taken in range(len(parts), 1, -1):
        if (key := ".".join(parts[:taken])) in entries:
            return key, parts[taken:]
    return parts[0], parts[1:]


def _field(kind: Any, key: str) -> tuple[Any, Any]:
    """Annotation and default of a key, as plain data; None where the language has none."""
    if kind is StepFields and key in STEPS:
        return STEPS[key], {}
    if kind in (ExpectationFields, PredicateFields):
        if key in TEMPORAL or key == UNTIL:
            return PredicateFields, None
        return EXPECTATIONS.get(key), ({} if key not in KEYS_BY_PREDICATE else None)
    if get_origin(kind) is dict:
        return get_args(kind)[1], None
    if not is_model(kind):
        return None, None
    keys = keys_of(kind)
    if key not in keys:
        if kind.short_is_list and kind.short in keys:  # `add_object: {name: ...}`
            return _field(_item_kind(bare(keys[kind.short].annotation), 0), key)
        return None, None
    field = keys[key]
    default = None if field.is_required() else field.get_default(call_default_factory=True)
    if default is None and bare(field.annotation) == Rpy:
        default = NO_ROTATION
    return field.annotation, as_written(default)


def _is_mapping(annotation: Any) -> bool:
    kind = bare(annotation)
    return (
        is_model(kind)
        or get_origin(kind) is dict
        or any(is_model(bare(each)) for each in branches(kind))
    )


def _item_kind(kind: Any, index: int) -> Any:
    arguments = get_args(kind) if get_origin(kind) is tuple else ()
    if not arguments:
        return None
    is_long = arguments[-1] is ...
    return arguments[0] if is_long else arguments[min(index, len(arguments) - 1)]


def _names(item: Located) -> list[str]:
    """What a list's item may be called: an object's or a camera's name, a step's id."""
    entries = item.mapping()
    named = (entries[key].value.value for key in ("name", "id") if key in entries)
    return [each for each in named if isinstance(each, str) and each]


def _index(items: list[Located], parts: list[str]) -> tuple[int | None, int]:
    """Index of the item that a path continues with, and its number of parts: names have dots."""
    first = parts[0]
    if first.isascii() and first.isdecimal() and len(first) <= 9:
        return (int(first), 1) if int(first) < len(items) else (None, 1)
    for taken in range(len(parts), 0, -1):
        name = ".".join(parts[:taken])
        for index, item in enumerate(items):
            if name in _names(item):
                return index, taken
    return None, 1
