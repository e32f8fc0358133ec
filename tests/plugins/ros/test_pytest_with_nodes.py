"""Scenarios whose arm is handed to a node, collected by pytest."""

import sys
from pathlib import Path

import pytest

from tests.plugins.ros.bridging import scenario

pytest_plugins = ["pytester"]
ROOT = Path(__file__).parents[3]
NODE = """
import os
from tests.plugins.ros.nodes import Node, follow, point
node = Node(int(os.environ["ROS_DOMAIN_ID"]))
node.ready()
node.send(follow(point(0.3, [0.2, 0, 0, 0])))
"""


INI = f"[pytest]\nharness_nodes =\n    student={sys.executable} student.py\n"


def test_a_command_that_the_ini_file_does_not_have_is_refused(pytester):
    scenario(pytester.path, "- external: {launch: teacher}")
    pytester.makeini(INI)
    result = pytester.runpytest_inprocess("--harness-no-report", "--harness-in-process")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*the command 'teacher' is not allowed*allowed: student*"])


@pytest.mark.nightly
def test_scenarios_are_graded_with_the_commands_of_the_ini_file_alone(pytester, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    pytester.makepyfile(student=NODE)
    until = "{joints: {positions: {joint1: 0.2}}}"
    for name in ("student", "teacher"):
        pytester.mkdir(name)
        scenario(pytester.path / name, f"- external: {{launch: {name}, until: {until}}}")
    pytester.makeini(INI)
    result = pytester.runpytest_subprocess("--harness-no-report", "-p", "no:randomly")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["*the command 'teacher' is not allowed*"])
