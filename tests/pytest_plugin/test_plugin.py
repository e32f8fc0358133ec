import html
import json
import os
import re
import subprocess
import sys
from contextlib import closing
from xml.etree import ElementTree

import numpy as np  # noqa: F401
import pytest

import harness.language.files.yaml_file  # noqa: F401
from tests.reporting.browser import new_context

# pytester forgets modules that are new in its runs, and native ones come once only

HOLDS = """\
# a comment before the title
scenario: Hold still
tags: [lesson, pick-and-place, xfail]
robot: open_manipulator_x
steps:
  - wait: 0.1 s
expect:
  - duration: {at_most: 0.2 s}
"""
FAILS = """\
scenario: Too short
tags: [ur]
robot: open_manipulator_x
steps:
  - wait: 0.1 s
    id: pause
expect:
  - duration: {at_least: 1 s}
  - duration: {at_least: 2 s}
  - always: within_limits
"""
INVALID = """\
scenario: Wrong in two places
robot: open_manipulator_x
steps:
  - wait: 3 parsecs
  - gripperr: open
"""


@pytest.fixture
def write(pytester):
    def write(**texts):
        for name, text in texts.items():
            (pytester.path / f"{name}.scenario.yaml").write_text(text)

    return write


def run(pytester, *arguments):
    return pytester.runpytest("-p", "no:cacheprovider", "-p", "no:randomly", *arguments)


def selected(pytester, *arguments):
    """Names of the items that these arguments leave."""
    lines = run(pytester, "--collect-only", "-q", *arguments).outlines
    return [line.split("::")[1] for line in lines if "::" in line]


def test_a_scenario_is_an_item_with_file_line_and_title(pytester, write):
    write(holds=HOLDS)
    items, _recorder = pytester.inline_genitems("--strict-markers")
    [item] = items
    assert item.nodeid == "holds.scenario.yaml::Hold still"
    assert item.reportinfo() == (pytester.path / "holds.scenario.yaml", 1, "Hold still")


def test_tags_are_marks_and_never_change_what_a_verdict_means(pytester, write):
    write(holds=HOLDS, fails=FAILS)
    items, _recorder = pytester.inline_genitems("--strict-markers")
    marks = {item.name: {mark.name for mark in item.iter_markers()} for item in items}
    assert marks == {"Hold still": {"lesson", "pick-and-place"}, "Too short": {"ur"}}
    assert selected(pytester, "-m", "lesson") == ["Hold still"]
    assert selected(pytester, "-m", "not pick-and-place") == ["Too short"]


@pytest.mark.parametrize("words", ["still", "holds", "lesson and not short"])
def test_k_knows_titles_files_and_tags(pytester, write, words):
    write(holds=HOLDS, fails=FAILS)
    assert selected(pytester, "-k", words) == ["Hold still"]


def test_other_yaml_files_and_switched_off_names_are_left_alone(pytester, write):
    write(holds=HOLDS)
    pytester.makefile(".yaml", other="scenario: Not a harness file")
    items, _recorder = pytester.inline_genitems("-o", "harness_files=")
    assert items == []
    items, _recorder = pytester.inline_genitems("-o", "harness_files=other.yaml")
    assert [item.name for item in items] == ["Not a harness file"]
    result = run(pytester, "-p", "no:armharness")
    result.assert_outcomes()


def test_outcomes_are_reported_with_lines_and_numbers(pytester, write):
    write(holds=HOLDS, fails=FAILS, invalid=INVALID)
    result = run(pytester, "-v", "--junitxml=junit.xml")
    result.assert_outcomes(passed=1, failed=2)
    text = result.stdout.str()
    assert "FAILED fails.scenario.yaml::Too short - fails.scenario.yaml:8: " in text
    assert "fails.scenario.yaml:9: " in text
    assert "0.1 s" in text
    assert "    8 |   - duration: {at_least: 1 s}" in text
    assert "report: " in text
    assert "invalid.scenario.yaml:4:11: " in text
    assert "invalid.scenario.yaml:5:5: " in text
    assert "did you mean" in text
    assert "Traceback" not in text
    assert (pytester.path / "reports/holds/run.json").is_file()
    assert (pytester.path / "reports/fails/run.json").is_file()
    assert not (pytester.path / "reports/invalid").exists()
    junit = (pytester.path / "junit.xml").read_text()
    assert 'property name="digest" value="' in junit


