import os
import subprocess
import sys
from pathlib import Path

import pytest

from harness.core.resources import existing_or_bundled, with_short_names
from harness.suite.discovery import UsageError, bundled_scenarios, discover
from harness.suite.folders import report_folders
from harness.suite.header import ScenarioHeader, read_header
from harness.suite.leftovers import clean_leftovers
from harness.suite.selection import selects


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("b.scenario.yaml", "sub/a.scenario.yaml", "sub/.git/c.scenario.yaml", "x.yaml"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(f"scenario: The {Path(name).stem}\n")
    return tmp_path


def test_a_folder_gives_its_scenarios_at_any_depth_in_order_of_their_names():
    assert discover(["."]) == [Path("b.scenario.yaml"), Path("sub/a.scenario.yaml")]


def test_a_file_may_have_any_name_and_is_taken_once():
    assert discover(["x.yaml", "sub", "sub/a.scenario.yaml", "./x.yaml"]) == [
        Path("x.yaml"),
        Path("sub/a.scenario.yaml"),
    ]


def test_a_missing_file_is_wrong_usage_with_the_nearest_name():
    with pytest.raises(UsageError) as caught:
        discover(["sub/aa.scenario.yaml"])
    assert str(caught.value) == (
        "no such file or folder: 'sub/aa.scenario.yaml'; did you mean 'sub/a.scenario.yaml'?"
    )


def test_a_folder_without_scenarios_is_wrong_usage(folder):
    (folder / "empty").mkdir()
    with pytest.raises(UsageError, match=r"no \*\.scenario\.yaml in folder 'empty'"):
        discover(["empty"])


def test_bundled_scenarios_are_found_by_name_where_no_such_path_is():
    lessons = discover(["lessons"])
    assert len(lessons) == len([name for name in bundled_scenarios() if "lessons/" in name]) >= 5
    name = "lessons/03_ur_sixteen_steps"
    assert discover([name]) == discover([f"{name}.scenario.yaml"]) == [bundled_scenarios()[name]]


def test_a_path_of_the_user_comes_before_a_bundled_name(folder):
    (folder / "lessons").mkdir()
    (folder / "lessons/mine.scenario.yaml").write_text("scenario: Mine\n")
    assert discover(["lessons"]) == [Path("lessons/mine.scenario.yaml")]


def test_reports_of_files_with_the_same_name_have_folders_of_their_own(folder):
    files = [folder / "b.scenario.yaml", folder / "sub/b.scenario.yaml"]
    assert report_folders(files, Path("r")) == [Path("r/b"), Path("r/sub/b")]
    assert report_folders([files[0], folder / "b.yaml"], Path("r")) == [Path("r/b"), Path("r/b-2")]


def test_a_report_is_never_inside_another_files_report(folder):
    (folder / "sub.scenario.yaml").write_text("scenario: Next to the folder sub\n")
    files = discover(["."])
    folders = report_folders(files, Path("r"))
    assert folders == [Path("r/b"), Path("r/sub/a"), Path("r/sub.scenario")]


def test_reports_of_bundled_and_of_far_files_stay_below_the_report_folder(tmp_path_factory):
    far = tmp_path_factory.mktemp("far") / "f.scenario.yaml"
    [bundled, other] = report_folders([*discover(["lessons/03_ur_sixteen_steps"]), far], Path("r"))
    assert bundled == Path("r/lessons/03_ur_sixteen_steps")
    assert other.parts[0] == "r"
    assert other.name == "f"
    assert ".." not in other.parts


def test_a_header_is_title_tags_and_line(folder):
    file = folder / "b.scenario.yaml"
    file.write_text("# first\ntags: [lesson, ur]\nscenario: >\n  Pick\n  it\n")
    assert read_header(file) == ScenarioHeader("Pick it", ("lesson", "ur"), 3)


@pytest.mark.parametrize(
    "text", ["", "scenario: [", "- a", "scenario: 3\ntags: x", "[" * 20000, "\x00"]
)
def test_a_broken_file_has_its_name_as_title(folder, text):
    file = folder / "b.scenario.yaml"
    file.write_text(text)
    assert read_header(file).title == "b"


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("pick", True),
        ("PICK and cylinder", True),
        ("place", False),
        ("not place", True),
        ("place or lesson", True),
        ("place or (ur and not lesson)", False),
        ("not (place or ur)", False),
        ("scenarios/b", True),
    ],
)
def test_k_selects_by_words_of_path_title_and_tags(expression, expected):
    header = ScenarioHeader("Pick the green cylinder", ("lesson", "ur"))
    assert selects(expression, Path("scenarios/b.scenario.yaml"), header) is expected


@pytest.mark.parametrize("expression", ["(pick", "pick and", "and", "pick place", "pick)", "not"])
def test_an_expression_that_cannot_be_read_is_wrong_usage(expression):
    with pytest.raises(UsageError, match="-k"):
        selects(expression, Path("a"), ScenarioHeader("a"))


def dead_pid():
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def test_what_dead_writers_left_is_removed_and_an_older_report_put_back(folder):
    report = folder / "r" / "case"
    attic = folder / f"r/.case.old.{dead_pid()}.0"
    half = folder / f"r/.case.writing.{dead_pid()}.3"
    alive = folder / f"r/.case.writing.{os.getpid()}.0"
    other = folder / f"r/.other.writing.{dead_pid()}.0"
    for each in (attic / "case", half, alive, other):
        each.mkdir(parents=True)
    (attic / "case" / "run.json").write_text("older")
    clean_leftovers(report)
    assert (report / "run.json").read_text() == "older"
    assert sorted(each.name for each in (folder / "r").iterdir()) == sorted(
        [alive.name, other.name, "case"]
    )


@pytest.mark.parametrize("name", ["scenarios/lessons", "scenarios/failures/timed_out"])
def test_names_of_the_repository_work_without_it(name):
    assert discover([name]) == discover([name.removeprefix("scenarios/")]) != []


def test_python_files_and_robots_of_scenarios_are_found_by_bundled_names():
    found = existing_or_bundled(Path("scenarios/ik_test/student_ik.py"))
    assert found == existing_or_bundled(Path("ik_test/student_ik.py"))
    assert found.is_file()


def test_a_file_of_the_user_comes_before_a_bundled_one(folder):
    mine = Path("ik_test/student_ik.py")
    (folder / "ik_test").mkdir()
    mine.touch()
    assert existing_or_bundled(mine) == mine


@pytest.mark.parametrize("name", ["no/such.py", "../scenarios/ik_test/student_ik.py", "/etc/x"])
def test_what_is_no_bundled_file_stays_as_it_is(name):
    assert existing_or_bundled(Path(name)) == Path(name)


def test_a_bundled_file_is_printed_by_a_name_that_finds_it(folder):
    [file] = discover(["lessons/04_gripper_alone"])
    name = "lessons/04_gripper_alone.scenario.yaml"
    assert with_short_names(f"FAILED {file}:7: it fell") == f"FAILED {name}:7: it fell"
    assert discover([name]) == [file]
    (folder / "lessons").mkdir()
    (folder / name).touch()
    assert with_short_names(f"FAILED {file}:7") == f"FAILED {file}:7"
