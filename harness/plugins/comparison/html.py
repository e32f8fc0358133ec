"""The page of two runs on one clock, in one file."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from harness.core.printable import printable
from harness.plugins.comparison.alignment import aligned_steps, names_of
from harness.plugins.comparison.compare import Change, RunComparison
from harness.plugins.comparison.lines import HEADINGS, parting_text
from harness.recording.stored_run import StoredRun
from harness.reporting.html import bundle
from harness.reporting.html.packing import Packer
from harness.reporting.html.story import ordered_steps
from harness.reporting.html.write import Page

FOLDER = Path(__file__).with_name("page")


def comparison_page(
    first: StoredRun, second: StoredRun, comparison: RunComparison, names: tuple[str, str]
) -> str:
    """The text of the page.

    Args:
        first: The run that the other one is compared with.
        second: The run that is compared with it.
        comparison: What differs between both of them.
        names: What the page calls the runs.
    """
    groups = _groups(comparison.changes)
    parting = comparison.first_difference
    text = "" if parting is None else parting_text(parting)
    moments = [each.time for each in (parting, *comparison.farthest[:1]) if each is not None]
    decisive = (min(moments), max(moments)) if moments else None
    facts = {
        "pairs": _indices(first, second, comparison.changes),
        "parting": None if parting is None else {"time": parting.time, "text": text},
        "farthest": [{"time": each.time, "text": each.text} for each in comparison.farthest],
        "opens": next((each.time for each in (*comparison.farthest, parting) if each), 0.0),
        "warnings": comparison.warnings,
        "groups": groups,
    }
    page = bundle.rendered(
        FOLDER / "compare.html",
        script=bundle.script(FOLDER / "compare.js"),
        style=bundle.style() + (FOLDER / "compare.css").read_text(encoding="utf-8"),
        runs=(first, second),
        title=first.run.scenario,
        names=[printable(name) for name in names],
        outcome="same" if comparison.is_same else "different",
        tone="good" if comparison.is_same else "open",
        parting=text,
        groups=groups,
        facts=Packer().text(facts),
        first=Page(first.run, first.verdicts).data(first, decisive),
        second=Page(second.run, second.verdicts).data(second, decisive),
    )
    return page.encode(errors="replace").decode()  # names of files may have half characters


def distinct_parts(one: Path, two: Path) -> tuple[str, str]:
    """Two folders by the parts of their paths that differ; the last part of equal ones."""
    parts = [list(folder.resolve().parts) for folder in (one, two)]
    if parts[0] == parts[1]:
        return one.name, two.name
    while min(map(len, parts)) > 1 and parts[0][0] == parts[1][0]:
        parts = [each[1:] for each in parts]
    while min(map(len, parts)) > 1 and parts[0][-1] == parts[1][-1]:
        parts = [each[:-1] for each in parts]
    first, second = ("/".join(each) for each in parts)
    return first, second


OF_STEPS = ("step", "trajectory", "duration")


def _indices(
    first: StoredRun, second: StoredRun, changes: Sequence[Change]
) -> list[dict[str, int | bool | None]]:
    """Places of aligned steps in the lists of both pages, and whether they differ."""
    pairs = aligned_steps(first.run, second.run)
    names = names_of(pairs)
    changed = {change.name for change in changes if change.what in OF_STEPS}
    places = [
        {id(step): index for index, step in enumerate(ordered_steps(each.run))}
        for each in (first, second)
    ]
    return [
        {
            "first": places[0].get(id(one)),
            "second": places[1].get(id(two)),
            "differs": one is None or two is None or names[0][one.id] in changed,
        }
        for one, two in pairs
    ]


ORDER = ("outcome", "verdict", "scenario", "margin", "findings", "robot", "seed", "version")


def _groups(changes: Sequence[Change]) -> list[dict[str, Any]]:
    order = [*ORDER, *(what for what in HEADINGS if what not in ORDER)]
    ranked = sorted(changes, key=lambda change: order.index(change.what))
    return [
        {"title": HEADINGS[what], "rows": [_row(change) for change in group]}
        for what, group in groupby(ranked, key=lambda change: change.what)
    ]


def _row(change: Change) -> dict[str, str]:
    amount = change.difference
    return {"name": change.name, "before": change.before, "after": change.after, "amount": amount}
