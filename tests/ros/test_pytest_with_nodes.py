"""Scenarios whose arm is handed to a node, collected by pytest."""

import sys
from pathlib import Path

import pytest

from tests.ros.bridging import scenario

pytest_plugins = ["pytester"]
ROOT = Path(__file__).parents[2]
NODE = """
import os
from tests.ros.nodes import Node, follow, point
node = Node(int(os.environ["ROS_DOMAIN_ID"]))
node.ready()
node.send(follow(point(0.3, [0.2, 0, 0, 0])))
"""


@pytest.mark.parametrize("is_allowed", [True, False])
def test_a_scenario_is_graded_with_the_command_of_the_ini_file(pytester, monkeypatch, is_allowed):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    pytester.makepyfile(student=NODE)
    until = "{joints: {positions: {joint1: 0.2}}}"
    scenario(pytester.path, f"- external: {{launch: student, until: {until}}}")
    name = "student" if is_allowed else "teacher"
    pytester.makeini(f"[pytest]\nharness_nodes =\n    {name}={sys.executable} student.py\n")
    result = pytester.runpytest_subprocess("--harness-no-report", "-p", "no:randomly")
    result.assert_outcomes(passed=int(is_allowed), failed=int(not is_allowed))
    if not is_allowed:
        result.stdout.fnmatch_lines(["*the command 'student' is not allowed*"])
