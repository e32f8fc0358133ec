"""A class of submissions: each gets its points, and none costs another one anything."""

import csv
import ctypes
import json
import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from contextlib import closing
from pathlib import Path

import pytest

from harness.cli.main import main
from harness.core.registry import registry
from harness.plugins.grading.assignment import Limits
from harness.plugins.grading.classroom.confined import (
    IS_SUBREAPER,
    SUBREAPER,
    Confinement,
    adopted_orphans,
    descendants,
)
from harness.plugins.grading.classroom.pages import distribution
from harness.plugins.grading.classroom.results import Criterion, advice
from tests.plugins.grading.classes import IK, SOLUTION, SUBMISSIONS, scenario_class
from tests.reporting.browser import new_context

EXERCISE = "the TCP is at the target"


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    """A class that hands in scenarios: the folder of its grades."""
    place = tmp_path_factory.mktemp("class")
    assignment, submissions = scenario_class(place)
    words = ["grade-class", str(assignment), str(submissions), "-j", "2"]
    assert main([*words, "--report-dir", str(place / "grades")]) == 1
    return place / "grades"


def rows(file):
    return {row["submission"]: row for row in csv.DictReader(file.read_text().splitlines())}


def page(graded, name):
    return (graded / "students" / name / "index.html").read_text()


def test_each_submission_gets_its_points(graded):
    found = {name: float(row["points"]) for name, row in rows(graded / "grades.csv").items()}
    assert found == {"perfect": 6, "constant": 4, "low": 2, "moves": 0, "broken": 0, "typo": 0}


def test_the_table_says_why_points_were_lost(graded):
    remarks = {name: row["remark"] for name, row in rows(graded / "grades.csv").items()}
    assert remarks["perfect"] == ""
    assert remarks["constant"] == f"hidden case 1: {EXERCISE}"
    assert re.search(r"TCP is off its target by \d+\.\d mm of 5.0 mm", remarks["low"])
    assert remarks["moves"].startswith("moves.yaml:5:5: the step `inject` changes the scene")
    assert "cannot be unpacked" in remarks["broken"]
    assert "typo.scenario.yaml:5:" in remarks["typo"]


def test_a_students_page_has_reasons_pictures_and_the_replay(graded):
    text = page(graded, "low")
    assert "2 of 6 points" in text
    assert 'href="run/report.html#' in text
    assert (graded / "students/low/run/report.html").is_file()
    assert "data:image/jpeg;base64," in text
    assert "every point" not in text


def test_students_see_margins_of_hidden_cases_and_not_the_cases(graded):
    texts = [page(graded, name) for name in ("constant", "perfect", "low")]
    assert all("0.31" not in text and "hidden" not in text.partition("<body>")[2].lower()
               .replace("hidden cases: margins", "") for text in texts)  # fmt: skip
    margin = re.search(r'class="number">(-\d+\.\d mm)', page(graded, "constant"))
    assert margin is not None
    for file in (graded / "students").rglob("*.yaml"):
        assert "0.31" not in file.read_text(), file
    assert (graded / "hidden/constant/1/report.html").is_file()
    assert not (graded / "hidden/perfect").exists()


def test_there_is_advice_on_every_built_in_expectation_and_no_other():
    known = registry("expectation")
    words = {word.removeprefix("never ") for word in advice()}
    assert words - set(known) == set()
    combining = {"always", "eventually", "never", "until", "formula"}
    assert set(known.built_in_modules) - words == combining


def test_the_page_of_the_class_shows_how_points_are_distributed(graded):
    text = (graded / "index.html").read_text()
    parts = re.findall(r'class="hidden">(?:from|all) ([\d.]+)[^<]* points: (\d+) submission', text)
    counted = {low: int(count) for low, count in parts if count != "0"}
    assert [low for low, _ in parts] == [str(low) for low in range(7)]
    assert counted == {"0": 3, "2": 1, "4": 1, "6": 1}


@pytest.mark.parametrize(
    ("points", "ends"),
    [
        (10, range(11)),
        (14, range(0, 15, 2)),
        (100, range(0, 101, 10)),
        (13, [0, 2, 4, 6, 8, 10, 12, 13]),
        (1, [each / 10 for each in range(11)]),
    ],
)
def test_bars_of_the_distribution_are_round_points_and_full_marks_have_their_own(points, ends):
    class Student:
        earned = points

    class Class:
        criteria = (Criterion("all", points),)
        students = (Student, Student)

    bars = distribution(Class)
    assert [low for low, _, _ in bars] == pytest.approx(list(ends))
    assert [count for _, _, count in bars] == [0] * (len(bars) - 1) + [2]


