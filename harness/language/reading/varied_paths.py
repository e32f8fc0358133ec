"""Values that vary by case: each path must lead into the file, and what is drawn must fit there."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence, Set

from pydantic import ValidationError

from harness.core.errors import Problem
from harness.core.quantity import split_quantity
from harness.core.untrusted_json import parse_json
from harness.language.files.mistakes import value_text
from harness.language.files.source import Entry, Located, located, walk
from harness.language.reading.case_keys import case_entries
from harness.language.reading.overrides import Override, apply_overrides
from harness.language.reading.params import PARAMS, REFERENCE, parameters
from harness.language.variation import VARIATION_KEYS, Distribution

MOST_ROUNDS = 100  # sets of values that are tried of a file, so many choices of one value at most
Judge = Callable[[Located], Sequence[Problem]]  # all mistakes of a scenario's values


def check_variation(
    root: Located, given: Mapping[str, str], judge: Judge, problems: list[Problem]
) -> None:
    """See that every varied value is one of the file and fits there; adds to `problems`.

    Args:
        root: The file, with the values of its case.
        given: Paths that the case itself sets; their values are judged with the file.
        judge: Finds the mistakes of a file.
        problems: Gets the mistakes, each at its line of `parametrize` or `randomize`.
    """
    drawn: dict[str, list[Override]] = {}
    _, decisive = case_entries(root, [])
    problems += _set_twice(root)
    for paths, is_random in ((_parametrized(root), False), (_randomized(root), True)):
        for path, entry in paths:
            if path.partition(".")[0] in VARIATION_KEYS:
                problems.append(entry.key.problem(f"`{path}` itself cannot be varied"))
            elif why := _why_constant(root, path, decisive):
                problems.append(entry.key.problem(f"`{path}` cannot be varied: {why}"))
            elif path not in given:
                wrong: list[Problem] = []
                apply_overrides(root, [Override(path, Located(None, entry.key), entry.key)], wrong)
                problems += wrong
                is_known = any(problem.line == entry.value.place.line for problem in problems)
                if is_random and not wrong and not is_known:
                    drawn[path] = _corners(path, entry)
    _check_values(root, {path: values for path, values in drawn.items() if values}, judge, problems)


def _set_twice(root: Located) -> Iterator[Problem]:
    """Draws of what the cases of `parametrize` set, of which one would be overwritten."""
    params = parameters(root)

    def whole(path: str) -> str:
        return f"{PARAMS}.{path}" if path.partition(".")[0] in params else path

    cases = {f"{whole(path)}." for path, _ in _parametrized(root)}
    for path, entry in _randomized(root):
        here = f"{whole(path)}."
        if any(each.startswith(here) for each in cases):
            message = f"`{path}` is set by the cases of `parametrize`"
            yield entry.key.problem(message, "leave it out of one of them")


def unread_parameters(root: Located) -> list[Problem]:
    """Notes of varied parameters that the file reads nowhere, each at its line."""
    params = parameters(root)
    texts = [item.value for _, item in walk(root) if isinstance(item.value, str)]
    read = {each["name"] for text in texts for each in REFERENCE.finditer(text)}
    found: dict[str, Problem] = {}
    for path, entry in (*_parametrized(root), *_randomized(root)):
        name = path.removeprefix(f"{PARAMS}.").partition(".")[0]
        if name in params and name not in read:
            message = f"nothing reads the parameter `{name}`, so that its values change nothing"
            hint = f"write `${{{name}}}` where they belong"
            found.setdefault(name, entry.key.problem(message, hint))
    return list(found.values())


def _why_constant(root: Located, path: str, decisive: Set[str]) -> str:
    """Why a path has one value in all cases, which `decisive` parameters make; else empty."""
    first, *rest = path.split(".")
    if path == "seed" and {"samples", "randomize"} & root.mapping().keys():
        return "each sample has a seed of its own, which follows from the file's"
    if path == PARAMS and decisive:
        return (
            f"the cases follow from `${{{min(decisive)}}}`, which must be the same in all of them"
        )
    params = parameters(root)
    name = rest[0] if first == PARAMS and rest else first
    if name in decisive and (first == PARAMS or first in params):
        return f"the cases follow from `${{{name}}}`, which must be the same in all of them"
    return ""


def _corners(path: str, entry: Entry) -> list[Override]:
    """The ends of what may be drawn, or every choice; nothing of what is no distribution."""
    kind = entry.value.mapping()
    if _distribution(entry) is None:
        return []
    if "normal" in kind:
        parts = kind["normal"].value.mapping()
        values = [parts[key].value for key in ("mean", "low", "high") if key in parts]
    else:
        values = next(iter(kind.values())).value.items()[:MOST_ROUNDS]
    return [Override(path, value, entry.key) for value in values]


def _distribution(entry: Entry) -> Distribution | None:
    try:
        return Distribution.model_validate(entry.value.plain())
    except ValidationError:
        return None


def rounds(drawn: Mapping[str, Sequence[Override]]) -> list[list[Override]]:
    """Sets of values, one for each path, in which every value stands once at least."""
    count = max(map(len, drawn.values()), default=0)
    return [[each[index % len(each)] for each in drawn.values()] for index in range(count)]


def values_of_case(root: Located, given: Mapping[str, str]) -> dict[str, Override]:
    """Values of a case that the file itself gives, so that mistakes are reported there.

    Args:
        given: Dotted path -> value as YAML.
    """
    found: dict[str, Override] = {}
    for path, entry in _parametrized(root):
        if path not in given or path in found:
            continue
        for value in (*entry.value.items(), entry.value):
            if as_json(value.plain()) == given[path]:
                found[path] = Override(path, value, entry.key)
                break
    for path, entry in _randomized(root):
        value = _drawn(entry, given[path]) if path in given else None
        if value is not None:
            found[path] = Override(path, value, entry.key)
    return found


def choices(root: Located) -> list[list[Override]]:
    """Sets of random choices among words, which may be names of the robot's and the world's."""
    return rounds(
        {
            path: corners
            for path, entry in _randomized(root)
            if "choice" in entry.value.mapping()
            and (corners := _corners(path, entry))
            and any(isinstance(each.value.value, str) for each in corners)
        }
    )


def _drawn(entry: Entry, text: str) -> Located | None:
    """A case's random value, standing where the file says what it is drawn from."""
    distribution = _distribution(entry)
    try:
        value = parse_json(text)
    except ValueError:
        return None
    if distribution is None:
        return None
    if distribution.choice is not None:
        items = entry.value.mapping()["choice"].value.items()
        return next((item for item in items if as_json(item.plain()) == text), None)
    ends = distribution.uniform
    if ends is None and distribution.normal is not None:
        ends = (distribution.normal.low, distribution.normal.high)
    try:
        number, _ = split_quantity(value)
        low, high = (number if each is None else split_quantity(each)[0] for each in ends or ())
    except ValueError:
        return None
    return located(value, entry.value.place) if low <= number <= high else None


