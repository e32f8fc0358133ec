"""Scenarios whose arm is handed to a node, collected by pytest."""

import sys
from pathlib import Path

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


def test_scenarios_are_graded_with_the_commands_of_the_ini_file_alone(pytester, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    pytester.makepyfile(student=NODE)
    until = "{joints: {positions: {joint1: 0.2}}}"
    for name in ("student", "teacher"):
        pytester.mkdir(name)
        scenario(pytester.path / name, f"- external: {{launch: {name}, until: {until}}}")
    pytester.makeini(f"[pytest]\nharness_nodes =\n    student={sys.executable} student.py\n")
    result = pytester.runpytest_subprocess("--harness-no-report", "-p", "no:randomly")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["*the command 'teacher' is not allowed*"])