def test_the_page_of_the_class_shows_what_cost_most_and_what_only_hidden_cases_show(graded):
    text = (graded / "index.html").read_text()
    order = [text.index(f">{name} <span") for name in (EXERCISE, "the arm was up")]
    assert order == sorted(order)
    assert "the public case passes and a hidden one fails: constant" in text
    assert "What keeps submissions apart" in text


@pytest.mark.parametrize(
    ("name", "words", "advice"),
    [
        ("low", "the TCP is at the target: failed by", "→ The TCP is the point between"),
        ("constant", "Everything holds in the case that you see", "→ Take what varies from"),
        ("typo", "Line 5 of your file", "→ Did you mean `move_to`?"),
        (
            "moves",
            "Line 5 of your file, - inject: {stuck_joint: elbow_joint}: the step `inject`",
            "→ Leave the step out",
        ),
        ("broken", "cannot be graded", "→ Hand in what the exercise requires"),
        ("perfect", "", "→ Every expectation holds"),
    ],
)
def test_every_student_reads_what_to_do_next(graded, browser, name, words, advice):
    with closing(new_context(browser, viewport={"width": 390, "height": 900})) as context:
        opened = context.new_page()
        opened.goto((graded / "students" / name / "index.html").as_uri())
        said = opened.inner_text("#next")
        [shown] = opened.locator("#next .advice").all()
        arrow = shown.evaluate("p => getComputedStyle(p, '::before').content")
        assert words in said
        assert f"{arrow.strip(chr(34))} {shown.inner_text()}".startswith(advice)


def test_the_table_of_a_class_is_sorted_and_searched(graded, browser):
    with closing(new_context(browser, viewport={"width": 1440, "height": 900})) as context:
        opened = context.new_page()
        opened.goto((graded / "index.html").as_uri())
        names = opened.locator("#submissions tbody tr:visible td:first-child a")
        head = opened.get_by_role("columnheader", name="Points", exact=True).first
        head.get_by_role("button").click()
        assert names.all_inner_texts() == ["broken", "moves", "typo", "low", "constant", "perfect"]
        assert head.get_attribute("aria-sort") == "ascending"
        head.get_by_role("button").click()
        assert names.first.inner_text() == "perfect"
        opened.get_by_role("button", name="Submission").click()
        assert names.all_inner_texts() == sorted(names.all_inner_texts())
        assert head.get_attribute("aria-sort") is None
        opened.fill("#find input", "hidden CASE")
        assert names.all_inner_texts() == ["constant"]
        assert opened.inner_text("#find output") == "1 of 6"


def test_a_student_sees_the_moment_that_lost_the_points_next_to_the_advice(graded, browser):
    with closing(new_context(browser, viewport={"width": 1440, "height": 900})) as context:
        opened = context.new_page()
        opened.goto((graded / "students/low/index.html").as_uri())
        moment = opened.locator("#next a.moment")
        assert moment.get_attribute("href").startswith("run/report.html#t=1.9")
        assert moment.inner_text().startswith("2/2 move_to")
        assert moment.locator("img").evaluate("(img) => img.decode().then(() => img.naturalWidth)")
        opened.goto((graded / "students/perfect/index.html").as_uri())
        assert moment.count() == 0


def test_a_picture_says_what_failed_in_its_step_and_not_that_the_motion_passed(graded, browser):
    with closing(new_context(browser, viewport={"width": 1440, "height": 900})) as context:
        opened = context.new_page()
        opened.goto((graded / "students/low/index.html").as_uri())
        captions = opened.locator("figcaption").all_inner_texts()
        assert [each.split()[0] for each in captions] == ["1/2", "2/2"]
        assert [EXERCISE in each for each in captions] == [False, True]
        assert "passed" not in " ".join(captions)
        sizes = """[...document.querySelectorAll("figcaption, figcaption *")]
            .map(each => parseFloat(getComputedStyle(each).fontSize))"""
        assert min(opened.evaluate(sizes)) >= 12
        shapes = """[...document.querySelectorAll(".pictures img")].map(image =>
            image.clientHeight / image.clientWidth
            - (image.naturalHeight - 26) / image.naturalWidth)"""
        assert opened.evaluate(shapes) == pytest.approx([0, 0], abs=0.01), "the strip is cut off"
        link = opened.locator("figure a").last.get_attribute("href")
        assert (graded / "students/low" / link).is_file()


