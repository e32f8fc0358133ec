"""The page on packages' solvers says what the tests find in them."""

import importlib.util
import re

import pytest

from tests.docs.generated import ROOT
from tests.iktest.arms import EXAMPLES

pytestmark = pytest.mark.ik_packages

PAGE = (EXAMPLES / "PACKAGES.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def packages():
    """The module with the packages' solvers."""
    spec = importlib.util.spec_from_file_location("packages", EXAMPLES / "packages.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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
def test_solvers_that_repeat_break_what_the_page_says(packages, name):
    """Which properties, not how often: near singularities that depends on the processor."""
    report = packages.report_of(name)
    assert {each.name for each in report.properties if each.flawed} == flawed(name)


def test_trac_ik_never_answers_wrongly(packages):
    """What it finds in 5 ms of wall time differs; what it says is right."""
    may = {"answers", "determinism", "continuity"}
    report = packages.report_of("pytracik")
    assert {each.name for each in report.properties if each.flawed} <= may
    assert flawed("pytracik") <= may


def test_the_page_is_linked():
    assert "PACKAGES.md" in (ROOT / "scenarios/ik_test/README.md").read_text(encoding="utf-8")