def _check_values(
    root: Located, drawn: Mapping[str, list[Override]], judge: Judge, problems: list[Problem]
) -> None:
    sets = rounds(drawn)
    known = {_identity(problem) for problem in judge(root)} if sets else set[object]()

    def new_problems(values: list[Override]) -> list[Problem]:
        unused: list[Problem] = []
        found = judge(apply_overrides(root, values, unused))
        return [problem for problem in found if _identity(problem) not in known]

    if not any(map(new_problems, sets)):
        return
    alone = [
        _problem_of(values, list(map(new_problems, ([each] for each in values))))
        for values in drawn.values()
    ]
    found = [problem for problem in alone if problem is not None]
    if not found:  # the values fit alone, but not together
        values = next(values for values in sets if new_problems(values))
        found = [_of_value(values[0], new_problems(values)[0])]
    problems += found


def _problem_of(values: Sequence[Override], found: Sequence[list[Problem]]) -> Problem | None:
    """The problem of a path, at the path where every value has it."""
    first = next(
        ((value, each[0]) for value, each in zip(values, found, strict=True) if each), None
    )
    if first is None:
        return None
    if len(values) > 1 and len({each[0].message if each else "" for each in found}) == 1:
        message = f"`{values[0].path}` cannot vary: {first[1].message}"
        return values[0].place.problem(message, first[1].hint)
    return _of_value(*first)


def _of_value(drawn: Override, problem: Problem) -> Problem:
    """A problem that a drawn value causes, reported where the value stands."""
    value = value_text(drawn.value.plain())
    message = f"`{drawn.path}` can be drawn as {value}: {problem.message}"
    return drawn.value.place.problem(message, problem.hint)


def as_json(value: object) -> str:
    """A value as overrides of a case have it: JSON, which is YAML as well."""
    return json.dumps(value, ensure_ascii=False)


def _identity(problem: Problem) -> object:
    return problem.path, problem.line, problem.column, problem.message


def _parametrized(root: Located) -> Iterator[tuple[str, Entry]]:
    """Path and entry of every line of a grid, or of every named case."""
    entry = root.mapping().get("parametrize")
    if entry is None:
        return
    yield from entry.value.mapping().items()
    for case in entry.value.items():
        for path, item in case.mapping().items():
            if path != "id":
                yield path, item


def _randomized(root: Located) -> Iterator[tuple[str, Entry]]:
    entry = root.mapping().get("randomize")
    if entry is not None:
        yield from entry.value.mapping().items()
