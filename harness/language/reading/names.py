"""Split a step or an expectation into its one word, its content and the keys next to it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from harness.core.errors import Problem
from harness.core.registry import plugin_hints
from harness.core.suggestion import did_you_mean, is_slip, nearest
from harness.language.annotations import is_model, keys_of
from harness.language.files.mistakes import value_text
from harness.language.files.source import Entry, Located, Place
from harness.language.language import EXPECTATIONS, PREDICATES, UNTIL

TEMPORAL_WORDS = {
    **dict.fromkeys(("no", "not", "non", "never", "none", "without", "avoid", "free"), "never"),
    **dict.fromkeys(("always", "stays", "stay", "remains", "keep", "keeps", "kept"), "always"),
    **dict.fromkeys(("eventually", "finally", "sometimes", "once"), "eventually"),
}
"""What people write in or after a predicate's name -> the temporal word in front of it."""

ALONE = ("never", "no", "not", "none", "always", "eventually")  # never the name of an object

UNTIL_USAGE = "`- {always: A, until: B}`: A holds until B does"


class Words(NamedTuple):
    """A mapping taken apart: its one word, its content, and the keys next to it."""

    word: str
    entry: Entry
    siblings: dict[str, Entry]


def take_apart(
    item: Located,
    words: Mapping[str, object],
    siblings: tuple[str, ...],
    whole: str,
    kind: str,
    problems: list[Problem],
) -> Words | None:
    """Take a step or an expectation apart; None if it is unclear what it is."""
    if isinstance(item.value, str):
        if item.value in words:
            return Words(item.value, Entry(item.place, Located(None, item.place)), {})
        nothing = Located(None, item.place)
        keyword = _unknown(item.value, item.place, nothing, words, kind, problems)
        return None if keyword is None else Words(keyword, Entry(item.place, nothing), {})
    if not isinstance(item.value, dict):
        message = f"{_a(whole)} is a {kind} with its content, not {value_text(item.plain())}"
        problems.append(item.place.problem(message, _all(words, kind)))
        return None
    keys = [key for key in item.value if key not in siblings]
    found = [key for key in keys if key in words]
    others = [key for key in keys if key not in words]
    rest = {key: entry for key, entry in item.value.items() if key in siblings}
    if not found and others:
        wrong = max(others, key=lambda key: nearest(key, words) is not None)
        keyword = _unknown(wrong, *item.value[wrong], words, kind, problems)
        return None if keyword is None else Words(keyword, item.value[wrong], rest)
    if not found:
        message = f"{_a(whole)} has one {kind}; this one has none"
        hint = UNTIL_USAGE if UNTIL in rest else _all(words, kind)
        problems.append(item.place.problem(message, hint))
        return None
    for extra in found[1:]:
        message = f"{_a(whole)} has one {kind}; this one has `{found[0]}` and `{extra}`"
        hint = f"begin another one: `- {extra}:`"
        problems.append(item.value[extra].key.problem(message, hint))
    for other in others:
        _misplaced(other, item.value[other], found[0], words[found[0]], siblings, problems)
    return Words(found[0], item.value[found[0]], rest)


def _unknown(
    word: str,
    place: Place,
    content: Located,
    words: Mapping[str, object],
    kind: str,
    problems: list[Problem],
) -> str | None:
    """Refuse a word; the valid one that it misspells, to go on as if the file said that."""
    if kind == "verb" and (expected := _expectation_in(word, content)):
        hint = f"write it below `expect:`, under this step or in column 1: `- {expected}: ...`"
        problems.append(place.problem(f"`{word}` is no step", hint))
        return None
    temporal = with_temporal_word(word) if kind == "predicate" else None
    is_flag = isinstance(content.value, bool)
    content = Located(None, content.place) if is_flag else content
    if temporal is not None:
        before, predicate = temporal
        hint = f"write `{before}: {_with_content(predicate, content)}`"
        if before == "never" and PREDICATES[predicate].is_upper_bound:
            hint = f"write `{predicate}`: it holds while the value is at most its limit"
        elif before == "never" and PREDICATES[predicate].opposite:
            other = _with_content(PREDICATES[predicate].opposite, content).strip("{}")
            hint += f", which excludes it at every moment, or `{other}`"
        problems.append(place.problem(f"no predicate is called `{word}`", hint))
        return None if is_flag else predicate
    if word in EXPECTATIONS and kind == "predicate":
        message = f"`{word}` cannot stand inside a temporal word; a predicate can"
    elif word in ("do", "check"):
        message = f"`{word}:` is not written; the {kind} itself is the key"
    else:
        message = f"no {kind} is called `{word}`"
    near = nearest(word, words)
    is_misspelt = near is not None and _is_misspelt(word, near, content, words[near])
    hints = plugin_hints(word, words, kind, is_misspelt=is_misspelt)
    problems.append(place.problem(message, "; ".join(hints)))
    return near if is_misspelt else None


