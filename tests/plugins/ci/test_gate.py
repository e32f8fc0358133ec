"""Margins that shrink, and what pipelines read of results."""

import json
from dataclasses import replace

import jsonschema
import pytest

from harness.cli.main import main
from harness.recording.verdict import Verdict
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.write import write_suite
from tests.reporting.suites import failed, large_suite, passed, small_suite

CTRF = {
    "type": "object",
    "required": ["reportFormat", "specVersion", "results"],
    "additionalProperties": False,
    "properties": {
        "reportFormat": {"const": "CTRF"},
        "specVersion": {"type": "string", "pattern": r"^\d+\.\d+\.\d+$"},
        "generatedBy": {"type": "string"},
        "results": {
            "type": "object",
            "required": ["tool", "summary", "tests"],
            "additionalProperties": False,
            "properties": {
                "tool": {
                    "required": ["name"],
                    "properties": {"name": {"type": "string"}, "version": {"type": "string"}},
                },
                "summary": {
                    "required": [
                        *("tests", "passed", "failed", "skipped", "pending", "other"),
                        *("start", "stop"),
                    ],
                    "additionalProperties": {"type": "integer"},
                },
                "tests": {"type": "array", "items": {"$ref": "#/definitions/test"}},
            },
        },
    },
    "definitions": {
        "test": {
            "required": ["name", "status", "duration"],
            "additionalProperties": False,
            "properties": {
                "name": {"type": "string"},
                "status": {"enum": ["passed", "failed", "skipped", "pending", "other"]},
                "rawStatus": {"type": "string"},
                "duration": {"type": "integer"},
                "suite": {"type": "array", "minItems": 1, "items": {"type": "string"}},
                "filePath": {"type": "string"},
                "line": {"type": "integer"},
                "message": {"type": "string"},
                "trace": {"type": "string"},
                "type": {"type": "string"},
                "tags": {"type": "array", "items": {"type": "string"}},
                "extra": {"type": "object"},
                "attachments": {
                    "type": "array",
                    "items": {"required": ["name", "contentType", "path"]},
                },
            },
        }
    },
}
"""What the specification of CTRF 1.0 requires of the parts that are written."""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("GITHUB_ACTIONS", "GITHUB_STEP_SUMMARY"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "a").mkdir()
    text = "scenario: Pick\nparametrize: {a: [c0, c1, c2]}\n"
    (tmp_path / "a/pick.scenario.yaml").write_text(text)
    return tmp_path


def save(folder, *results):
    outcome = "failed" if any(each.outcome == "failed" for each in results) else "passed"
    record = SuiteRecord(outcome, [SuiteCase(each) for each in results])
    write_suite(folder / "reports", record, 0)


def gate(*arguments):
    return main(["gate", "reports", "--baseline", "margins.json", *arguments])


def baseline(folder, *results):
    save(folder, *results)
    assert gate("--update-baseline") == 0
    return json.loads((folder / "margins.json").read_text())["margins"]


@pytest.mark.parametrize(
    ("before", "now", "code"),
    [(0.09, 0.056, 1), (0.09, 0.0695, 1), (0.09, 0.0705, 0), (0.06, 0.09, 0), (0.05, 0.05, 0)],
)
def test_a_margin_that_lost_more_than_half_fails(folder, before, now, code):
    baseline(folder, passed(0, before))
    save(folder, passed(0, now))
    assert gate() == code


def test_what_shrank_is_reported_at_its_line_with_both_numbers(folder, capsys, monkeypatch):
    baseline(folder, passed(0, 0.09))
    save(folder, passed(0, 0.056))
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(folder / "summary.md"))
    assert gate() == 1
    said = capsys.readouterr().err
    assert "a/pick.scenario.yaml:9: the margin of 'lifted cube' shrank: 40 -> 6 mm" in said
    assert "::error file=a/pick.scenario.yaml,line=9,title=" in said
    assert "| lifted cube | a/pick.scenario.yaml \\[c0\\] | 40 -\\> 6 mm |" in (
        folder / "summary.md"
    ).read_text(encoding="utf-8")


def test_the_share_that_has_to_remain_is_an_option(folder):
    baseline(folder, passed(0, 0.09))
    save(folder, passed(0, 0.085))
    assert gate("--keep-margin", "0.9") == 1
    assert gate("--keep-margin", "0.8") == 0