@pytest.mark.nightly
def test_reports_go_where_they_are_requested(pytester, write):
    write(holds=HOLDS)
    run(pytester, "--harness-report-dir", "elsewhere").assert_outcomes(passed=1)
    assert (pytester.path / "elsewhere/holds/run.json").is_file()
    run(pytester, "-o", "harness_report_dir=by_ini").assert_outcomes(passed=1)
    assert (pytester.path / "by_ini/holds/run.json").is_file()
    run(pytester, "--harness-no-report").assert_outcomes(passed=1)
    assert not (pytester.path / "reports").exists()


@pytest.mark.parametrize("place", ["notes.txt", "notes.txt/reports", "x" * 256])
def test_a_report_folder_that_cannot_be_written_is_refused_before_anything_runs(pytester, place):
    pytester.makefile(".txt", notes="notes")
    result = run(pytester, "--harness-report-dir", place)
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(
        [f"ERROR: --harness-report-dir: nothing can be written into '{place}'*"]
    )


@pytest.mark.nightly
def test_xdist_and_this_process_give_the_same_digest(pytester, write):
    write(holds=HOLDS, again=HOLDS)
    digests = set()
    for number, options in enumerate((["-n2"], ["--harness-in-process"], [])):
        file = f"{number}.xml"
        result = pytester.runpytest_subprocess(
            *options, "--harness-no-report", f"--junitxml={file}"
        )
        result.assert_outcomes(passed=2)
        text = (pytester.path / file).read_text()
        found = re.findall(r'name="digest" value="(\w+)"', text)
        assert len(found) == 2
        digests.update(found)
    assert len(digests) == 1


def test_a_run_without_scenarios_imports_nothing_of_the_harness_but_the_plugin(pytester):
    pytester.makepyfile("""
        import sys

        def test_modules():
            ours = {name for name in sys.modules if name.split(".")[0] == "harness"}
            plugin = "harness.pytest_plugin"
            own = ("plugin", "session_options")
            assert ours == {"harness", plugin, *(f"{plugin}.{name}" for name in own)}
            assert not {"numpy", "pydantic", "yaml"} & set(sys.modules)
    """)
    result = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "harness.pytest_plugin.plugin"],
        cwd=pytester.path,
        env={**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},  # others import numpy
        capture_output=True,
        text=True,
        check=False,
    )
    assert "1 passed" in result.stdout, result.stdout


@pytest.mark.nightly
def test_every_parametrised_case_is_an_item_with_a_readable_name(pytester, write):
    cases = "parametrize:\n  robot: [open_manipulator_x, ur3e]\n  seed: [1, 2]\n"
    write(holds=HOLDS + cases)
    names = [f"Hold still[{robot}-{seed}]" for robot in ("open_manipulator_x", "ur3e")
             for seed in (1, 2)]  # fmt: skip
    assert selected(pytester) == names
    assert selected(pytester, "-k", "ur3e-2") == ["Hold still[ur3e-2]"]
    run(pytester, "holds.scenario.yaml::Hold still[ur3e-1]").assert_outcomes(passed=1)


@pytest.mark.nightly
def test_random_samples_are_one_item_that_reports_the_rate(pytester, write):
    lines = "params: {time: 0.1 s}\nrandomize:\n  time: {uniform: [0.15 s, 0.25 s]}\nsamples: 4\n"
    varied = HOLDS.replace("wait: 0.1 s", 'wait: "${time}"') + lines
    write(varied=varied, shown=varied.replace("at_most: 0.2 s", "at_most: 0.3 s"))
    result = run(pytester, "-rA")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.re_match_lines(
        [
            r".*Hold still: [123] of 4 samples passed.*every one must pass.*",
            r"sample\d:",
            r"again: harness run varied.scenario.yaml --case sample\d",
        ]
    )


