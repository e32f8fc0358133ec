"""ROS 2 nodes that a class hands in, with their messages on the wire; without ROS."""

import csv
import shutil
import sys

import pytest

from docs import ROOT
from harness.cli.main import main

ASSIGNMENT = f"""\
assignment: Lift the red box
scenario: ros2/01_lift_the_red_box
node: {sys.executable} student.py
limits: {{processes: 64}}
"""
CRASHING = "raise SystemExit('no idea how this works')\n"


@pytest.fixture
def graded(tmp_path, monkeypatch):
    """Grades nodes by their names: the rows of the table, and the folder of pages."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    (tmp_path / "lift").mkdir()
    (tmp_path / "lift/assignment.yaml").write_text(ASSIGNMENT)

    def grade(**nodes):
        for name, text in nodes.items():
            folder = tmp_path / "class" / name
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "student.py").write_text(text)
        words = ["grade-class", str(tmp_path / "lift"), str(tmp_path / "class"), "--report-dir"]
        main([*words, str(tmp_path / "grades")])
        with (tmp_path / "grades/grades.csv").open() as table:
            return {row["submission"]: row for row in csv.DictReader(table)}, tmp_path / "grades"

    return grade


@pytest.mark.nightly
def test_a_node_that_crashes_earns_nothing_and_its_words_are_on_the_page(graded):
    table, folder = graded(crashing=CRASHING)
    assert float(table["crashing"]["points"]) == 0
    text = (folder / "students/crashing/index.html").read_text()
    assert "no idea how this works" in text
    assert "the robot did not move" in text or "too slow" in text  # for a verdict on the node


@pytest.mark.nightly
def test_a_node_that_lifts_the_box_earns_every_point(graded):
    text = (ROOT / "tests/plugins/ros/lift_the_box.py").read_text()
    for _ in range(3):  # a machine that cannot keep the pace judges no node
        table, folder = graded(lifting=text, crashing=CRASHING)
        if "too slow" not in table["lifting"]["remark"]:
            break
        shutil.rmtree(folder)
    points = {name: float(row["points"]) for name, row in table.items()}
    assert points == {"lifting": 10, "crashing": 0}, table
    assert (folder / "students/lifting/run/report.html").is_file()