def test_an_expectation_without_an_earlier_margin_is_noted_and_passes(folder, capsys):
    baseline(folder, passed(0))
    save(folder, passed(0), passed(1))
    assert gate() == 0
    assert "note: 1 margin not in margins.json yet" in capsys.readouterr().err


def expecting(result, text):
    return replace(result, verdicts=(replace(result.verdicts[0], expectation=text),))


@pytest.mark.parametrize(
    ("now", "gone"),
    [
        ("parametrize: {a: [c0]}", ["c1"]),
        ("parametrize: {b: [c0, c1], c: [1]}", ["c0", "c1"]),
        ("parametrize: [{id: c0, a: 1}]", ["c1"]),
        ("parametrize: {a: [c0, c1]}", []),
        ("parametrize: {a: [c0, c1]}\nsamples: 3", []),
        ("parametrize: {a: [c1, c0, c2]}", []),
    ],
)
def test_a_case_that_parametrize_has_no_more_fails_and_one_not_selected_passes(
    folder, capsys, now, gone
):
    file = folder / "a/pick.scenario.yaml"
    elsewhere = replace(passed(9), file="b/other.scenario.yaml")
    (folder / "b").mkdir()
    (folder / "b/other.scenario.yaml").touch()
    before = baseline(folder, passed(0), passed(1), elsewhere)
    file.write_text(f"scenario: Pick\n{now}\n")
    save(folder, passed(2))
    assert gate() == bool(gone)
    said = capsys.readouterr().err
    assert [each for each in ("c0", "c1") if f"in the case '{each}', lifted cube" in said] == gone
    assert gate("--update-baseline") == 0
    left = json.loads((folder / "margins.json").read_text())["margins"]
    assert {*before} - {*left} == {f"a/pick.scenario.yaml [{each}]" for each in gone}
    assert gate() == 0


def test_a_file_that_cannot_be_read_has_dropped_no_case(folder):
    baseline(folder, passed(0), passed(1))
    (folder / "a/pick.scenario.yaml").write_text("scenario: [")
    save(folder, replace(passed(0), case="", outcome="invalid", verdicts=()))
    assert gate() == 0


def test_an_expectation_that_was_deleted_or_loosened_fails(folder, capsys):
    baseline(folder, passed(0), passed(1))
    save(folder, expecting(passed(0), "lifted cube, above 1 mm"), passed(1))
    assert gate("--comment", "comment.md") == 1
    said = capsys.readouterr().err
    assert "a/pick.scenario.yaml: in the case 'c0', lifted cube is expected no more" in said
    assert "0.01 m -> gone" in said
    assert "1 expectation gone" in (folder / "comment.md").read_text()
    assert gate("--update-baseline") == 0
    assert gate() == 0


def test_a_scenario_that_was_deleted_fails_until_the_baseline_is_updated(folder):
    baseline(folder, passed(0), replace(passed(0), file="a/other.scenario.yaml"))
    save(folder, passed(0))
    (folder / "a/other.scenario.yaml").unlink(missing_ok=True)
    assert gate() == 1
    assert gate("--update-baseline") == 0
    assert gate() == 0


def test_what_was_not_selected_or_failed_is_not_gone(folder, capsys):
    baseline(folder, passed(0), passed(1))
    save(folder, passed(0))
    assert gate() == 0
    save(folder, passed(0), replace(failed(1), verdicts=()))
    gate()
    assert "expected no more" not in capsys.readouterr().err


def test_of_samples_the_least_margin_counts(folder):
    sample = replace(passed(0), case="sample1")
    kept = baseline(
        folder, replace(sample, case="sample2", verdicts=passed(0, 0.09).verdicts), sample
    )
    assert kept == {"a/pick.scenario.yaml": {"lifted cube": "0.01 m"}}
    save(folder, replace(sample, verdicts=passed(0, 0.09).verdicts))
    assert gate() == 0
    save(folder, replace(sample, verdicts=passed(0, 0.054).verdicts), sample)
    assert gate() == 1


def test_an_update_leaves_failed_cases_and_those_that_did_not_run_as_they_were(folder):
    first = baseline(folder, passed(0, 0.09), passed(1, 0.08), passed(2, 0.07))
    second = baseline(folder, passed(0, 0.06), failed(1))
    assert second == first | {"a/pick.scenario.yaml [c0]": {"lifted cube": "0.01 m"}}
    (folder / "a/pick.scenario.yaml").unlink()
    assert baseline(folder, failed(1)) == {}


