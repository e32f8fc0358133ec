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

from harness.recording.run import Verdict
from harness.reporting.margins import margin_share, worst
from harness.reporting.result import CaseResult
from harness.reporting.suite.cause import cause_of
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.terminal import causes, report_link

NAME = "armharness"
ILLEGAL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
"""What XML 1.0 cannot hold."""


def junit_xml(record: SuiteRecord) -> str:
    """A document with one `testsuite` a scenario file; times are of the wall clock."""
    suites = ET.Element("testsuites", name=NAME)
    files: dict[str, list[SuiteCase]] = {}
    for case in record.cases:
        files.setdefault(case.result.file, []).append(case)
    for file, cases in files.items():
        suite = ET.SubElement(suites, "testsuite", {"name": _legal(file), **_counts(cases)})
        for case in cases:
            _add_case(suite, case)
    for name, count in _counts(record.cases).items():
        suites.set(name, count)
    ET.indent(suites)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(suites, encoding="unicode")}\n'


def _counts(cases: Sequence[SuiteCase]) -> dict[str, str]:
    outcomes = [case.result.outcome for case in cases]
    time = sum(_seconds(case.result) for case in cases)
    return {
        "tests": str(len(cases)),
        "failures": str(outcomes.count("failed")),
        "errors": str(outcomes.count("error") + outcomes.count("invalid")),
        "skipped": "0",
        "time": f"{time:.3f}",
    }


def _add_case(suite: ET.Element, case: SuiteCase) -> None:
    result = case.result
    name = f"{result.title}[{result.case}]" if result.case else result.title
    place = ".".join(Path(result.file).with_suffix("").with_suffix("").parts).strip("./")
    element = ET.SubElement(
        suite,
        "testcase",
        name=_legal(name),
        classname=_legal(place),
        file=_legal(result.file),
        time=f"{_seconds(result):.3f}",
    )
    properties = ET.SubElement(element, "properties")
    for key, value in case_properties(case):
        ET.SubElement(properties, "property", name=_legal(key), value=_legal(value))
    cause = cause_of(result)
    if cause is not None:
        kind = "failure" if result.outcome == "failed" else "error"
        told = ET.SubElement(element, kind, message=_legal(cause.said), type=_legal(cause.group))
        told.text = _legal("\n".join(causes(result)))
    if result.report_dir:
        out = ET.SubElement(element, "system-out")
        lines = [f"report: {report_link(result)}", *_attachments(result)]
        out.text = _legal("\n".join(lines))


def _seconds(result: CaseResult) -> float:
    return sum(result.wall_times.values())


def case_properties(case: SuiteCase) -> list[tuple[str, str]]:
    """Name and value of everything that a later reader needs beside the outcome."""
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
    return [f"[[ATTACHMENT|{Path(result.page).resolve()}]]"] if result.page else []


def _legal(text: str) -> str:
    return ILLEGAL.sub("\N{REPLACEMENT CHARACTER}", text)
