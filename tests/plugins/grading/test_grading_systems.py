"""What grading systems read: tables, results of one submission, and folders to upload."""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from docs import ROOT
from harness.cli.main import main
from harness.core.errors import SpecError
from harness.plugins.grading.assignment import (
    Assignment,
    HiddenCase,
    LoadedAssignment,
    read_assignment,
)
from harness.plugins.grading.classroom.pages import losses, write_pages
from harness.plugins.grading.classroom.results import (
    ClassGrade,
    Criterion,
    StudentGrade,
    advice,
    graded_run,
)
from harness.plugins.grading.classroom.submissions import Submission
from harness.plugins.grading.classroom.systems import classroom50, gradescope, write_classroom50
from harness.plugins.grading.classroom.tables import read_roster, with_roster, write_tables
from harness.plugins.grading.credit import Credit, GradedResult
from harness.recording.verdict import Verdict
from harness.reporting.result import CaseResult
from harness.suite.discovery import UsageError
from tests.plugins.grading.classes import SOLUTION

CRITERIA = (Criterion("it is lifted", 6.0), Criterion("it is fast", 3.0))
PASSED = Verdict("it is lifted", "passed", 0.01, "m"), Verdict("it is fast", "passed", 1.0, "s")
LOW = Verdict("it is lifted", "failed", -0.017, "m", 2.0, reason="it is 17 mm low")
ENVIRONMENT = {
    "CLASSROOM": "robots",
    "ASSIGNMENT": "lift",
    "SUBMISSION_TAG": "submit/1",
    "COMMIT_URL": "https://example.org/commit/1",
    "RELEASE_URL": "https://example.org/release/1",
}
GRADESCOPE_TEST = {"name", "score", "max_score", "status", "output", "visibility"}


def student(name, *cases, criteria=CRITERIA):
    runs = [
        graded_run(number, CaseResult("a.yaml", "", "Lift", "failed", verdicts=verdicts), criteria,
                   len(cases))
        for number, verdicts in enumerate(cases)
    ]  # fmt: skip
    return StudentGrade(Submission(name, name, Path(name)), criteria, tuple(runs))


GOOD = student("ada", PASSED, PASSED)
HIDDEN = student("grace", PASSED, (LOW, PASSED[1]))
NOTHING = replace(student("=cmd|' /C calc'!A1"), problem="it lacks a .scenario.yaml")


def class_of(*students):
    model = Assignment(assignment="Lift it", scenario="lift.scenario.yaml")
    return ClassGrade(LoadedAssignment(model, Path("lift"), None), students, "process")


def test_only_judged_failures_count_as_failures_of_a_class(tmp_path):
    unreached = Verdict("it is lifted", "not reached"), Verdict("it is fast", "failed", -1.0, "s")
    grade = class_of(GOOD, student("low", (LOW, PASSED[1])), student("far", unreached), NOTHING)
    lifted, fast = losses(grade)
    assert lifted[2] == {"failed": 1, "not reached": 1, "not run": 1}
    assert fast[2] == {"failed": 1, "not run": 1}
    text = write_pages(grade, tmp_path).read_text()
    assert "<td>1 in the public case, 1 not reached, 1 not run</td>" in text
    assert "<td>1 in the public case, 1 not run</td>" in text
    assert re.search(r"\d{4}-\d\d-\d\d \d\d:\d\d UTC · .*armharness \d", text)


def test_the_advice_on_a_lift_begins_with_the_grasp(tmp_path):
    criteria = (Criterion("it is lifted", 6.0, advice()["lifted"]),)
    write_pages(class_of(student("low", (LOW,), criteria=criteria)), tmp_path)
    text = (tmp_path / "students/low/index.html").read_text()
    assert re.search('<p class="advice">(.*?)</p>', text)[1].startswith("Check the grasp first")