def test_an_expectation_of_two_steps_has_two_margins(folder):
    both = [Verdict("grasped cube", "passed", 0.1, "rad", step=step) for step in ("pick", "hold")]
    kept = baseline(folder, replace(passed(0), verdicts=tuple(both)))
    assert [*kept.values()] == [{"hold: grasped cube": "0.1 rad", "pick: grasped cube": "0.1 rad"}]
    save(folder, replace(passed(0), verdicts=(both[0], replace(both[1], margin=0.02))))
    assert gate() == 1


@pytest.mark.parametrize(
    "content",
    [
        None,
        b"{",
        b"[1]",
        b'{"format": "armharness-results/1"}',
        b'{"format": "armharness-margins/1"}',
        b'{"format": "armharness-margins/1", "margins": {"a": {"lifted": 4}}}',
        b'{"format": "armharness-margins/1", "margins": {"a": {"lifted": "wide m"}}}',
        b"\xff\xfe",
    ],
)
def test_a_baseline_that_cannot_be_used_is_wrong_usage(folder, content, capsys):
    save(folder, passed(0))
    if content is not None:
        (folder / "margins.json").write_bytes(content)
    assert gate() == 2
    assert "margins.json" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        ["gate", "reports"],
        ["gate", "none", "--ctrf", "c.json"],
        ["gate", "reports", "--update-baseline"],
    ],
)
def test_wrong_usage_of_the_gate(folder, arguments, capsys):
    save(folder, passed(0))
    assert main(arguments) == 2
    assert capsys.readouterr().err.startswith("harness: ")


@pytest.mark.parametrize("record", [small_suite(), large_suite(40), SuiteRecord("passed", [])])
def test_ctrf_has_its_schema_and_the_margins(folder, record):
    write_suite(folder / "reports", record, 0)
    assert main(["gate", "reports", "--ctrf", "out/ctrf.json"]) == 0
    document = json.loads((folder / "out/ctrf.json").read_text(encoding="utf-8"))
    jsonschema.Draft7Validator(CTRF).validate(document)
    results = document["results"]
    counts = results["summary"]
    assert counts["tests"] == counts["passed"] + counts["failed"] == len(record.cases)
    for test, case in zip(results["tests"], record.cases, strict=True):
        assert test["rawStatus"] == case.result.outcome
        margins = [each.margin for each in case.result.verdicts]
        assert [each["margin"] for each in test["extra"]["margins"]] == margins


def test_ctrf_names_the_report_relative_to_its_own_folder(folder):
    save(folder, failed(1))
    images = folder / "a/pick/c1/images"
    images.mkdir(parents=True)
    (images / "01-go.jpg").touch()
    assert main(["gate", "reports", "--ctrf", "reports/ctrf.json"]) == 0
    [test] = json.loads((folder / "reports/ctrf.json").read_text())["results"]["tests"]
    paths = [each["path"] for each in test["attachments"]]
    assert paths == ["../a/pick/c1/report.html", "../a/pick/c1/images/01-go.jpg"]


def test_the_comment_has_failures_margins_and_the_picture_of_the_worst(folder):
    baseline(folder, passed(0, 0.09))
    save(folder, passed(0, 0.056), failed(1, 0.045), failed(2, 0.01))
    images = folder / "a/pick/c1/images"
    images.mkdir(parents=True)
    (images / "01-go.jpg").touch()
    assert gate("--comment", "comment.md", "--page-url", "https://pages.example/run/7/") == 1
    lines = (folder / "comment.md").read_text(encoding="utf-8").splitlines()
    assert lines[:2] == [
        "<!-- armharness -->",
        "### ❌ armharness: 1 of 3 cases passed; 1 margin shrank",
    ]
    assert lines.index("| Pick \\[c2\\] | lifted cube: 10 mm |") < lines.index(
        "| Pick \\[c1\\] | lifted cube: 45 mm |"
    )
    assert "| lifted cube | a/pick.scenario.yaml \\[c0\\] | 40 -\\> 6 mm |" in lines
    assert "![Pick \\[c2\\]](https://pages.example/run/7/../a/pick/c1/images/01-go.jpg)" in lines
    assert lines[-1] == "[The page of all cases](https://pages.example/run/7/index.html)"


