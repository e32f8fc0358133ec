"""Brings a file's short forms into the models' shape: `- gripper: open` to `{do: gripper, ...}`.

Guided by the models: a verb or predicate becomes a tag, a bare value the field it is short for.
Unknown words are refused here, where it is known what could stand in their place; what is wrong
is left out, so that pydantic continues with the rest. Every value keeps its place in the file.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast, get_args, get_origin

from pydantic.fields import FieldInfo

from harness.core.errors import Problem
from harness.core.suggestion import SYNONYMS, did_you_mean, is_slip, nearest
from harness.language.annotations import bare, branches, is_model, keys_of, units_of
from harness.language.base import SpecModel
from harness.language.expectation import CHECK, ExpectationFields, PredicateFields
from harness.language.files.mistakes import value_text
from harness.language.files.source import Entry, Located
from harness.language.language import (
    EXPECTATIONS,
    KEYS_BY_PREDICATE,
    KEYS_BY_VERB,
    PLACEHOLDER_VERB,
    PLACEHOLDER_WORD,
    PREDICATES,
    TEMPORAL,
    UNTIL,
)
from harness.language.reading.names import UNTIL_USAGE, Words, take_apart, wrong_way_round
from harness.language.reading.partial import PartialReader, texts
from harness.language.reading.wording import on_one_line, written_under
from harness.language.scenario import RobotSpec, Scenario
from harness.language.step import STEPS, TAG, StepFields

UNITS = {
    "rad": ("an angle in radians, {:.1f} degrees", "deg", "degrees"),
    "m": ("a length in metres", "mm", "millimetres"),
    "s": ("a time in seconds", "ms", "milliseconds"),
}
LARGEST = {"rad": 6.283186, "m": 100.0}  # a whole turn, rounded up
"""Larger numbers without a unit are of another one in all likelihood."""
EXPECTED = {"rad": 6.283186, "m": 10.0, "s": 100.0}  # the same in expectations


def models_shape(
    item: Located,
    model: type[SpecModel],
    problems: list[Problem],
    notes: list[Problem] | None = None,
    guessed: set[tuple[str, int, int]] | None = None,
    reader: PartialReader | None = None,
) -> Located:
    """A file's values in the shape of its model.

    Args:
        notes: Gets what is allowed and probably not intended.
        guessed: Gets the places of values whose keys are guesses, whose mistakes may be none.
        reader: Gets the words of what is left out: problems that name one may follow from it.
    """
    return _Shaper(
        problems,
        [] if notes is None else notes,
        set() if guessed is None else guessed,
        PartialReader() if reader is None else reader,
        LARGEST,
    ).model(item, model)


@dataclass
class _Shaper:
    problems: list[Problem]
    notes: list[Problem]
    guessed: set[tuple[str, int, int]]
    reader: PartialReader
    largest: Mapping[str, float]

    def shape(self, item: Located, annotation: Any, metadata: Iterable[Any] = ()) -> Located:
        self._note_unit(item, annotation, metadata)
        annotation = bare(annotation)
        if annotation is StepFields:
            return self.step(item)
        if annotation is ExpectationFields:
            return replace(self, largest=EXPECTED).expectation(item)
        if is_model(annotation) and issubclass(annotation, PredicateFields):
            return self.predicate(item)
        if is_model(annotation):
            return self.model(item, annotation)
        members = branches(annotation)
        if members:
            fitting = [bare(each) for each in members if _fits(item, bare(each))]
            return self.shape(item, fitting[0]) if fitting else item
        arguments = get_args(annotation)
        if get_origin(annotation) is tuple and isinstance(item.value, list):
            kinds = [*arguments[:1]] * len(item.value) if arguments[-1] is ... else arguments
            shaped = [self.shape(*pair) for pair in zip(item.value, kinds, strict=False)]
            return Located(shaped + item.value[len(shaped) :], item.place)
        if get_origin(annotation) is dict and isinstance(item.value, dict):
            entries = {
                key: Entry(entry.key, self.shape(entry.value, arguments[1]))
                for key, entry in item.value.items()
            }
            return Located(entries, item.place)
        return item

    def field(self, item: Located, field: FieldInfo) -> Located:
        return self.shape(item, field.annotation, field.metadata)

    def _note_unit(self, item: Located, annotation: Any, metadata: Iterable[Any]) -> None:
        """Note numbers that are of another unit in all likelihood."""
        number = item.value
        if isinstance(number, bool) or not isinstance(number, int | float):
            return
        units = units_of(annotation, metadata)
        unit = next((each for each in UNITS if each in units), "")
        if abs(number) > self.largest.get(unit, math.inf):
            what, other, name = UNITS[unit]
            message = f"{number:g} is {what.format(math.degrees(number))}"
            self.notes.append(item.place.problem(message, f"write `{number:g} {other}` for {name}"))

    def model(self, item: Located, model: type[SpecModel], **names: str) -> Located:
        """A mapping with the model's keys; `names` holds the words for its messages."""
        item = expanded(item, model)
        if not isinstance(item.value, dict):
            return item
        keys = keys_of(model)
        outside = {*KEYS_BY_VERB} - {*model.keys_inside} if issubclass(model, StepFields) else ()
        inside = [key for key in keys if key not in outside]
        entries: dict[str, Entry] = {}
        for key, entry in item.value.items():
            if key in inside or (key in keys and "verb" in names):
                entries[key] = Entry(entry.key, self.field(entry.value, keys[key]))
                if key not in inside:
                    message = f"`{key}` stands next to `{names['verb']}`, not inside it"
                    hint = f"write it in the column of `{names['verb']}:`"
                    self.problems.append(entry.key.problem(message, hint))
            else:
                near = self._unknown_key(key, item, model, inside, names)
                if near is not None and near not in item.value:  # continue with the valid key
                    entries[near] = self._guessed(key, entry, near, model)
                else:
                    self.reader.words.update(texts(entry.value.plain()))
        return Located(entries, item.place)

    def _unknown_key(
        self,
        key: str,
        item: Located,
        model: type[SpecModel],
        inside: Sequence[str],
        names: Mapping[str, str],
    ) -> str | None:
        """Refuse a key; the valid one that it probably means."""
        place = item.mapping()[key].key
        if issubclass(model, RobotSpec):
            self.reader.missing.add("arms")
        where = names.get("verb") or names.get("word") or ""
        message = f"unknown key `{key}`" + (f" in `{where}`" if where else "")
        near = nearest(key, inside)
        home = "" if near else _place_of(key, {each: keys_of(model)[each] for each in inside})
        known = did_you_mean(key, inside, "keys") if inside else "it has no keys"
        advice = model.unknown_key_hint(key, cast("dict[str, Any]", item.plain()))
        field = keys_of(model).get(near or "")
        nested = "" if field is None else _nested(key, near or "", item.mapping()[key].value, field)
        hint = advice or nested or "; ".join(filter(None, [home, known]))
        self.problems.append(place.problem(message, hint))
        return near

    def _guessed(self, key: str, entry: Entry, near: str, model: type[SpecModel]) -> Entry:
        """A value under the key that was probably intended; its mistakes count for a slip alone."""
        count = len(self.problems)
        shaped = self.field(entry.value, keys_of(model)[near])
        is_near = is_slip(key, near) or key in SYNONYMS.get(near, ())
        if not (is_near and _can_be(entry.value, keys_of(model)[near])):
            del self.problems[count:]
            self.guessed.update(_places(shaped))
        return Entry(entry.key, shaped)

    def step(self, item: Located) -> Located:
        found = take_apart(item, STEPS, KEYS_BY_VERB, "step", "verb", self.problems)
        if found is None:
            return _placeholder(item, TAG, PLACEHOLDER_VERB)
        model = STEPS[found.word]
        content = self.model(_content(found.entry), model, verb=found.word)
        if not isinstance(content.value, dict):
            self._not_content(found, content, model)
            content = Located({}, content.place)
        entries = dict(content.mapping())
        for key, entry in found.siblings.items():
            shaped = self.field(entry.value, keys_of(model)[key])
            self._put(entries, key, Entry(entry.key, shaped))
        return _tagged(TAG, found, entries)

    def expectation(self, item: Located) -> Located:
        words = (*KEYS_BY_PREDICATE, UNTIL)
        found = take_apart(item, EXPECTATIONS, words, "expectation", "predicate", self.problems)
        if found is None:
            return _placeholder(item, CHECK, PLACEHOLDER_WORD)
        until = found.siblings.pop(UNTIL, None)
        known = keys_of(EXPECTATIONS[found.word])
        for field, entry in ((known.get(key), entry) for key, entry in found.siblings.items()):
            if field is not None:
                self._note_unit(entry.value, field.annotation, field.metadata)
        if until is not None and found.word != "always":
            message = f"`until` goes with `always`, not with `{found.word}`"
            self.problems.append(until.key.problem(message, UNTIL_USAGE))
            until = None
        if found.word in TEMPORAL:
            return self._temporal(found, until)
        return self._predicate(found)

    def predicate(self, item: Located) -> Located:
        found = take_apart(
            item, PREDICATES, KEYS_BY_PREDICATE, "expectation", "predicate", self.problems
        )
        if found is None:
            return _placeholder(item, CHECK, PLACEHOLDER_WORD)
        return self._predicate(found)

    def _predicate(self, found: Words) -> Located:
        model = EXPECTATIONS[found.word]
        near = wrong_way_round(found.word, found.entry.value) if found.word in PREDICATES else None
        if near is not None:
            place = found.entry.value.place
            message = f"a temporal word stands before its predicate, not in `{found.word}`"
            self.problems.append(place.problem(message, f"write `{near}`"))
            return _placeholder(found.entry.value, CHECK, PLACEHOLDER_WORD)
        content = self.model(_content(found.entry), model, word=found.word)
        if not isinstance(content.value, dict):
            self._not_content(found, content, model)
            content = Located({}, content.place)
        allowed = keys_of(model)
        entries = dict(content.mapping())
        for key, entry in found.siblings.items():
            if key not in allowed:
                message = f"`{key}` has no meaning next to `{found.word}`"
                self.problems.append(entry.key.problem(message))
            else:
                self._put(entries, key, entry)
        return _tagged(CHECK, found, entries)

    def _temporal(self, found: Words, until: Entry | None) -> Located:
        """`never: {collision: {...}, for: 1 s}`: the words inside belong to `never`."""
        inner = take_apart(
            found.entry.value, PREDICATES, KEYS_BY_PREDICATE, found.word, "predicate", self.problems
        )
        entries = dict(found.siblings)
        if inner is None:
            return _placeholder(found.entry.value, CHECK, PLACEHOLDER_WORD)
        for key, entry in inner.siblings.items():
            self._put(entries, key, entry)
        predicate = self._predicate(Words(inner.word, inner.entry, {}))
        entries["predicate"] = Entry(found.entry.key, predicate)
        if until is None:
            return _tagged(CHECK, found, entries)
        entries[UNTIL] = Entry(until.key, self.predicate(until.value))
        return _tagged(CHECK, Words(UNTIL, found.entry, {}), entries)

    def _not_content(self, found: Words, content: Located, model: type[SpecModel]) -> None:
        message = f"`{found.word}` takes a mapping, not {value_text(content.plain())}"
        outside = KEYS_BY_VERB if issubclass(model, StepFields) else KEYS_BY_PREDICATE
        keys = [key for key in keys_of(model) if key not in outside]
        hint = f"keys: {', '.join(keys)}" if keys else f"write `- {found.word}` alone"
        hint = written_under(model, keys, content.plain()) or hint
        self.problems.append(content.place.problem(message, hint))
        self.guessed.update(_places(Located(None, found.entry.key)))  # nothing is missing there

    def _put(self, entries: dict[str, Entry], key: str, entry: Entry) -> None:
        if key in entries:
            first = f"the first is in line {entries[key].key.line}"
            self.problems.append(entry.key.problem(f"`{key}` is here twice", first))
        else:
            entries[key] = entry