@pytest.mark.parametrize(
    ("words", "time"), [("eventually: it is grasped", "6.00"), ("never: collision", "0.00")]
)
def test_the_replay_of_what_never_came_true_opens_at_the_end(tmp_path, words, time):
    report = tmp_path / "students/late/run/report.html"
    verdict = replace(LOW, expectation=words, time=0.0)
    one = student("late", (verdict,), criteria=CRITERIA[:1])
    result = replace(one.runs[0].result, page=str(report), sim_time=6.0)
    write_pages(class_of(replace(one, runs=(replace(one.runs[0], result=result),))), tmp_path)
    text = (tmp_path / "students/late/index.html").read_text()
    assert f'href="run/report.html#t={time}&amp;expect=1"' in text


def read_table(file):
    return list(csv.reader(file.read_text(encoding="utf-8").splitlines()))


def test_points_of_an_expectation_are_shared_among_cases():
    assert (GOOD.earned, GOOD.points, GOOD.is_full, GOOD.remark) == (9, 9, True, "")
    assert (HIDDEN.earned, HIDDEN.earned_of(0), HIDDEN.hidden_loss) == (6, 3, [0])
    assert HIDDEN.remark == "hidden case 1: it is lifted"
    assert (NOTHING.earned, NOTHING.is_full) == (0, False)


def test_the_first_reason_is_what_fails_and_not_what_earns_a_share():
    holding = Verdict("it is lifted", "passed", 0.01, "m")
    failing = Verdict("it is fast", "failed", reason="it is slow")
    share = Credit(0.2, "1 of 5 targets are answered rightly")
    result = GradedResult("a.py", "", "Lift", "failed", verdicts=(holding, failing), credit=share)
    run = graded_run(0, result, CRITERIA, 1)
    found = StudentGrade(Submission("ada", "ada", Path("ada")), CRITERIA, (run,))
    assert "it is slow" in found.remark
    assert found.earned == pytest.approx(1.2)


def test_a_case_without_verdicts_earns_nothing_whatever_it_says():
    for outcome in ("error", "invalid"):
        result = CaseResult("a.yaml", "", "Lift", outcome, verdicts=PASSED, message="it crashed")
        run = graded_run(0, result, CRITERIA, 1)
        assert [mark.earned for mark in run.marks] == [0, 0]
        assert "it crashed" in run.marks[0].reason


def test_expectations_on_steps_count_nothing():
    more = replace(PASSED[0], step="pick", points=99.0)
    found = student("ada", (more, *PASSED))
    assert (found.earned, found.points) == (9, 9)


def test_tables_have_the_columns_that_each_program_reads(tmp_path):
    roster = tmp_path / "roster.csv"
    roster.write_text("submission,email,student_id,first_name,last_name,canvas_id,section\n"
                      "ada,ada@example.org,17,Ada,Lovelace,4711,A\n")  # fmt: skip
    grade = with_roster(class_of(GOOD, HIDDEN, NOTHING), read_roster(roster))
    write_tables(grade, tmp_path)
    assert read_table(tmp_path / "nbgrader.csv")[:2] == [
        ["assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email",
         "raw_score", "late_submission_penalty", "score", "max_score"],
        ["lift", "", "", "17", "Lovelace", "Ada", "ada@example.org", "9", "0", "9", "9"],
    ]  # fmt: skip
    head, possible, first, second, third = read_table(tmp_path / "canvas.csv")
    assert head == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "Lift it"]
    assert (possible[0].strip(), possible[-1]) == ("Points Possible", "9")
    assert first == ["Ada Lovelace", "4711", "", "", "A", "9"]
    assert (second[0], second[-1]) == ("grace", "6")
    moodle = read_table(tmp_path / "moodle.csv")
    assert moodle[1] == ["ada@example.org", "17", "ada", "9", ""]
    grades = read_table(tmp_path / "grades.csv")
    assert grades[2] == ["grace", "6", "9", "3", "3", "hidden case 1: it is lifted"]
    assert third[0] == grades[3][0] == "'=cmd|' /C calc'!A1"
    junit = (tmp_path / "junit.xml").read_text()
    assert 'tests="5"' in junit
    assert "it lacks a .scenario.yaml" in junit


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name,email\na,b\n", "no column `submission`"),
        ("submission\na\na\n", "'a' is there twice"),
        (f"submission\n{'x' * 200_000}\n", "is no CSV"),
        (f"{'x' * 200_000}\na\n", "is no CSV"),
    ],
)
def test_a_roster_with_mistakes_is_refused(tmp_path, text, words):
    (tmp_path / "roster.csv").write_text(text)
    with pytest.raises(SpecError, match=words):
        read_roster(tmp_path / "roster.csv")