def _expectation_in(word: str, content: Located) -> str:
    """The expectation that a word among the steps is, or has as its content; empty if neither."""
    if word in EXPECTATIONS:
        return word
    inner = [*content.value] if isinstance(content.value, dict) else [content.value]
    is_one = len(inner) == 1 and word in ("assert", "expect", "check", "verify", "require")
    texts = (each for each in inner if is_one and isinstance(each, str))
    return next((each for each in texts if each in EXPECTATIONS), "")


def _is_misspelt(word: str, near: str, content: Located, model: object) -> bool:
    """Whether a word is nearly the same as the nearest one, or has keys of that one alone."""
    if is_slip(word, near):
        return True
    keys = content.value.keys() if isinstance(content.value, dict) else ()
    return bool(keys) and is_model(model) and all(key in keys_of(model) for key in keys)


def with_temporal_word(word: str) -> tuple[str, str] | None:
    """Temporal word and predicate that a joined word means: `no_collision` is never, collision."""
    parts = word.lower().replace("-", "_").replace(" ", "_").split("_")
    for count in range(1, len(parts)):
        for temporal, rest in (
            ("_".join(parts[:count]), parts[count:]),
            ("_".join(parts[-count:]), parts[:-count]),
        ):
            name = "_".join(rest)
            predicate = nearest(name, PREDICATES)
            if temporal in TEMPORAL_WORDS and predicate is not None:
                return TEMPORAL_WORDS[temporal], predicate
    return None


def _with_content(predicate: str, content: Located) -> str:
    """A predicate with its content, as it stands after a temporal word."""
    value = content.plain()
    if value is None:
        model = PREDICATES[predicate]
        field = keys_of(model).get(model.short)
        if field is None or not field.is_required():
            return predicate
        value = (
            [word.upper() for word in ("one", "other")] if model.short == "between" else "OBJECT"
        )
    if isinstance(value, dict):
        return f"{{{predicate}: {{...}}}}"
    text = f"[{', '.join(map(str, value))}]" if isinstance(value, list) else str(value)
    return f"{{{predicate}: {text}}}"


def wrong_way_round(word: str, content: Located) -> str | None:
    """What `collision: never`, or `collision: false`, stands for; None for other content."""
    stated = "no" if content.value is False else content.value
    if not isinstance(stated, str) or stated.lower() not in ALONE:
        return None
    return f"{TEMPORAL_WORDS[stated.lower()]}: {_with_content(word, Located(None, content.place))}"


def _misplaced(
    key: str,
    entry: Entry,
    word: str,
    model: object,
    siblings: tuple[str, ...],
    problems: list[Problem],
) -> None:
    if is_model(model) and key in keys_of(model):
        message = f"`{key}` stands inside `{word}`, not next to it"
        hint = f"write it below `{word}:`, further right"
    else:
        message = f"unknown key `{key}` next to `{word}`"
        hint = did_you_mean(key, siblings, "words that may stand there")
    problems.append(entry.key.problem(message, hint))


def _a(whole: str) -> str:
    if whole in ("step", "expectation"):
        return f"a{'n' if whole[0] == 'e' else ''} {whole}"
    return f"`{whole}`"


def _all(words: Mapping[str, object], kind: str) -> str:
    return f"{kind}s: {', '.join(words)}"