@pytest.mark.nightly
@pytest.mark.parametrize(
    "steps",
    [
        "[{move_to: {joints: {joint1: 0.5}}}, {move_to: {joints: {joint1: 9}}}]",
        "[{gripper: open}, {move_to: {position: {xyz: [3, 0, 0]}, pitch: 0}}]",
    ],
)
def test_what_was_not_reached_is_no_failure_of_a_picture(tmp_path, browser, steps):
    for folder in ("safe", "all"):
        (tmp_path / folder).mkdir()
    (tmp_path / "safe/safe.scenario.yaml").write_text(SAFE)
    (tmp_path / "safe/assignment.yaml").write_text("assignment: a\nscenario: safe.scenario.yaml\n")
    (tmp_path / "all/one.scenario.yaml").write_text(f"scenario: a\nsteps: {steps}\n")
    words = ["grade-class", str(tmp_path / "safe"), str(tmp_path / "all")]
    assert main([*words, "--report-dir", str(tmp_path / "grades")]) == 1
    with closing(new_context(browser, viewport={"width": 1440, "height": 900})) as context:
        opened = context.new_page()
        opened.goto((tmp_path / "grades/students/one/index.html").as_uri())
        captions = opened.locator("figcaption").all_inner_texts()
    [where] = [each for each in captions if "where the robot stopped" in each]
    [why] = [each for each in captions if "the goal that was refused" in each]
    assert (where.split()[0], why.split()[0]) == ("2/2", "2/2")
    assert not any("home" in each for each in captions), "that it is reached was not judged"


def test_a_mistake_of_a_file_is_said_once(graded):
    assert page(graded, "typo").count("no verb is called") == 1


@pytest.mark.nightly(but=["390"])
@pytest.mark.parametrize("width", [1440, 390])
def test_no_cell_of_a_table_covers_another_one(graded, browser, width):
    covering = """[...document.querySelectorAll("td")].filter(td => {
        const content = document.createRange(); content.selectNodeContents(td);
        return content.getBoundingClientRect().right > td.getBoundingClientRect().right + 1;
    }).map(td => td.textContent)"""
    with closing(new_context(browser, viewport={"width": width, "height": 900})) as context:
        opened = context.new_page()
        for name in ("index.html", "students/low/index.html", "students/perfect/index.html"):
            opened.goto((graded / name).as_uri())
            assert opened.evaluate(covering) == [], name
            heads = opened.locator("thead th")
            assert all(each.is_visible() == (width == 1440) for each in heads.all()), name
            assert opened.evaluate("document.documentElement.scrollWidth") == width
        opened.goto((graded / "index.html").as_uri())
        heights = opened.eval_on_selector_all(
            ".distribution i", "bars => bars.map(bar => bar.getBoundingClientRect().height)"
        )
        assert heights[0] == pytest.approx(3 * heights[2], rel=0.02), "3 submissions and 1"


def test_tables_for_other_programs_have_everybody(graded):
    junit = ET.parse(graded / "junit.xml").getroot()
    assert {each.get("name") for each in junit.iter("testsuite")} == set(
        rows(graded / "grades.csv")
    )
    for name in ("nbgrader.csv", "moodle.csv", "canvas.csv"):
        assert "perfect" in (graded / name).read_text()


@pytest.mark.nightly(but=["forging"])
@pytest.mark.parametrize("name", SUBMISSIONS)
def test_a_function_is_graded_in_a_process_of_its_own(name, tmp_path, monkeypatch):
    """Perfect, wrong in one branch, 17 mm low, constant, hanging, crashing, writing results."""
    monkeypatch.setenv("GRADES", str(tmp_path / "grades"))
    (tmp_path / "ik").mkdir()
    (tmp_path / "ik/assignment.yaml").write_text(IK)
    (tmp_path / "all").mkdir()
    (tmp_path / "all" / f"{name}.py").write_text(SUBMISSIONS[name].text)
    words = ["grade-class", str(tmp_path / "ik"), str(tmp_path / "all")]
    code = main([*words, "--report-dir", str(tmp_path / "grades")])
    row = rows(tmp_path / "grades/grades.csv")[name]
    expected = SUBMISSIONS[name]
    assert code == int(expected.points < 7)
    assert expected.points == 7 or float(row["points"]) <= expected.points, row
    assert expected.points < 7 or float(row["points"]) == 7, row
    assert expected.remark in row["remark"]
    assert not [pid for pid in descendants(os.getpid()) if "sleep(1000)" in command_line(pid)]


SAFE = """\
scenario: Reach a target safely
robot: {model: open_manipulator_x}
steps: [{move_to: init}]
expect:
  - within_limits: {}
    points: 2
  - {never: {collision: {between: [robot, any]}}, points: 3}
  - duration: {at_most: 60 s}
    points: 1
  - {eventually: {named_target: home}, points: 4}
"""
SAFELY = {
    "gripper": ("[{gripper: open}, {move_to: {position: {xyz: [3, 0, 0]}, pitch: 0}}]", 0),
    "waiting": ("[{wait: 1 s}]", 0),
    "halfway": ("[{move_to: {joints: {joint1: 0.5}}}, {move_to: {joints: {joint1: 9}}}]", 5),
    "reaching": ("[{move_to: home}]", 10),
}