def test_gradescope_gets_points_reasons_and_margins_of_hidden_cases():
    document = gradescope(HIDDEN)
    assert document["score"] == 6 == sum(each["score"] for each in document["tests"])
    assert {each["max_score"] for each in document["tests"]} == {3, 1.5}
    assert all(set(each) == GRADESCOPE_TEST for each in document["tests"])
    assert {each["status"] for each in document["tests"]} == {"passed", "failed"}
    [failed] = [each for each in document["tests"] if each["status"] == "failed"]
    assert (failed["name"], failed["output"]) == (
        "hidden case 1: it is lifted",
        "margin -17.0 mm",
    )
    assert gradescope(NOTHING) == {**gradescope(NOTHING), "score": 0}
    assert "tests" not in gradescope(NOTHING)
    assert gradescope(NOTHING)["output"] == "it lacks a .scenario.yaml"


def test_classroom50_gets_whole_numbers_and_its_own_identity(tmp_path):
    grade = class_of(HIDDEN)
    model = grade.assignment.model.model_copy(update={"hidden": (HiddenCase(seed=7),)})
    grade = replace(grade, assignment=replace(grade.assignment, model=model))
    write_classroom50(grade, tmp_path / "result.json", ENVIRONMENT)
    document = json.loads((tmp_path / "result.json").read_text())
    assert document["schema"] == "classroom50/result/v1"
    assert (document["classroom"], document["assignment"]) == ("robots", "lift")
    assert document["review"] == document["commit"] == ENVIRONMENT["COMMIT_URL"]
    assert (document["score"], document["max-score"]) == (600, 900)
    for key in ("score", "max-score"):
        assert all(isinstance(each[key], int) for each in (document, *document["tests"]))
        assert document[key] == sum(each[key] for each in document["tests"])
    whole = classroom50(student("ada", PASSED), 1)
    assert (whole["score"], whole["max-score"]) == (9, 9)
    nothing = classroom50(NOTHING, 2)
    assert (nothing["score"], nothing["max-score"]) == (0, 900)
    assert [each["passed"] for each in nothing["tests"]] == [False]


def test_classroom50_is_refused_outside_its_runner(tmp_path):
    environment = {key: value for key, value in ENVIRONMENT.items() if key != "RELEASE_URL"}
    with pytest.raises(UsageError, match="RELEASE_URL is not set"):
        write_classroom50(class_of(GOOD), tmp_path / "result.json", environment)
    assert not (tmp_path / "result.json").exists()


def test_a_folder_for_gradescope_is_complete(tmp_path, capsys):
    assert main(["new", "--assignment", "gradescope", str(tmp_path / "new")]) == 0
    assert "autograder.zip" in capsys.readouterr().out
    assert read_assignment(tmp_path / "new/assignment").model.points == 6
    with zipfile.ZipFile(tmp_path / "new/autograder.zip") as archive:
        modes = {each.filename: each.external_attr >> 16 for each in archive.filelist}
        assert "armharness==" in archive.read("setup.sh").decode()
    assert {"setup.sh", "run_autograder", "assignment/assignment.yaml"} <= set(modes)
    assert all(modes[name] & 0o111 for name in ("setup.sh", "run_autograder"))
    for name in ("setup.sh", "run_autograder"):
        subprocess.run(["bash", "-n", str(tmp_path / "new" / name)], check=True)
    assert main(["new", "--assignment", "gradescope", str(tmp_path / "new")]) == 2
    assert "exists already" in capsys.readouterr().err