def _nested(key: str, near: str, value: Located, field: FieldInfo) -> str:
    """How to write a value under a key that takes a mapping: `position: [...]` of an object."""
    models = [] if isinstance(value.value, dict) else _models_in(field.annotation)
    inner = nearest(key, keys_of(models[0])) if models else None
    written = on_one_line(value.plain())
    if not inner or not written:
        return ""
    return f"did you mean `{near}`? write `{near}: {{{inner}: {written}}}`"


def _can_be(item: Located, field: FieldInfo) -> bool:
    """Whether a value is no number or text in place of a list, and no list in place of a model."""
    kinds = [bare(each) for each in branches(bare(field.annotation)) or (field.annotation,)]
    if isinstance(item.value, dict):
        return True
    if isinstance(item.value, list):
        return not any(map(is_model, kinds))
    return not any(is_model(kind) or get_origin(kind) in (tuple, list, dict) for kind in kinds)


def _place_of(key: str, siblings: Mapping[str, FieldInfo]) -> str:
    """Where a key can stand instead: inside one of its siblings, or in the file itself."""
    homes = [
        name
        for name, field in siblings.items()
        if any(key in keys_of(model) for model in _models_in(field.annotation))
    ]
    if len(homes) == 1:
        return f"write `{homes[0]}: {{{key}: ...}}`"
    return f"`{key}:` stands in column 1 of the file" if key in keys_of(Scenario) else ""


