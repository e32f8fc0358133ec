"""JUnit XML, as Jenkins, GitLab and GitHub's actions read it.

There is no one schema; what is written here is in all that are in use: `testsuites`, `testsuite`,
`testcase` with `properties`, one of `failure`, `error`, `skipped`, and `system-out`.
"""

from __future__ import annotations

import math
import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import SpooledTemporaryFile
from typing import IO
from xml.sax.saxutils import escape

from harness.core.printable import printable, printable_lines
from harness.recording.run import Outcome
from harness.recording.verdict import Verdict
from harness.reporting.margins import margin_share, worst
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate, rate_text
from harness.reporting.suite.record import SuiteCase, SuiteRecord
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


class JunitWriter:
    """Writes JUnit XML case by case, one `testsuite` for each scenario file; times are wall times.

    What is written so far is in a file without a name. Samples may fail where a success rate is
    required: the rate is a `testcase` of its own, with the `failure` when it is not confirmed.
    """

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


def case_properties(case: SuiteCase) -> list[tuple[str, str]]:
    """Name and value of everything that a later reader needs besides the outcome."""
    result = case.result
    found = [("seed", str(result.seed)), ("digest", result.digest)]
    found.append(("simulated", f"{result.sim_time:.3f} s"))
    found += [("verifies", each) for each in case.verifies]
    found += [(f"value:{path}", str(value)) for path, value in case.values.items()]
    found += [
        (f"margin:{verdict.expectation}", _margin(verdict))
        for verdict in result.verdicts
        if not math.isnan(verdict.margin)
    ]
    if case.nearest is not None:
        found.append(("worst_margin", case.nearest.expectation))
    return found


def sample_properties(cases: Sequence[SuiteCase]) -> list[tuple[str, str]]:
    """Properties of samples together: seed and digest of each, the smallest margins by sample."""
    found = [("verifies", each) for case in cases[:1] for each in case.verifies]
    found += [(f"seed:{case.result.case}", str(case.result.seed)) for case in cases]
    found += [(f"digest:{case.result.case}", case.result.digest) for case in cases]
    least: dict[str, tuple[Verdict, str]] = {}
    for case in cases:
        for verdict in case.result.verdicts:
            if math.isnan(verdict.margin):
                continue
            known = least.setdefault(verdict.expectation, (verdict, case.result.case))
            if margin_share(verdict) < margin_share(known[0]):
                least[verdict.expectation] = (verdict, case.result.case)
    found += [(f"margin:{name}", f"{_margin(each)} ({c})") for name, (each, c) in least.items()]
    nearest = worst([verdict for verdict, _ in least.values()])
    if nearest is not None:
        found.append(("worst_margin", nearest.expectation))
    return found


def _margin(verdict: Verdict) -> str:
    return f"{verdict.margin:.6g} {verdict.unit}".removesuffix(" 1")


def _attachments(result: CaseResult) -> list[str]:
    """Files of the report, in the form that Jenkins and GitLab show as attachments."""
    return [f"{ATTACHMENT}{printable(str(Path(result.page).resolve()))}]]"] if result.page else []