def test_the_fixture_runs_scenarios_of_tests_written_by_hand(pytester, write):
    write(holds=HOLDS, fails=FAILS)
    pytester.makepyfile(
        """
        def test_holds(harness_scenario):
            result = harness_scenario("holds.scenario.yaml", overrides={"seed": 4})
            assert result, str(result)
            assert result.case.seed == 4
            assert result.run.signals.times[-1] < 0.2

        def test_fails(harness_scenario):
            result = harness_scenario("fails.scenario.yaml")
            assert result, str(result)
        """
    )
    result = run(pytester, "-k", "test_holds or test_fails")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.re_match_lines([r"E +AssertionError: failed", r"E +fails.scenario.yaml:8: .*"])
    assert (pytester.path / "reports/tests/test_holds-1/run.json").is_file()


def test_pytest_html_begins_with_causes_and_its_rows_have_margin_picture_and_page(
    pytester, write, browser
):
    write(holds=HOLDS, fails=FAILS)
    pytester.makepyfile(
        """
        def test_by_hand(harness_scenario):
            assert harness_scenario("fails.scenario.yaml")
        """
    )
    words = ("--html=out/report.html", "--self-contained-html", "-p", "no:cacheprovider")
    pytester.runpytest(*words).assert_outcomes(passed=1, failed=2)
    page = html.unescape((pytester.path / "out/report.html").read_text())
    tests = json.loads(re.search(r'data-jsonblob="(\{.*?\})"></div>', page, re.DOTALL)[1])["tests"]
    rows = {name.split("::")[-1]: row for name, (row,) in tests.items()}
    failed = rows["Too short"]
    assert any("duration is at" in cell for cell in failed["resultsTableRow"])
    kinds = {each["format_type"]: each["content"] for each in failed["extras"]}
    assert kinds["url"].startswith("../reports/fails/report.html#")
    assert kinds["image"].startswith("data:image/webp;base64,")
    assert "duration is at" in kinds["html"]
    assert "fails.scenario.yaml:8: duration is at" in failed["log"]
    assert "CaseResult(" not in failed["log"]
    assert "fails.scenario.yaml:8: duration is at" in rows["test_by_hand"]["log"]
    with closing(new_context(browser, offline=True)) as context:
        opened = context.new_page()
        opened.goto((pytester.path / "out/report.html").as_uri())
        first = opened.locator(".scenarios")
        assert first.locator("b").first.inner_text() == "1 of 2 scenarios passed"
        assert "Too short: duration is at" in first.inner_text()
        assert first.get_by_text("all scenarios").get_attribute("href") == "../reports/index.html"
        looks = opened.locator("#results-table td, .scenarios").evaluate_all(
            "(all) => all.map(getComputedStyle).map((each) => [each.fontSize, each.color])"
        )
        assert ["14px", "rgb(27, 32, 39)"] in looks
        assert all(float(size.removesuffix("px")) >= 13 for size, _ in looks)


@pytest.mark.nightly
def test_other_plugins_work_next_to_it(pytester, write):
    write(holds=HOLDS, again=HOLDS.replace("0.1 s", "0.15 s"))
    words = ["-n", "2", "--randomly-seed=7", "--timeout=600", "--html=report.html",
             "--self-contained-html", "--cov=harness.suite", "--cov-report=json"]  # fmt: skip
    done = pytester.runpytest_subprocess("-p", "no:cacheprovider", *words)
    done.assert_outcomes(passed=2)
    assert "Hold still" in (pytester.path / "report.html").read_text()
    assert (pytester.path / "coverage.json").is_file()


TIGHT = """\
scenario: Just in time
verifies: [REQ-4, REQ-5]
robot: open_manipulator_x
steps:
  - wait: 0.1 s
    id: pause
expect:
  - duration: {at_most: 0.103 s}
"""


def properties(pytester):
    [case] = ElementTree.parse(pytester.path / "junit.xml").iter("testcase")
    return [(each.get("name"), each.get("value")) for each in case.iter("property")]