@pytest.mark.nightly
@pytest.mark.parametrize("system", ["gradescope", "classroom50"])
def test_the_written_script_grades_a_submission(tmp_path, system):
    """The script as the system starts it, with this installation and other folders."""
    main(["new", "--assignment", system, str(tmp_path / "source")])
    (tmp_path / "results").mkdir()
    (tmp_path / "submission").mkdir()
    (tmp_path / "submission/mine.scenario.yaml").write_text(SOLUTION)
    harness = tmp_path / "harness/bin/harness"
    harness.parent.mkdir(parents=True)
    harness.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m harness.cli "$@"\n')
    harness.chmod(0o755)
    environment = {**os.environ, **ENVIRONMENT, "PYTHONPATH": os.pathsep.join(sys.path)}
    environment |= {"AUTOGRADER": str(tmp_path), "INSTALLED": str(tmp_path)}
    file = tmp_path / "source" / {"gradescope": "run_autograder"}.get(system, "autograder.py")
    if system == "classroom50":
        whole = file.read_text().splitlines()
        lines = [line for line in whole if '"pip"' not in line]
        assert len(lines) == len(whole) - 1
        file.write_text("\n".join(lines))
    command = [str(file)] if system == "gradescope" else [sys.executable, str(file)]
    place = tmp_path / "submission"
    subprocess.run(command, cwd=place, env=environment, check=True)
    if system == "gradescope":
        document = json.loads((tmp_path / "results/results.json").read_text())
        assert document["score"] == 6 == sum(each["max_score"] for each in document["tests"])
    else:
        document = json.loads((place / "result.json").read_text())
        assert document["score"] == document["max-score"] == 6
        shutil.unpack_archive(place / "report.zip", tmp_path / "report")
        assert (tmp_path / "report/index.html").is_file()
        assert (tmp_path / "report/run/report.html").is_file()


@pytest.mark.nightly
def test_gradescopes_scripts_install_the_wheel_of_the_archive_and_grade(tmp_path):
    """As the README says for a trial, with the archive alone; packages come from the index."""
    uv = Path(pytest.importorskip("uv", reason="extra `test`").find_uv_bin())
    main(["new", "--assignment", "gradescope", str(tmp_path / "new")])
    build = [
        sys.executable,
        "-m",
        "build",
        "--wheel",
        "--no-isolation",
        "-o",
        str(tmp_path / "new"),
    ]
    subprocess.run([*build, str(ROOT)], check=True, capture_output=True)
    [line] = re.findall(r"python -m (zipfile -c [^`]*)`", (tmp_path / "new/README.md").read_text())
    [wheel] = (tmp_path / "new").glob("*.whl")
    words = [sys.executable, "-m", *line.replace("*.whl", wheel.name).split()]
    subprocess.run(words, cwd=tmp_path / "new", check=True)
    source = tmp_path / "trial/source"
    with zipfile.ZipFile(tmp_path / "new/autograder.zip") as archive:
        archive.extractall(source)
    for name in ("submission", "results"):
        (tmp_path / "trial" / name).mkdir()
    (tmp_path / "trial/submission/mine.scenario.yaml").write_text(SOLUTION)
    places = {"AUTOGRADER": str(tmp_path / "trial"), "INSTALLED": str(tmp_path / "opt")}
    python = str(Path(sys.executable).resolve())  # no other one of this machine, and no download
    path = os.pathsep.join([str(uv.parent), os.environ["PATH"]])
    environment = {**os.environ, **places, "UV_PYTHON": python, "PATH": path}
    for script in ("setup.sh", "run_autograder"):
        subprocess.run(["bash", str(source / script)], env=environment, cwd=tmp_path, check=True)
    document = json.loads((tmp_path / "trial/results/results.json").read_text())
    assert document["score"] == 6 == sum(each["max_score"] for each in document["tests"])