def test_a_hostile_name_stays_text_in_the_comment(folder):
    write_suite(folder / "reports", small_suite(), 0)
    assert main(["gate", "reports", "--comment", "comment.md"]) == 0
    text = (folder / "comment.md").read_text(encoding="utf-8")
    assert "<script" not in text.replace("\\<", "")
    assert "\x07" not in text


@pytest.mark.nightly
def test_a_run_of_one_case_compares_its_margins(folder, capsys):
    scenario = folder / "one.scenario.yaml"
    scenario.write_text(
        "scenario: One\nrobot: {model: open_manipulator_x}\nworld: empty\n"
        "steps: [{wait: 0.2 s}]\nexpect: [{always: within_limits}]\n"
    )
    run = ["run", "one.scenario.yaml", "--in-process", "--no-page"]
    run += ["--baseline", "margins.json"]
    assert main(run) == 2
    assert "--update-baseline writes it" in capsys.readouterr().err
    assert not (folder / "reports").exists()
    assert main([*run, "--update-baseline", "--ctrf", "reports/ctrf.json"]) == 0
    assert (folder / "reports/ctrf.json").is_file()
    text = (folder / "margins.json").read_text()
    [(expectation, margin)] = json.loads(text)["margins"]["one.scenario.yaml"].items()
    assert main(run) == 0
    (folder / "margins.json").write_text(text.replace(margin, f"9 {margin.split()[1]}"))
    assert main(run) == 1
    assert f"the margin of '{expectation}' shrank" in capsys.readouterr().err


@pytest.mark.parametrize("option", [["--no-report"], ["--shard", "1/2"], ["--repeat", "2"]])
def test_options_that_leave_no_whole_suite_are_refused(option, capsys):
    arguments = ["run", "lessons/04_gripper_alone", "--ctrf", "c.json", *option]
    assert main(arguments) == 2
    assert option[0] in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("margins.json", '{"margins": {"a": {"b": "1e999 m"}}}', "'1e999 m' is no margin"),
        ("margins.json", '{"margins": {"a": {"b": "1 \\ud800"}}}', "can't encode"),
        ("results.json", '{"outcome": "\\udfff"}', "can't encode"),
        ("results.json", '{"cases": [{"verdicts": [[]]}], "rates": []}', "no file of results"),
        ("results.json", '{"cases": [], "rates": [], "outcome": []}', "no file of results"),
        ("results.json", '{"cases": [], "rates": [], "outcome": "0"}', "no file of results"),
        ("results.json", '{"cases": [{"verdicts": 5}], "rates": []}', "no file of results"),
    ],
)
def test_a_document_with_strange_numbers_and_texts_is_refused(name, text, said, folder, capsys):
    kind = {"margins.json": "armharness-margins/1", "results.json": "armharness-results/1"}[name]
    write_suite(folder / "reports", small_suite(), 0)
    file = folder / ("reports/results.json" if name == "results.json" else name)
    file.write_text(f'{{"format": "{kind}", {text[1:]}')
    words = [] if name == "results.json" else ["--baseline", name]
    assert main(["gate", "reports", "--ctrf", "c.json", *words]) == 2
    assert said in capsys.readouterr().err
    assert not (folder / "c.json").exists()


@pytest.mark.parametrize("number", ["NaN", "Infinity", "1e999", "9" * 400])
@pytest.mark.parametrize("key", ["plan", "sim_time"])
def test_a_time_that_is_not_finite_is_no_result(key, number, folder, capsys):
    write_suite(folder / "reports", small_suite(), 0)
    file = folder / "reports/results.json"
    document = json.loads(file.read_text())
    case = document["cases"][0]
    (case if key == "sim_time" else case["wall_times"])[key] = "HERE"
    file.write_text(json.dumps(document).replace('"HERE"', number))
    assert main(["gate", "reports", "--ctrf", "c.json"]) == 2
    assert "no file of results" in capsys.readouterr().err
    assert not (folder / "c.json").exists()


def test_a_baseline_may_name_files_that_no_disk_can_have(folder):
    baseline(folder, passed(0), replace(passed(1), file=f"{'a' * 300}.scenario.yaml"))
    save(folder, passed(0))
    assert gate() == 1
    assert gate("--update-baseline") == 0
    assert gate() == 0
