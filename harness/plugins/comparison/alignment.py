"""Which steps of two runs are the same one, by their ids and by what they do."""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import SequenceMatcher

from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.reporting.html.story import ordered_steps

NUMBERED = re.compile(r"steps?[_\[]")  # how ids begin that are places in the file

StepPair = tuple[StepRecord | None, StepRecord | None]


def aligned_steps(one: Run, two: Run) -> list[StepPair]:
    """Steps that are the same in both runs, in their order; None where one run has none.

    Steps with an id from the file match by it, the others by what they do. Between two matches,
    those of one kind match next, as where a goal was changed.
    """
    ours, theirs = ordered_steps(one), ordered_steps(two)
    pairs: list[StepPair] = []
    for same, a, b in _blocks(
        ours, theirs, [[_key(step) for step in each] for each in (ours, theirs)]
    ):
        kinds = [[step.verb for step in each] for each in (a, b)]
        for similar, c, d in [(True, a, b)] if same else _blocks(a, b, kinds):
            if similar:
                pairs += zip(c, d, strict=True)
            else:
                pairs += [*((step, None) for step in c), *((None, step) for step in d)]
    return pairs


def _blocks(
    ours: Sequence[StepRecord], theirs: Sequence[StepRecord], keys: Sequence[Sequence[object]]
) -> list[tuple[bool, Sequence[StepRecord], Sequence[StepRecord]]]:
    """Stretches of both lists, and whether their keys are equal."""
    matcher = SequenceMatcher(None, *keys, autojunk=False)
    return [(kind == "equal", ours[a:b], theirs[c:d]) for kind, a, b, c, d in matcher.get_opcodes()]


def _key(step: StepRecord) -> tuple[str, str]:
    return (step.id, step.verb) if is_named(step) else ("", step.summary)


def is_named(step: StepRecord) -> bool:
    """Whether the file gives it an id; one of its own is its place."""
    return NUMBERED.match(step.id) is None


def names_of(pairs: Sequence[StepPair]) -> tuple[dict[str, str], dict[str, str]]:
    """A name of each step by its id, for both runs; the same for steps that are the same."""
    names: tuple[dict[str, str], dict[str, str]] = ({}, {})
    taken: set[str] = set()
    for pair in pairs:
        step = next(each for each in pair if each is not None)
        base = step.id if is_named(step) else step.summary
        name, count = base, 2
        while name in taken:
            name, count = f"{base} #{count}", count + 1
        taken.add(name)
        for each, side in zip(pair, names, strict=True):
            if each is not None:
                side[each.id] = name
    return names
