"""Scenarios from Python: what the documentation shows runs, and mistakes are reported."""

import re
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.core.resources import data_folder
from harness.judging.expectations.always import Always
from harness.judging.expectations.duration import DurationCheck
from harness.judging.expectations.within_limits import WithinLimits
from harness.language.reading.load import load_scenario, parse_scenario
from harness.language.reading.written import scenario_text
from harness.language.scenario import Scenario
from harness.plugins.arms.expectations.named_target import NamedTarget
from harness.steps.move_to import MoveTo
from harness.steps.wait import Wait
from harness.suite.discovery import UsageError
from tests import commands

PAGE = data_folder("scenarios").parent / "docs/guides/python.md"
BUNDLED = sorted(data_folder("scenarios").rglob("*.scenario.yaml"))
WAITS = {"scenario": "Wait", "robot": "open_manipulator_x", "steps": [Wait(duration=0.1)]}


@pytest.mark.parametrize("file", BUNDLED, ids=lambda file: file.name.split(".")[0])
def test_every_bundled_scenario_is_written_from_its_model_and_read_back(file):
    scenario = load_scenario(file).scenario
    assert parse_scenario(scenario_text(scenario), file).scenario == scenario


@pytest.mark.parametrize("number", [0, 2])
def test_the_examples_of_the_page_run(number, monkeypatch):
    monkeypatch.chdir(data_folder("scenarios").parent)
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    exec(compile(blocks[number], str(PAGE), "exec"), {})


def blocks_of_the_page(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def run_with_plugins(folder):
    """A run of the scenarios of a folder, with the modules in it as plug-ins."""
    plugins = [word for path in folder.glob("*.py") for word in ("--plugin", path.name)]
    done = commands.harness("run", *plugins, "--no-report", ".", cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.nightly
def test_the_step_and_the_expectations_of_the_page_run(tmp_path):
    (step,) = (each for each in blocks_of_the_page("python") if "class Remark(Step):" in each)
    (expectations,) = (each for each in blocks_of_the_page("python") if "(Predicate):" in each)
    scenario, expect = blocks_of_the_page("yaml")
    (tmp_path / "remarks.py").write_text(step, encoding="utf-8")
    (tmp_path / "heights.py").write_text(expectations, encoding="utf-8")
    (tmp_path / "remarks.scenario.yaml").write_text(scenario + expect, encoding="utf-8")
    run_with_plugins(tmp_path)


@pytest.mark.nightly
def test_a_model_runs_as_its_file_does(tmp_path):
    scenario = Scenario(
        scenario="Home", robot="open_manipulator_x", seed=2,
        steps=[MoveTo(named_target="home", id="up")],
        expect=[NamedTarget(state="home"), Always(predicate=WithinLimits())],
    )  # fmt: skip
    path = tmp_path / "home.scenario.yaml"
    path.write_text(scenario_text(scenario))
    ours, theirs = harness.run(scenario), harness.run(path, report_dir=tmp_path / "report")
    assert ours, str(ours)
    assert ours.case.digest == theirs.case.digest
    assert not ours.case.report_dir
    assert (tmp_path / "report/report.html").is_file()
    assert ours.step("up").status == "passed"
    assert ours.verdict("named_target").margin > 0
    assert np.array_equal(ours.run.signals.tcp_pose, theirs.run.signals.tcp_pose)


def test_a_failure_says_why_and_wrong_names_what_there_is():
    result = harness.run(Scenario(**WAITS, expect=[DurationCheck(at_least=1.0)]))
    assert not result
    assert "duration is at least 1.0 s" in str(result)
    assert "duration is at least 1.0 s" in result._repr_html_()
    with pytest.raises(LookupError, match=r"0 have 'lifted': duration is at least 1"):
        result.verdict("lifted")
    with pytest.raises(LookupError, match=r"0 have 'x': steps\[0\]"):
        result.step("x")


def test_cases_and_overrides_are_those_of_files():
    scenario = Scenario(**WAITS, parametrize={"steps.0.wait.duration": ["0.1 s", 0.2]})
    with pytest.raises(UsageError, match=r"2 cases; name one of them: 0.1_s, 0.2"):
        harness.run(scenario)
    assert harness.run(scenario, case="0.2").case.sim_time == pytest.approx(0.2, abs=0.01)
    shorter = harness.run(Scenario(**WAITS), overrides={"steps.0.wait.duration": "0.05 s"})
    assert shorter.case.sim_time == pytest.approx(0.05, abs=0.01)


def test_a_broken_file_is_a_result_with_its_problems(tmp_path):
    path = Path(tmp_path / "broken.scenario.yaml")
    path.write_text("scenario: Broken\nrobot: ur99\nsteps: [{wait: 1}]\n")
    result = harness.run(path)
    assert result.case.outcome == "invalid"
    assert result.run is None
    assert "ur99" in str(result)


@pytest.mark.nightly(but=["a/b: c"])
@pytest.mark.parametrize("title", ["Home", "a/b: c", "<x>"])
def test_a_model_that_fails_names_no_file_and_quotes_its_own_lines(title, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scenario = Scenario(
        scenario=title, robot="open_manipulator_x", steps=[MoveTo(named_target="home")],
        expect=[NamedTarget(state="init")],
    )  # fmt: skip
    reported = str(harness.run(scenario))
    [line] = [line for line in reported.splitlines() if line.startswith("<Scenario model>:")]
    number = int(line.split(":")[1])
    quoted = scenario_text(scenario).splitlines()[number - 1]
    assert "state: init" in quoted
    assert f"{number} | {quoted}" in reported
    assert str(tmp_path) not in reported
    mistaken = scenario.model_copy(update={"steps": (MoveTo(named_target="hime"),)})
    reported = str(harness.run(mistaken))
    assert "<Scenario model>:" in reported
    assert "did you mean `home`" in reported
    assert str(tmp_path) not in reported