@pytest.mark.nightly
def test_what_holds_because_the_robot_did_not_move_earns_nothing(tmp_path):
    for folder in ("safe", "all"):
        (tmp_path / folder).mkdir()
    (tmp_path / "safe/safe.scenario.yaml").write_text(SAFE)
    (tmp_path / "safe/assignment.yaml").write_text("assignment: a\nscenario: safe.scenario.yaml\n")
    for name, (steps, _) in SAFELY.items():
        (tmp_path / f"all/{name}.scenario.yaml").write_text(f"scenario: a\nsteps: {steps}\n")
    words = ["grade-class", str(tmp_path / "safe"), str(tmp_path / "all"), "-j", "2"]
    assert main([*words, "--report-dir", str(tmp_path / "grades")]) == 1
    found = rows(tmp_path / "grades/grades.csv")
    points = {name: float(row["points"]) for name, row in found.items()}
    assert points == {name: points for name, (_, points) in SAFELY.items()}
    assert "the robot did not move" in page(tmp_path / "grades", "waiting")
    report = (tmp_path / "grades/students/halfway/run/run.json").read_text()
    assert {each["line"] for each in json.loads(report)["steps"]} == {2}
    assert {each["line"] for each in json.loads(report)["verdicts"]} == {0}
    assert json.loads(report)["file"] == "halfway.scenario.yaml"


@pytest.mark.nightly
def test_a_report_that_cannot_be_written_costs_its_page_and_no_points(tmp_path):
    """Files of the case have at most 1 MB, as on a full disk; 40 s of simulation need more."""
    assignment, _ = scenario_class(tmp_path)
    text = (assignment / "assignment.yaml").read_text().replace("30 s}", "60 s, files: 1}")
    (assignment / "assignment.yaml").write_text(text.partition("hidden")[0] + text.splitlines()[-1])
    (tmp_path / "all").mkdir()
    (tmp_path / "all/short.scenario.yaml").write_text(SOLUTION)
    long = SOLUTION.replace("  - move_to: up\n", "  - move_to: up\n  - wait: 40 s\n")
    (tmp_path / "all/long.scenario.yaml").write_text(long)
    words = ["grade-class", str(assignment), str(tmp_path / "all"), "-j", "2"]
    assert main([*words, "--report-dir", str(tmp_path / "grades")]) == 0
    assert "File too large" in page(tmp_path / "grades", "long")
    assert not (tmp_path / "grades/students/long/run").exists()
    assert (tmp_path / "grades/students/short/run/report.html").is_file()