def _places(item: Located) -> Iterator[tuple[str, int, int]]:
    """The places of a value, and of all that it is made of."""
    place = item.place
    yield place.source.path, place.line, place.column
    for entry in item.mapping().values():
        yield from _places(entry.value)
    for each in item.items():
        yield from _places(each)


def _models_in(annotation: Any) -> list[type[SpecModel]]:
    """The models whose mapping a field may hold."""
    kinds = [bare(each) for each in branches(bare(annotation)) or (bare(annotation),)]
    return [kind for kind in kinds if is_model(kind)]


def expanded(item: Located, model: type[SpecModel]) -> Located:
    """A bare value as the field it is short for; a mapping as it is."""
    if isinstance(item.value, dict):
        items_are_models = model.short_is_list and _list_of_models(model)
        if not items_are_models or model.short in item.value or not item.value:
            return item
    elif not model.short or item.value is None or _is_no_name(item.value, model):
        return item
    if model.short_is_list and not isinstance(item.value, list):
        item = Located([item], item.place)
    return Located({model.short: Entry(item.place, item)}, item.place)


def _is_no_name(value: object, model: type[SpecModel]) -> bool:
    """Whether a bare value cannot be the name that a model's short form takes."""
    if isinstance(value, str) or bare(keys_of(model)[model.short].annotation) is not str:
        return False
    return isinstance(value, list) or bool(written_under(model, keys_of(model), value))


def _list_of_models(model: type[SpecModel]) -> bool:
    """Whether one mapping alone may stand for the list: `add_object: {name: ...}`."""
    kind = get_args(bare(keys_of(model)[model.short].annotation))[0]
    return is_model(bare(kind))


def _fits(item: Located, annotation: Any) -> bool:
    if isinstance(item.value, dict):
        return is_model(annotation) or get_origin(annotation) is dict
    if isinstance(item.value, list):
        return get_origin(annotation) in (tuple, list)
    return False


def _content(entry: Entry) -> Located:
    """The content of a word; nothing is an empty mapping, standing at the word."""
    if entry.value.value is None:
        return Located({}, entry.key)
    return entry.value


def _tagged(tag: str, found: Words, entries: dict[str, Entry]) -> Located:
    place = found.entry.key
    word = Entry(place, Located(found.word, place))
    return Located({tag: word, **entries}, place, found.word)


def _placeholder(item: Located, tag: str, word: str) -> Located:
    """Takes the place of what could not be read, so that indices stay."""
    return _tagged(tag, Words(word, Entry(item.place, item), {}), {})
