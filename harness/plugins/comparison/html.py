"""The page of two runs on one clock, in one file."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from harness.core.printable import printable
from harness.plugins.comparison.alignment import aligned_steps
from harness.plugins.comparison.compare import Change, RunComparison, verdict_pairs
from harness.plugins.comparison.lines import HEADINGS, parting_text
from harness.recording.stored_run import StoredRun
from harness.reporting.html import bundle
from harness.reporting.html.packing import Packer
from harness.reporting.html.story import ordered_steps
from harness.reporting.html.write import Page

FOLDER = Path(__file__).with_name("page")

Pairs = Sequence[Sequence[object]]


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
    parting, verdicts = comparison.first_difference, verdict_pairs(first, second)
    text = "" if parting is None else parting_text(parting)
    moments = [each.time for each in (parting, *comparison.farthest[:1]) if each is not None]
    decisive = (min(moments), max(moments)) if moments else None
    facts = {
        "pairs": _places(
            ordered_steps(first.run),
            ordered_steps(second.run),
            aligned_steps(first.run, second.run),
        ),
        "parting": None if parting is None else {"time": parting.time, "text": text},
        "farthest": [{"time": each.time, "text": each.text} for each in comparison.farthest],
        "isSame": comparison.is_same,
        "warnings": comparison.warnings,
        "verdicts": _places(first.verdicts, second.verdicts, [pair for _, *pair in verdicts]),
        "names": [name for name, *_ in verdicts],
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


def _places(ours: Sequence[object], theirs: Sequence[object], pairs: Pairs) -> list[list[int]]:
    """Pairs as places in the lists of both pages; -1 for what a run does not have."""
    places = [{id(each): place for place, each in enumerate(run)} for run in (ours, theirs)]
    return [[at.get(id(each), -1) for at, each in zip(places, pair, strict=True)] for pair in pairs]


ORDER = ("outcome", "verdict", "scenario", "margin", "findings", "robot", "seed", "version")


def _groups(changes: Sequence[Change]) -> list[dict[str, Any]]:
    order = [*ORDER, *(what for what in HEADINGS if what not in ORDER)]
    ranked = sorted(changes, key=lambda change: order.index(change.what))
    return [
        {"kind": what, "title": HEADINGS[what], "rows": [_row(change) for change in group]}
        for what, group in groupby(ranked, key=lambda change: change.what)
    ]


def _row(change: Change) -> dict[str, str]:
    amount = change.difference
    return {"name": change.name, "before": change.before, "after": change.after, "amount": amount}
