"""Problems in files as SARIF 2.1.0 [1], which code scanning services show at their lines.

References:
    [1] OASIS, "Static Analysis Results Interchange Format (SARIF) Version 2.1.0".
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar
from urllib.parse import quote

from harness.reporting.suite.result_format import ResultFormat

if TYPE_CHECKING:
    from collections.abc import Sequence

    from harness.core.errors import Problem

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
RULES = {
    "invalid-file": "The file cannot be run: a name, a unit or a value is wrong.",
    "step-will-fail": "A goal is out of reach or in collision, which is known without physics.",
}


class SarifFormat(ResultFormat):
    """SARIF 2.1.0, which code scanning services read."""

    name: ClassVar[str] = "sarif"
    text: ClassVar[str] = "one document for code scanning, SARIF 2.1.0"
    is_of_runs: ClassVar[bool] = False

    def problems(self, invalid: Sequence[Problem], predicted: Sequence[Problem]) -> str:
        from harness.core.versions import library_versions
        from harness.reporting.json_text import json_text

        found = [("invalid-file", each) for each in invalid]
        found += [("step-will-fail", each) for each in predicted]
        rules = [{"id": name, "shortDescription": {"text": text}} for name, text in RULES.items()]
        driver = {"name": "armharness", "version": library_versions()["armharness"], "rules": rules}
        results = [_result(rule, problem) for rule, problem in dict.fromkeys(found)]
        run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
        return json_text({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]})


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
