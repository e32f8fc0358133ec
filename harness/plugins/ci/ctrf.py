"""Results in the Common Test Report Format, CTRF [1], with the margins of each test.

References:
    [1] ctrf-io, "CTRF specification", version 1.0.
"""

from __future__ import annotations

import math
import os
import time
from collections import Counter
from pathlib import Path
from typing import Any

from harness import __version__
from harness.plugins.ci.results import SavedSuite
from harness.reporting.json_text import json_text
from harness.reporting.suite.failure_picture import picture_of
from harness.reporting.suite.record import SuiteCase
from harness.reporting.terminal import causes

STATUSES = ("passed", "failed", "skipped", "pending", "other")
STATUS = {"passed": "passed", "failed": "failed", "invalid": "failed", "error": "failed"}


def ctrf_text(suite: SavedSuite, folder: Path) -> str:
    """The document.

    Args:
        suite: The results of a suite.
        folder: The folder of the document, from which paths of attachments start.
    """
    tests = [_test(case, folder) for case in suite.cases]
    for test, case in zip(tests, suite.cases, strict=True):
        if suite.may_fail(case):
            test["status"] = "other"  # neither passed nor a failure of the suite
    counts = Counter(test["status"] for test in tests)
    stop = time.time_ns() // 1_000_000
    duration = sum(test["duration"] for test in tests)
    return json_text({
        "reportFormat": "CTRF",
        "specVersion": "1.0.0",
        "generatedBy": f"armharness {__version__}",
        "results": {
            "tool": {"name": "armharness", "version": __version__},
            "summary": {
                "tests": len(tests),
                **{name: counts[name] for name in STATUSES},
                "suites": len({case.result.file for case in suite.cases}),
                "start": stop - duration,
                "stop": stop,
            },
            "tests": tests,
        },
    })  # fmt: skip


def _test(case: SuiteCase, folder: Path) -> dict[str, Any]:
    result, cause = case.result, case.cause
    test: dict[str, Any] = {
        "name": result.name,
        "status": STATUS[result.outcome],
        "rawStatus": result.outcome,
        "duration": round(1000 * sum(result.wall_times.values())),
        "suite": [result.file],
        "filePath": result.file,
        "tags": [*case.tags],
        "type": "simulation",
        "extra": {
            "case": result.case,
            "seed": result.seed,
            "digest": result.digest,
            "simulated": result.sim_time,
            "verifies": [*case.verifies],
            "margins": [
                {
                    "expectation": verdict.expectation,
                    "step": verdict.step,
                    "margin": verdict.margin,
                    "unit": verdict.unit,
                    "line": verdict.line,
                }
                for verdict in result.verdicts
                if math.isfinite(verdict.margin)
            ],
        },
    }
    if cause is not None:
        test |= {"message": cause.text, "trace": "\n".join(causes(result))}
        test |= {"line": cause.line} if cause.line else {}
    picture = picture_of(case)
    files = [("report", "text/html", result.page), ("picture", "image/jpeg", picture)]
    test["attachments"] = [
        {"name": name, "contentType": kind, "path": Path(os.path.relpath(path, folder)).as_posix()}
        for name, kind, path in files
        if path
    ]
    return test
