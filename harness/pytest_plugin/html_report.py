"""What a row of pytest-html shows of a scenario: its page, a picture and the worst margin."""

from __future__ import annotations

import base64
import os
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from harness.core.amounts import stated_amount
from harness.pytest_plugin.session_options import MARGIN
from harness.reporting.notebook import verdict_table
from harness.reporting.suite.failure_picture import deciding_picture
from harness.reporting.suite.record import SuiteCase
from harness.reporting.terminal import failure_place

LISTED_CASES = 3  # of samples, those that failed
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
            page = Path(os.path.relpath(Path(result.page).resolve(), folder)).as_posix()
            extras.append(make.url(f"{page}{failure_place(result)}", name=result.case or "replay"))
        if picture := deciding_picture(result, PICTURE_WIDTH):
            shown = base64.b64encode(picture).decode()
            extras.append(make.image(shown, result.name, "image/webp", "webp"))
        extras.append(make.html(verdict_table(result.verdicts)))
    report.extras = extras  # pyright: ignore[reportAttributeAccessIssue] - pytest-html's own
    setattr(report, MARGIN, _worst(cases))


def _worst(cases: Sequence[SuiteCase]) -> str:
    """The worst margin of some cases, with its expectation."""
    known = [case for case in cases if case.nearest is not None]
    if not known:
        return ""
    nearest = min(known, key=lambda case: case.share).nearest
    assert nearest is not None
    return f"{stated_amount(nearest.margin, nearest.unit)}: {nearest.expectation}"