@pytest.mark.nightly
def test_junit_of_samples_has_the_smallest_margin_and_every_seed_and_digest(pytester, write):
    lines = "params: {time: 0.1 s}\nrandomize:\n  time: {uniform: [0.02 s, 0.09 s]}\nsamples: 3\n"
    write(tight=TIGHT.replace("wait: 0.1 s", 'wait: "${time}"') + lines)
    run(pytester, "--junitxml=junit.xml").assert_outcomes(passed=1)
    found = dict(properties(pytester))
    assert (found["passed"], found["samples"]) == ("3", "3")
    assert len({found[f"seed:sample{i}"] for i in range(3)}) == 3
    assert len({found[f"digest:sample{i}"] for i in range(3)}) == 3
    assert re.fullmatch(r"0\.0\d+ s \(sample[012]\)", found["margin:duration is at most 0.1 s"])
    results = json.loads((pytester.path / "reports/results.json").read_text())
    assert len(results["cases"]) == 3
    assert results["rates"][0]["rate"]["passed"] == 3


@pytest.mark.nightly(but=["alone"])
@pytest.mark.parametrize("options", [[], ["-n2"]], ids=["alone", "xdist"])
def test_a_session_leaves_the_files_of_a_suite_in_file_order(pytester, write, options):
    write(a_fails=FAILS, b_holds=HOLDS, c_invalid=INVALID)
    result = pytester.runpytest(*options)
    result.assert_outcomes(passed=1, failed=2)
    result.stdout.re_match_lines([r"reports: .*reports/index.html"])
    results = json.loads((pytester.path / "reports/results.json").read_text())
    files = ["a_fails.scenario.yaml", "b_holds.scenario.yaml", "c_invalid.scenario.yaml"]
    assert [case["file"] for case in results["cases"]] == files
    assert (results["outcome"], results["exit_code"]) == ("invalid", 2)
    assert "a_fails/report.html#t=" in (pytester.path / "reports/index.html").read_text()
    [whole] = ElementTree.parse(pytester.path / "reports/junit.xml").iter("testsuites")
    assert (whole.get("tests"), whole.get("failures"), whole.get("errors")) == ("3", "1", "1")


@pytest.mark.nightly
def test_margins_are_in_junit_and_reported_when_they_get_small(pytester, write):
    def reported(wait):
        write(tight=TIGHT.replace("wait: 0.1 s", f"wait: {wait} s"))
        result = pytester.runpytest("--harness-no-report", "--junitxml=junit.xml")
        result.assert_outcomes(passed=1)
        return [line for line in result.outlines if " of its limit" in line or "as they" in line]

    assert reported(0.05) == []
    [line] = reported(0.1)
    assert re.match(r"holds by 2\.9% of its limit, was 51\.5% last time: duration is at most", line)
    assert line.endswith("(tight.scenario.yaml::Just in time)")
    assert reported(0.1) == ["1 below 5% as they were last time"]
    assert not (pytester.path / "reports").exists()
    found = properties(pytester)
    assert [name for name, _ in found[:2]] == ["seed", "digest"]
    assert [value for name, value in found if name == "verifies"] == ["REQ-4", "REQ-5"]
    assert ("margin:duration is at most 0.1 s", "0.003 s") in found
    assert ("worst_margin", "duration is at most 0.1 s") in found


@pytest.mark.nightly(but=["-Hold still-imported0"])
@pytest.mark.parametrize(
    ("keys", "item", "imported"),
    [
        ("", "Hold still", []),
        ("parametrize: {seed: [1, 2, 3]}\n", "Hold still[3]", ["numpy", "pydantic"]),
    ],
)
def test_collecting_scenarios_imports_no_planner_and_no_physics(write, keys, item, imported):
    write(holds=HOLDS + keys)
    code = """if True:
        import sys, pytest
        pytest.main(["--collect-only", "-q", "-p", "no:cacheprovider", "-p", "no:randomly"])
        native = {"numpy", "mujoco", "pinocchio", "coal", "ompl", "cv2", "pydantic"}
        print("imported:", sorted(native & set(sys.modules)))
    """
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert item in done.stdout
    assert f"imported: {imported}" in done.stdout


