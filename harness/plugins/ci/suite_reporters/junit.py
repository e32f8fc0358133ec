"""JUnit XML, as Jenkins, GitLab and GitHub's actions read it.

There is no one schema; what is written here is in all that are in use: `testsuites`, `testsuite`,
`testcase` with `properties`, one of `failure`, `error`, `skipped`, and `system-out`.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import SpooledTemporaryFile
from typing import IO, ClassVar
from xml.sax.saxutils import escape

from harness.core.printable import printable, printable_lines
from harness.recording.run import Outcome
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate, rate_text
from harness.reporting.suite.properties import case_properties
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.suite_reporter import SuiteReporter
from harness.reporting.terminal import causes, report_link

NAME = "armharness"
ATTACHMENT = "[[ATTACHMENT|"  # how a file's name begins in `system-out`, for Jenkins and GitLab
MOST_IN_MEMORY = 1_000_000  # bytes of a `testsuite`, until the document is written

MARKUP = re.compile('[&<>"]')
SAMPLE = re.compile(r"(?:^|-)sample\d+$")  # what the name of a sample adds to its group's


@dataclass
class _Counts:
    """What a `testsuite` counts."""

    tests: int = 0
    failures: int = 0
    errors: int = 0
    seconds: float = 0.0

    def add(self, outcome: Outcome, seconds: float = 0.0) -> None:
        self.tests += 1
        self.failures += outcome == "failed"
        self.errors += outcome in ("error", "invalid")
        self.seconds += seconds

    @property
    def attributes(self) -> str:
        return (
            f'tests="{self.tests}" failures="{self.failures}" errors="{self.errors}" skipped="0"'
            f' time="{self.seconds:.3f}"'
        )


class JunitReporter(SuiteReporter):
    """JUnit XML, one `testsuite` for each scenario file; times are wall times.

    What is written so far is in a file without a name. Samples may fail where a success rate is
    required: the rate is a `testcase` of its own, with the `failure` when it is not confirmed.
    """

    name: ClassVar[str] = "junit"
    file: ClassVar[str] = "junit.xml"

    def __init__(self, record: SuiteRecord) -> None:
        """Begin a document."""
        self._rates: dict[str, list[SampledRate]] = {}
        for rate in record.rates:
            self._rates.setdefault(rate.file, []).append(rate)
        self._suites: dict[str, tuple[_Counts, IO[bytes]]] = {}
        self._counts = _Counts()

    def add(self, case: SuiteCase) -> None:
        """Write the next case."""
        result = case.result
        if result.file not in self._suites:
            self._suites[result.file] = _Counts(), _spooled()
        counts, text = self._suites[result.file]
        may_fail = _may_fail(result, self._rates.get(result.file, ()))
        for each in (counts, self._counts):
            each.add("passed" if may_fail else result.outcome, _seconds(result))
        text.write(_case(case, may_fail=may_fail))

    def write(self, file: IO[bytes]) -> None:
        """Write the document, and let go of what was kept of it."""
        for name, (counts, text) in self._suites.items():
            for rate in self._rates.get(name, ()):
                text.write(_rate(rate))
                for each in (counts, self._counts):
                    each.add(rate.outcome)
        head = f'<testsuites name="{NAME}" {self._counts.attributes}>'
        file.write(f'<?xml version="1.0" encoding="UTF-8"?>\n{head}\n'.encode())
        for name, (counts, text) in self._suites.items():
            opening = f'<testsuite name="{_escaped(name)}" {counts.attributes}>\n'
            file.write(opening.encode())
            text.seek(0)
            shutil.copyfileobj(text, file)
            text.close()
            file.write(b"</testsuite>\n")
        file.write(b"</testsuites>\n")


def _spooled() -> IO[bytes]:
    return SpooledTemporaryFile(MOST_IN_MEMORY)


def _tag(name: str, attributes: Mapping[str, str], inner: str | None = None) -> str:
    """An element; `inner` is XML."""
    listed = "".join([f' {key}="{_escaped(value)}"' for key, value in attributes.items()])
    return f"<{name}{listed} />" if inner is None else f"<{name}{listed}>{inner}</{name}>"


def _escaped(text: str) -> str:
    """Text in one line as XML, in an attribute too."""
    return _xml(printable(text))


def _xml(text: str) -> str:
    """Printable text as XML."""
    return escape(text, {'"': "&quot;"}) if MARKUP.search(text) else text


def _may_fail(result: CaseResult, rates: Sequence[SampledRate]) -> bool:
    """Whether a case failed as one of samples, which are judged by their success rate."""
    if result.outcome != "failed" or not rates or not SAMPLE.search(result.case):
        return False
    return SAMPLE.sub("", result.case) in {rate.group for rate in rates}


def _testcase(file: str, name: str, seconds: float, parts: Iterable[str]) -> bytes:
    attributes = {"name": name, "classname": _class(file), "file": file, "time": f"{seconds:.3f}"}
    inner = "".join([f"{part}\n" for part in parts])
    text = _tag("testcase", attributes, f"\n{inner}")
    return f"{text}\n".encode()


@cache
def _class(file: str) -> str:
    """A file's path without its suffix, with dots."""
    return ".".join(Path(file).with_suffix("").with_suffix("").parts).strip("./")


def _properties(found: Iterable[tuple[str, str]]) -> str:
    lines = [f'<property name="{_escaped(k)}" value="{_escaped(v)}" />' for k, v in found]
    return _tag("properties", {}, "\n".join(lines))


def _rate(sampled: SampledRate) -> bytes:
    rate, name = sampled.rate, f"success rate {sampled.group}".strip()
    parts = [_properties([("passed", str(rate.passed)), ("samples", str(rate.total))])]
    if sampled.outcome != "passed":
        text = _escaped(rate_text(f"{sampled.file} {sampled.group}".strip(), rate))
        parts.append(f'<failure message="{text}" type="success rate">{text}</failure>')
    return _testcase(sampled.file, name, 0.0, parts)


def _case(case: SuiteCase, *, may_fail: bool) -> bytes:
    result = case.result
    name = f"{result.title}[{result.case}]" if result.case else result.title
    parts, lines = [_properties(case_properties(case))], list[str]()
    if case.cause is not None and may_fail:
        lines += ["failed, as samples may; their rate is judged", *causes(result)]
    elif case.cause is not None:
        kind = "failure" if result.outcome == "failed" else "error"
        why = {"message": case.cause.text, "type": case.cause.group}
        parts.append(_tag(kind, why, _xml("\n".join(causes(result)))))
    if result.report_dir:
        lines.append(f"report: {report_link(result)}")
    if lines:
        notes = printable_lines("\n".join(lines)).replace(ATTACHMENT, f"[ {ATTACHMENT[1:]}")
        text = "\n".join([notes, *_attachments(result)])
        parts.append(_tag("system-out", {}, _xml(text)))
    return _testcase(result.file, name, _seconds(result), parts)


def _seconds(result: CaseResult) -> float:
    return sum(result.wall_times.values())


def _attachments(result: CaseResult) -> list[str]:
    """Files of the report, in the form that Jenkins and GitLab show as attachments."""
    return [f"{ATTACHMENT}{printable(str(Path(result.page).resolve()))}]]"] if result.page else []
