"""The format `github`, and what GitHub's actions show whatever the format is."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from harness.reporting.suite.result_format import ResultFormat

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from harness.core.errors import Problem
    from harness.reporting.result import CaseResult
    from harness.reporting.suite.record import SuiteRecord


class GithubFormat(ResultFormat):
    """Annotations at lines of files, and the summary of the job."""

    name: ClassVar[str] = "github"
    text: ClassVar[str] = "annotations"

    def problems(self, invalid: Sequence[Problem], predicted: Sequence[Problem]) -> str:
        from harness.plugins.ci.github import problem_annotation

        lines = dict.fromkeys(map(problem_annotation, (*invalid, *predicted)))
        return "".join(f"{line}\n" for line in lines)

    def failures(self, results: Iterable[CaseResult]) -> Iterator[str]:
        from harness.plugins.ci.github import error_annotations

        return error_annotations(results)

    def write_summary(self, record: SuiteRecord) -> None:
        from harness.plugins.ci.github import append_summary

        append_summary(record)

    def remarks(self, results: Iterable[CaseResult]) -> Iterator[str]:
        from harness.plugins.ci.github import annotations_for_action

        return annotations_for_action(results)
