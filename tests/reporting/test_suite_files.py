"""JUnit XML, results and GitHub's words of a suite, read by others."""

import io
import json
import math
from dataclasses import replace
from xml.etree import ElementTree as ET

import pytest

from harness.plugins.ci.github import error_annotations, job_summary
from harness.plugins.ci.suite_reporters.junit import JunitReporter
from harness.reporting.margins import margin_share, worst
from harness.reporting.result import StepLine
from harness.reporting.sampled import SampledRate
from harness.reporting.suite.cause import cause_of, short_lines
from harness.reporting.suite.history import history_of
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.write import write_suite
from harness.reporting.terminal import causes, failure_place, root_failures
from tests.reporting.suites import (
    BROKEN,
    INVALID,
    STUCK,
    failed,
    large_suite,
    passed,
    small_suite,
    verdict,
)
from tests.suite.samples import rate_of

# element -> (required attributes, further ones, children in the order that all schemas know)
SCHEMA = {
    "testsuites": ({"name"}, {"tests", "failures", "errors", "skipped", "time"}, ["testsuite"]),
    "testsuite": (
        {"name", "tests", "failures", "errors", "skipped", "time"}, set(), ["testcase"]
    ),
    "testcase": (
        {"name", "classname", "time"}, {"file"},
        ["properties", "skipped", "error", "failure", "system-out", "system-err"],
    ),
    "properties": (set(), set(), ["property"]),
    "property": ({"name", "value"}, set(), []),
    "failure": ({"message", "type"}, set(), []),
    "error": ({"message", "type"}, set(), []),
    "system-out": (set(), set(), []),
}  # fmt: skip


def junit_xml(record):
    """The JUnit document of a suite as text."""
    writer, text = JunitReporter(record), io.BytesIO()
    for case in record.cases:
        writer.add(case)
    writer.write(text)
    return text.getvalue().decode()


def check_schema(element):
    required, further, children = SCHEMA[element.tag]
    assert required <= set(element.attrib) <= required | further, element.tag
    tags = [child.tag for child in element]
    assert tags == sorted(tags, key=children.index)
    for child in element:
        check_schema(child)


def test_junit_is_what_every_reader_of_it_knows():
    root = ET.fromstring(junit_xml(small_suite()))
    check_schema(root)
    assert root.attrib["tests"] == "6", "five cases and a rate"
    assert (root.attrib["failures"], root.attrib["errors"]) == ("3", "2")
    assert [suite.attrib["name"] for suite in root][:3] == [
        "a/pick.scenario.yaml", "b/place.scenario.yaml", "c/typo.scenario.yaml"
    ]  # fmt: skip


def test_junit_names_seed_digest_margins_requirements_and_report():
    first, second, *_ = ET.fromstring(junit_xml(small_suite())).iter("testcase")
    found = {each.attrib["name"]: each.attrib["value"] for each in first.iter("property")}
    assert found["seed"] == "0"
    assert found["digest"] == "d" * 64
    assert found["verifies"] == "REQ-7"
    assert found["value:height"] == "5 cm"
    assert found["margin:lifted cube"] == "0.01 m"
    assert first.attrib["time"] == "0.250"
    assert second.find("failure").attrib["message"] == "lifted cube: 30 mm"
    said = second.find("system-out").text
    assert "report: a/pick/c1/report.html#t=2.00&expect=2" in said
    assert "[[ATTACHMENT|" in said


@pytest.mark.parametrize(("required", "failures"), [(0.4, 0), (0.9, 1)])
def test_samples_may_fail_in_junit_and_a_rate_that_is_not_shown_may_not(required, failures):
    samples = [replace(failed(0), case="ur3e-sample0")]
    samples += [replace(passed(1), case=f"ur3e-sample{number}") for number in range(1, 12)]
    rate = rate_of([False] + [True] * 11, required, 0.95, stop_early=False)
    outcome = "failed" if failures else "passed"
    rates = [SampledRate("a/pick.scenario.yaml", "ur3e", rate, outcome)]
    root = ET.fromstring(junit_xml(SuiteRecord(outcome, [*map(SuiteCase, samples)], rates)))
    check_schema(root)
    assert (root.attrib["tests"], root.attrib["failures"]) == ("13", str(failures))
    first, *_, last = root.iter("testcase")
    assert first.find("failure") is None
    assert first.find("system-out").text.startswith("failed, as samples may")
    assert last.attrib["name"] == "success rate ur3e"
    assert len(last.findall("failure")) == failures


def test_results_are_strict_json_with_the_worst_margin(tmp_path):
    write_suite(tmp_path, small_suite(), 3)
    found = json.loads((tmp_path / "results.json").read_text())
    assert (found["exit_code"], found["outcome"]) == (3, "error")
    assert found["cases"][1]["worst_margin"]["expectation"] == "lifted cube"
    assert found["cases"][1]["worst_margin"]["margin"] == pytest.approx(-0.02)
    assert found["cases"][1]["worst_margin"]["share"] == pytest.approx(-0.4)
    assert found["rates"][0]["rate"]["passed"] == 8
    assert sorted(file.name for file in tmp_path.iterdir()) == [
        "index.html", "junit.xml", "results.json"
    ]  # fmt: skip