def command_line(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_text(errors="replace")
    except OSError:
        return ""


@pytest.mark.nightly(but=[1, 3, 4])
@pytest.mark.parametrize(
    ("code", "limits", "words"),
    [
        ("a = [bytearray(10**7) for _ in range(100)]", {"memory": 300}, "MemoryError"),
        ("open('a', 'wb').write(bytes(3 * 10**6))", {"files": 2}, "File too large"),
        ("import time\nfor i in range(9):\n    open(str(i), 'wb').write(bytes(10**6))\n"
         "time.sleep(60)", {"files": 2}, "MB of files, 2 may be"),
        ("import subprocess, sys, time\nfor _ in range(5):\n    subprocess.Popen([sys.executable,"
         " '-c', 'import time; time.sleep(60)'], start_new_session=True)\ntime.sleep(60)",
         {"processes": 3}, "processes and threads, 3 may be"),
        ("while True: pass", {"processor_time": 0.1}, "s of processor time, 0.1 may be"),
        ("import os\nfor _ in range(3): os.fork()\nwhile True: pass",
         {"processor_time": 0.4}, "s of processor time, 0.4 may be"),
        ("import os, time\nfor _ in range(6): os.fork()\ntime.sleep(60)", {"processes": 20},
         "processes and threads, 20 may be"),
    ],
)  # fmt: skip
def test_a_program_is_ended_at_its_bounds_with_all_that_it_started(tmp_path, code, limits, words):
    (tmp_path / "a.py").write_text(code)
    bounds = Confinement(tmp_path, tmp_path, Limits.model_validate(limits))
    before = set(descendants(os.getpid()))
    done = subprocess.run(
        bounds.command([sys.executable, "a.py"]), capture_output=True, text=True, check=False
    )
    assert done.returncode != 0
    assert words in done.stderr
    assert set(descendants(os.getpid())) <= before


@pytest.mark.parametrize("before", [0, 1])
def test_orphans_are_adopted_for_the_time_of_a_class(before):
    libc, found = ctypes.CDLL(None), ctypes.c_int(-1)
    libc.prctl(SUBREAPER, before, 0, 0, 0)
    try:
        with adopted_orphans():
            libc.prctl(IS_SUBREAPER, ctypes.byref(found), 0, 0, 0)
            assert found.value == 1
        libc.prctl(IS_SUBREAPER, ctypes.byref(found), 0, 0, 0)
        assert found.value == before
    finally:
        libc.prctl(SUBREAPER, 0, 0, 0, 0)


def test_a_folder_with_other_files_is_not_written_into(tmp_path, capsys):
    assignment, submissions = scenario_class(tmp_path)
    (tmp_path / "home").mkdir()
    (tmp_path / "home/thesis.txt").write_text("x")
    words = ["grade-class", str(assignment), str(submissions), "--report-dir"]
    assert main([*words, str(tmp_path / "home")]) == 2
    assert "has other files" in capsys.readouterr().err
    assert [file.name for file in (tmp_path / "home").iterdir()] == ["thesis.txt"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("seed: 1", "parametrize: {params.x: [0.3, 0.31]}", "the scenario has several cases"),
        ("- move_to: up", "- {move_to: up, expect: [{duration: {at_most: 9, points: 2}}]}",
         "points of a step are lost"),
        ("points: 1", "points: 0", ""),
        ("steps:", "stepps:", "steps"),
    ],
)  # fmt: skip
def test_an_assignment_that_cannot_grade_is_refused_before_anything_runs(
    tmp_path, capsys, old, new, words
):
    assignment, submissions = scenario_class(tmp_path)
    file = assignment / "reach.scenario.yaml"
    text = file.read_text().replace(old, new)
    file.write_text(text.replace("points: 2", "points: 0") if not words else text)
    code = main(
        ["grade-class", str(assignment), str(submissions), "--report-dir", str(tmp_path / "g")]
    )
    assert code == 2
    assert (words or "no expectation of the file has points") in capsys.readouterr().err
    assert not (tmp_path / "g").exists()


@pytest.mark.nightly(but=["{set: {objects.bx.mass: 1}}-bx"])
@pytest.mark.parametrize(
    ("hidden", "words"),
    [
        ("{set: {objects.bx.mass: 1}}", "bx"),
        ("{set: {params.y: 3}}", "y"),
        ("{set: {params.x: far}}", "far"),
        ("{robot: open_manipulator_y}", "did you mean `open_manipulator_x`"),
    ],
)
def test_a_hidden_case_that_the_scenario_cannot_be_is_refused_at_its_line(
    tmp_path, capsys, hidden, words
):
    """It would cost every student points, and students see no reason of hidden cases."""
    assignment, submissions = scenario_class(tmp_path)
    file = assignment / "assignment.yaml"
    lines = [line for line in file.read_text().splitlines() if not line.startswith("hidden")]
    file.write_text("\n".join([*lines, f"hidden: [{{seed: 3}}, {hidden}]", ""]))
    command = [
        "grade-class",
        str(assignment),
        str(submissions),
        "--report-dir",
        str(tmp_path / "g"),
    ]
    assert main(command) == 2
    said = capsys.readouterr().err
    assert f"assignment.yaml:{len(lines) + 1}:" in said
    assert "hidden case 2: " in said
    assert words in said
    assert not (tmp_path / "g").exists()


def test_results_for_a_grading_system_are_of_one_submission(tmp_path, capsys):
    assignment, submissions = scenario_class(tmp_path)
    shutil.rmtree(assignment.parent / "submissions")
    words = ["grade-class", str(assignment), str(submissions), "--gradescope", "r.json"]
    assert main(words) == 2
    assert "add --one" in capsys.readouterr().err
    assert main([*words, "--one"]) == 2
    assert "no such file or folder" in capsys.readouterr().err


def test_a_damaged_submission_alone_still_writes_results(tmp_path):
    assignment, _ = scenario_class(tmp_path)
    (tmp_path / "submission").mkdir()
    file = tmp_path / "results/results.json"
    words = ["grade-class", str(assignment), str(tmp_path / "submission"), "--one"]
    words += ["--report-dir", str(tmp_path / "grades"), "--gradescope", str(file)]
    assert main(words) == 0
    document = json.loads(file.read_text())
    assert (document["score"], document["output"]) == (0, "it lacks a .scenario.yaml")
