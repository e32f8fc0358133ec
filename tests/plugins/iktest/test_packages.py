"""The page on packages' solvers says what the tests find in them."""

import re

import pytest

from docs import ROOT
from docs.generators.ik_packages import report_of

pytestmark = pytest.mark.needs_ik_packages

PAGE = (ROOT / "docs/reference/ik_packages.md").read_text(encoding="utf-8")


def column(name):
    """Cells of the page's table for one solver, by property."""
    rows = [[cell.strip() for cell in row.strip("|").split("|")]
            for row in re.findall(r"(?m)^\|.*\|$", PAGE)]  # fmt: skip
    place = next(i for i, title in enumerate(rows[0]) if title.startswith(f"{name} "))
    return {row[0]: row[place] for row in rows[2:] if "time" not in row[0]}


def flawed(name):
    """Properties that the page says are broken."""
    return {key for key, cell in column(name).items() if "**" in cell}


@pytest.mark.parametrize("name", ["eaik", "ikpy", "ikpy_checked"])
def test_solvers_that_repeat_break_what_the_page_says(name):
    """Which properties, not how often: near singularities that depends on the processor."""
    report = report_of(name)
    assert {each.name for each in report.properties if each.flawed} == flawed(name)


def test_trac_ik_never_answers_wrongly():
    """What it finds in 5 ms of wall time differs; what it says is right."""
    may = {"answers", "determinism", "continuity"}
    report = report_of("pytracik")
    assert {each.name for each in report.properties if each.flawed} <= may
    assert flawed("pytracik") <= may
