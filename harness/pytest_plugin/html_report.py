"""What pytest-html shows of scenarios: rows with page, picture and margin, and the causes first."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from markupsafe import Markup

from harness.core.amounts import stated_amount
from harness.pytest_plugin.session_options import MARGIN
from harness.reporting.html import bundle
from harness.reporting.notebook import verdict_table
from harness.reporting.suite.failure_picture import deciding_picture
from harness.reporting.suite.record import SuiteCase, link_from

LISTED_CASES = 3  # of samples, those that failed
FOLDER = Path(__file__).with_name("page")
PICTURE_WIDTH = 480  # [pixels]


def add_to_html(
    report: pytest.TestReport, config: pytest.Config, cases: Sequence[SuiteCase]
) -> None:
    """Add links, pictures and verdicts of cases to the row of a test, with pytest-html."""
    target = config.getoption("htmlpath", default=None)
    if not target:
        return
    make: Any = import_module("pytest_html.extras")
    if len(cases) > 1:
        cases = [each for each in cases if each.result.outcome != "passed"][:LISTED_CASES]
    extras: list[Any] = list(getattr(report, "extras", []))
    folder = Path(target).resolve().parent
    for case in cases:
        result = case.result
        if result.page:
            extras.append(make.url(case.address(folder), name=result.case or "replay"))
        if picture := deciding_picture(result, PICTURE_WIDTH):
            shown = base64.b64encode(picture).decode()
            extras.append(make.image(shown, result.name, "image/webp", "webp"))
        extras.append(make.html(verdict_table(result.verdicts)))
    report.extras = extras  # pyright: ignore[reportAttributeAccessIssue] - pytest-html's own
    setattr(report, MARGIN, _worst(cases))


def head(cases: Sequence[SuiteCase], folder: Path, page: Path) -> str:
    """The outcome of a session's scenarios, each cause, and a style in which they can be read.

    Args:
        folder: Where the report of pytest-html will stand.
        page: The page of the suite, which is linked where it exists.
    """
    template = bundle.templates(FOLDER).get_template("head.html")
    style = Markup(bundle.theme() + (FOLDER / "pytest_html.css").read_text(encoding="utf-8"))
    rows = [(each, each.address(folder)) for each in cases]
    suite = link_from(folder, str(page)) if len(cases) > 1 and page.is_file() else ""
    return template.render(style=style, cases=rows, page=suite)


def _worst(cases: Sequence[SuiteCase]) -> str:
    """The worst margin of some cases, with its expectation."""
    known = [(case.share, case.nearest) for case in cases if case.nearest is not None]
    if not known:
        return ""
    _, nearest = min(known, key=lambda each: each[0])
    return f"{stated_amount(nearest.margin, nearest.unit)}: {nearest.expectation}"
