"""Problems in files as SARIF 2.1.0 [1], which code scanning services show at their lines.

References:
    [1] OASIS, "Static Analysis Results Interchange Format (SARIF) Version 2.1.0".
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any
from urllib.parse import quote

from harness.core.errors import Problem
from harness.core.versions import library_versions

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
RULES = {
    "invalid-file": "The file cannot be run: a name, a unit or a value is wrong.",
    "step-will-fail": "A goal is out of reach or in collision, which is known without physics.",
}


def sarif_document(invalid: Iterable[Problem], predicted: Iterable[Problem]) -> dict[str, Any]:
    """The document."""
    found = [("invalid-file", each) for each in invalid]
    found += [("step-will-fail", each) for each in predicted]
    rules = [{"id": name, "shortDescription": {"text": text}} for name, text in RULES.items()]
    driver = {"name": "armharness", "version": library_versions()["armharness"], "rules": rules}
    results = [_result(rule, problem) for rule, problem in dict.fromkeys(found)]
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    return {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}


def _result(rule: str, problem: Problem) -> dict[str, Any]:
    place: dict[str, Any] = {"artifactLocation": {"uri": _uri(problem.path)}}
    if problem.line:
        column = {"startColumn": problem.column} if problem.column else {}
        place["region"] = {"startLine": problem.line, **column}
    return {
        "ruleId": rule,
        "ruleIndex": [*RULES].index(rule),
        "level": "error",
        "message": {"text": problem.sentence},
        "locations": [{"physicalLocation": place}],
    }


def _uri(path: str) -> str:
    """A path below the working directory as a relative reference, another one as a file URI."""
    absolute = Path(path).absolute()
    if absolute.is_relative_to(Path.cwd()):
        return quote(absolute.relative_to(Path.cwd()).as_posix())
    return absolute.as_uri()