def test_in_an_action_of_github_a_session_annotates_and_sums_up(pytester, write, monkeypatch):
    write(holds=HOLDS, fails=FAILS)
    summary = pytester.path / "summary.md"
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(summary))
    result = run(pytester, "--harness-no-report")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["::error file=fails.scenario.yaml,line=8,title=Too short::*"])
    assert summary.read_text().startswith("## ❌ armharness: 1 of 2 passed")


@pytest.mark.nightly
def test_a_warning_of_a_verdict_fails_a_strict_session(pytester, write):
    write(holds=HOLDS + "  - eventually: {static: {}}\n")
    run(pytester).assert_outcomes(passed=1)
    result = run(pytester, "--harness-strict")
    result.assert_outcomes(failed=1)
    result.stdout.re_match_lines([".*warning: already true at the start.*"])


@pytest.mark.nightly
@pytest.mark.parametrize("workers", [(), ("-n", "2")])
def test_last_failed_runs_exactly_what_failed(pytester, write, workers):
    case = "parametrize: {params.t: ['0.1 s', '1.5 s']}\nparams: {t: 0.1 s}\n"
    varied = FAILS.replace("Too short", "Sizes").replace("wait: 0.1 s", "wait: ${t}") + case
    write(holds=HOLDS, varied=varied)
    write(title=FAILS.replace("Too short", '"odd [a] title [b]"'), last=FAILS)
    failed = [
        "last.scenario.yaml::Too short",
        "title.scenario.yaml::odd [a] title [b]",
        "varied.scenario.yaml::Sizes[0.1_s]",
        "varied.scenario.yaml::Sizes[1.5_s]",
    ]
    write(varied=varied.replace("at_least: 2 s", "at_least: 1 s"))
    options = ("-q", "-p", "no:randomly", "--harness-no-report")
    pytester.runpytest(*options, *workers).assert_outcomes(failed=3, passed=2)

    def collected(*more):
        lines = pytester.runpytest(*options, "--collect-only", *more).outlines
        return [line for line in lines if "::" in line]

    assert sorted(collected("--lf")) == failed[:3]
    assert sorted(collected("--ff")[:3]) == failed[:3]
    again = pytester.runpytest(*options, "--lf", *workers)
    again.assert_outcomes(failed=3)
    assert collected(*failed[1:]) == failed[1:]
    left = collected("--deselect", failed[1], "--deselect", failed[2])
    assert sorted(left) == ["holds.scenario.yaml::Hold still", failed[0], failed[3]]


@pytest.mark.nightly
def test_stepwise_continues_with_the_case_that_failed(pytester, write):
    case = "parametrize: {params.t: ['2.5 s', '0.1 s']}\nparams: {t: 0.1 s}\n"
    write(varied=FAILS.replace("wait: 0.1 s", "wait: ${t}") + case)
    options = ("-p", "no:randomly", "--harness-no-report", "--sw")
    pytester.runpytest(*options).assert_outcomes(failed=1, passed=1)
    pytester.runpytest(*options).assert_outcomes(failed=1, deselected=1)


@pytest.mark.nightly
def test_a_failed_case_is_compared_with_the_last_one_that_passed(pytester, write):
    text = (
        "scenario: still\nrobot: open_manipulator_x\n"
        "steps: [{wait: 0.1}]\nexpect: [{duration: {at_most: 0.2 s}}]\n"
    )
    write(still=text)
    options = ("--harness-reporter", "green=kept")
    run(pytester, *options).assert_outcomes(passed=1)
    write(still=text.replace("0.2", "0.05"))
    result = run(pytester, *options)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["page: *against_last_green.html"])
    [page] = pytester.path.rglob("against_last_green.html")
    assert "at_most: 0.05 s" in page.read_text()
    wrong = run(pytester, "--harness-reporter", "gren=kept")
    wrong.stderr.fnmatch_lines(["*there is no reporter 'gren'; did you mean `green`?*"])
    alone = run(pytester, "--harness-reporter", "green")
    alone.stderr.fnmatch_lines(["*--harness-reporter: the reporter `green` needs a folder*"])
