"""The rows of a suite's page as plain data, which its script filters, groups and draws."""

from __future__ import annotations

import math
from pathlib import Path, PurePosixPath
from typing import Any

from harness.core.amounts import stated_amount
from harness.core.resources import with_short_names
from harness.reporting.html.packing import Packer
from harness.reporting.margins import used_allowance
from harness.reporting.result import CaseResult
from harness.reporting.sampled import short_value
from harness.reporting.suite.failure_picture import deciding_picture
from harness.reporting.suite.history import History
from harness.reporting.suite.record import SuiteCase, link_from
from harness.reporting.terminal import causes

NO_MARGIN = 9.0  # a share that sorts after every margin, which is 1 at most
MOST_PICTURES = 100  # of cases, failures first; at 4 kB each, the page grows by less than 0.5 MB
PICTURE_WIDTH = 200  # [pixels], twice what is shown, for screens of high density


def row_facts(
    number: int, case: SuiteCase, folder: Path, history: History, packer: Packer
) -> dict[str, Any]:
    """A row of the table of cases.

    Args:
        number: The place of the case in its suite.
        folder: Where the page will stand; links are relative to it.
        packer: Receives the picture of the moment that decided a failure.
    """
    result, nearest, cause = case.result, case.nearest, case.cause
    file = with_short_names(result.file)
    earlier = history.get((result.file, result.case), ())
    used = used_allowance(nearest) if nearest else None
    words = (result.title, result.case, file, *case.tags, *case.verifies)
    return {
        "number": number,
        "name": result.name,
        "file": file,
        "folder": str(PurePosixPath(file).parent),
        "tags": case.tags,
        "outcome": result.outcome,
        "cause": cause.group if cause else "",
        "why": " ".join(cause.text.split()) if cause else "",
        "details": causes(result) if cause else [],
        "case": result.case,
        "again": case.again,
        "options": case.options,
        "expects": len(result.verdicts),
        "expected": sum(step.status == "expected error" for step in result.steps),
        "report": result.report_dir,
        "pages": [
            {"name": Path(page).stem.replace("_", " "), "link": link_from(folder, page)}
            for page in result.further_pages
        ],
        "link": case.address(folder),
        "share": case.share if math.isfinite(case.share) else NO_MARGIN,
        "used": used,
        "margin": stated_amount(nearest.margin, nearest.unit) if nearest else "",
        "expectation": nearest.expectation if nearest else "",
        "holds": nearest is not None and nearest.status == "passed",
        "drawn": ", ".join(f"{path} {short_value(value)}" for path, value in case.values.items()),
        "simulated": result.sim_time,
        "wall": sum(result.wall_times.values()),
        "seed": result.seed,
        "digest": result.digest[:12],
        "words": " ".join([*words, cause.text if cause else ""]).lower(),
        "shares": [*earlier, None if nearest is None else case.share],
        "picture": _picture(result, number, packer),
    }


def _picture(result: CaseResult, number: int, packer: Packer) -> str:
    """The name of the buffer with a picture of what failed, or of the end; empty without one."""
    if result.outcome not in ("failed", "passed") or len(packer.names) >= MOST_PICTURES:
        return ""
    picture = deciding_picture(result, PICTURE_WIDTH)
    return packer.add(f"case.{number}", picture) if picture else ""
