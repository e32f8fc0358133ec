"""JUnit XML, as Jenkins, GitLab and GitHub's actions read it.

There is no one schema; what is written here is in all that are in use: `testsuites`, `testsuite`,
`testcase` with `properties`, one of `failure`, `error`, `skipped`, and `system-out`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

from harness.core.printable import printable, printable_lines
from harness.recording.run import Verdict
from harness.reporting.margins import margin_share, worst
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate, rate_text
from harness.reporting.suite.cause import cause_of
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.terminal import causes, report_link

NAME = "armharness"
ATTACHMENT = "[[ATTACHMENT|"
"""How a file's name begins in `system-out`, for Jenkins and GitLab."""

SAMPLE = re.compile(r"(?:^|-)sample\d+$")
"""What the name of a sample adds to its group's."""


def junit_xml(record: SuiteRecord) -> str:
    """A document with one `testsuite` a scenario file; times are of the wall clock.

    Samples may fail where a success rate is required: the rate is a `testcase` of its own, with
    the `failure` when it is not confirmed.
    """
    suites = ET.Element("testsuites", name=NAME)
    files: dict[str, list[SuiteCase]] = {}
    for case in record.cases:
        files.setdefault(case.result.file, []).append(case)
    for file, cases in files.items():
        rates = [each for each in record.rates if each.file == file]
        counts = _counts(cases, rates)
        suite = ET.SubElement(suites, "testsuite", {"name": printable(file), **counts})
        for case in cases:
            _add_case(suite, case, rates)
        for rate in rates:
            _add_rate(suite, rate)
    for name, count in _counts(record.cases, record.rates).items():
        suites.set(name, count)
    ET.indent(suites)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(suites, encoding="unicode")}\n'


def _counts(cases: Sequence[SuiteCase], rates: Sequence[SampledRate]) -> dict[str, str]:
    outcomes = [case.result.outcome for case in cases if not _may_fail(case.result, rates)]
    outcomes += [rate.outcome for rate in rates]
    time = sum(_seconds(case.result) for case in cases)
    return {
        "tests": str(len(cases) + len(rates)),
        "failures": str(outcomes.count("failed")),
        "errors": str(outcomes.count("error") + outcomes.count("invalid")),
        "skipped": "0",
        "time": f"{time:.3f}",
    }


def _may_fail(result: CaseResult, rates: Sequence[SampledRate]) -> bool:
    """Whether a case failed as one of samples, which are judged by their success rate."""
    return result.outcome == "failed" and any(
        result.file == rate.file
        and SAMPLE.sub("", result.case) == rate.group
        and SAMPLE.search(result.case)
        for rate in rates
    )


def _element(suite: ET.Element, file: str, name: str, seconds: float) -> ET.Element:
    place = ".".join(Path(file).with_suffix("").with_suffix("").parts).strip("./")
    said = {"name": name, "classname": place, "file": file, "time": f"{seconds:.3f}"}
    return ET.SubElement(suite, "testcase", {key: printable(each) for key, each in said.items()})


def _add_rate(suite: ET.Element, sampled: SampledRate) -> None:
    rate, name = sampled.rate, f"success rate {sampled.group}".strip()
    element = _element(suite, sampled.file, name, 0.0)
    properties = ET.SubElement(element, "properties")
    for key, value in (("passed", rate.passed), ("samples", rate.total)):
        ET.SubElement(properties, "property", name=key, value=str(value))
    if sampled.outcome != "passed":
        said = printable(rate_text(f"{sampled.file} {sampled.group}".strip(), rate))
        ET.SubElement(element, "failure", message=said, type="success rate").text = said


def _add_case(suite: ET.Element, case: SuiteCase, rates: Sequence[SampledRate]) -> None:
    result = case.result
    name = f"{result.title}[{result.case}]" if result.case else result.title
    element = _element(suite, result.file, name, _seconds(result))
    properties = ET.SubElement(element, "properties")
    for key, value in case_properties(case):
        ET.SubElement(properties, "property", name=printable(key), value=printable(value))
    cause, lines = cause_of(result), list[str]()
    if cause is not None and _may_fail(result, rates):
        lines += ["failed, as samples may; their rate is judged", *causes(result)]
    elif cause is not None:
        kind = "failure" if result.outcome == "failed" else "error"
        group, said = printable(cause.group), printable(cause.said)
        ET.SubElement(element, kind, message=said, type=group).text = "\n".join(causes(result))
    if result.report_dir:
        lines.append(f"report: {report_link(result)}")
    if lines:
        said = printable_lines("\n".join(lines)).replace(ATTACHMENT, f"[ {ATTACHMENT[1:]}")
        ET.SubElement(element, "system-out").text = "\n".join([said, *_attachments(result)])


def _seconds(result: CaseResult) -> float:
    return sum(result.wall_times.values())


def case_properties(case: SuiteCase) -> list[tuple[str, str]]:
    """Name and value of everything that a later reader needs besides the outcome."""
    result = case.result
    found = [("seed", str(result.seed)), ("digest", result.digest)]
    found.append(("simulated", f"{result.sim_time:.3f} s"))
    found += _said_of(case)
    found += [(f"value:{path}", str(value)) for path, value in case.values.items()]
    found += [
        (f"margin:{verdict.expectation}", _margin(verdict))
        for verdict in result.verdicts
        if not math.isnan(verdict.margin)
    ]
    nearest = worst(result.verdicts)
    if nearest is not None:
        found.append(("worst_margin", nearest.expectation))
    return found


def sample_properties(cases: Sequence[SuiteCase]) -> list[tuple[str, str]]:
    """Of samples together: seed and digest of each, the smallest margins and whose they are."""
    found = [item for case in cases[:1] for item in _said_of(case)]
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


def _said_of(case: SuiteCase) -> list[tuple[str, str]]:
    return [("verifies", each) for each in case.verifies]


def _margin(verdict: Verdict) -> str:
    return f"{verdict.margin:.6g} {verdict.unit}".removesuffix(" 1")


def _attachments(result: CaseResult) -> list[str]:
    """Files of the report, in the form that Jenkins and GitLab show as attachments."""
    return [f"{ATTACHMENT}{printable(str(Path(result.page).resolve()))}]]"] if result.page else []