def test_history_is_read_from_earlier_results_and_other_files_are_left_out(tmp_path):
    for number, value in enumerate((0.06, 0.08, 0.1)):
        record = SuiteRecord("passed", [type(small_suite().cases[0])(passed(1, value))])
        write_suite(tmp_path / f"run-{number}", record, 0)
    (tmp_path / "other.json").write_text('{"format": "something else"}')
    (tmp_path / "broken.json").write_text("{")
    [(key, shares)] = history_of(tmp_path).items()
    assert key == ("a/pick.scenario.yaml", "c1")
    assert shares == pytest.approx([1 / 6, 3 / 8, 1 / 2])


@pytest.mark.parametrize("share", ["1" + "0" * 400, "1e999", "NaN"])
def test_a_share_beyond_all_numbers_is_none(share, tmp_path):
    margin = f'{{"share": {share}}}'
    case = f'{{"file": "a", "case": "b", "worst_margin": {margin}}}'
    (tmp_path / "a.json").write_text(f'{{"format": "armharness-results/1", "cases": [{case}]}}')
    assert [*history_of(tmp_path).values()] in ([], [[None]])


def test_annotations_stand_at_their_lines_and_cannot_be_broken_out_of():
    lines = list(error_annotations([passed(0), failed(1), STUCK, INVALID, BROKEN]))
    assert lines[0] == (
        "::error file=a/pick.scenario.yaml,line=9,title=Pick [c1]::lifted cube: 30 mm"
    )
    assert lines[1].startswith("::error file=b/place.scenario.yaml,line=7,title=Place::move_to far")
    assert lines[2].startswith("::error file=c/typo.scenario.yaml,line=3,col=5,")
    assert len(lines) == 4
    assert all("\n" not in line for line in lines)


def test_a_rate_is_named_without_a_mark_that_reads_as_a_word():
    record = small_suite()
    message = next(
        failure.get("message")
        for failure in ET.fromstring(junit_xml(record)).iter("failure")
        if failure.get("type") == "success rate"
    )
    assert message.startswith("a/pick.scenario.yaml: 8 of 10 samples passed, 80.0%")
    assert "\n- a/pick.scenario.yaml: 8 of 10 samples passed" in job_summary(record)


def test_the_job_summary_has_the_worst_first_and_keeps_text_text():
    lines = job_summary(small_suite()).splitlines()
    assert lines[0] == "## 💥 armharness: 1 of 5 passed; success rate not confirmed"
    rows = [line for line in lines if line.startswith("| ")][1:]
    assert rows[0].startswith("| ❌ | Pick")
    assert rows[-1].startswith("| ✅ |")
    assert all(line.replace("\\|", "").count("|") == 5 for line in rows)
    assert not any("<script>" in line.replace("\\<", "") for line in lines)


def test_short_lines_are_as_editors_have_them():
    assert list(short_lines([passed(0), failed(1), INVALID])) == [
        "a/pick.scenario.yaml:9:1: [c1] lifted cube: 30 mm",
        "c/typo.scenario.yaml:3:5: no verb is called `pikc`: did you mean",
    ]


def test_cases_that_fail_alike_have_one_cause():
    assert cause_of(STUCK).group == "NO_IK_SOLUTION in move_to"
    assert cause_of(passed(0)) is None
    assert cause_of(failed(1)).group == cause_of(failed(2, 0.01)).group


REACH = StepLine(
    "pick.reach", "move_to", "move_to before cube", "failed", "GOAL_IN_COLLISION",
    "the nearest: forearm_link and post", path="steps[1].reach",
)  # fmt: skip
OUTER = {
    "pick": StepLine("pick", "pick", "pick cube", "failed", "GOAL_IN_COLLISION",
                     "its step `move_to before cube` failed", path="steps[1]"),
    "repeat": StepLine("again", "repeat", "repeat 3 times", "failed", "GOAL_IN_COLLISION",
                       "its step `pick cube` failed", path="steps"),
}  # fmt: skip


@pytest.mark.parametrize("outer", [("pick",), ("repeat", "pick"), ()])
def test_a_case_failed_because_of_the_innermost_step(outer):
    steps = (*(OUTER[name] for name in outer), REACH)
    result = replace(STUCK, steps=steps, page="b/report.html", verdicts=(verdict(0.03),))
    cause = cause_of(result)
    assert cause.group == "GOAL_IN_COLLISION in move_to"
    assert cause.text == (
        "move_to before cube: GOAL_IN_COLLISION: the nearest: forearm_link and post"
    )
    assert [each for each in causes(result) if "its step" in each] == []
    assert failure_place(result) == "#t=4.00&tab=planner", "where the step is explained"


def test_steps_with_like_names_are_not_nested():
    first = replace(REACH, path="steps[1]", summary="first")
    other = replace(REACH, path="steps[10]", summary="other")
    assert root_failures([first, other]) == [first, other]


def test_margins_of_any_unit_are_shares_between_minus_one_and_one():
    assert worst([]) is None
    for record in large_suite(200).cases:
        for each in record.result.verdicts:
            share = margin_share(each)
            assert -1 <= share <= 1
            assert math.copysign(1, share) == (1 if each.status == "passed" else -1)
