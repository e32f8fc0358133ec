"""The Python blocks of guides that no other test runs, with a scenario that needs them."""

import re
import shutil
import subprocess
import sys

import pytest

from docs import ROOT
from tests.commands import harness

BLOCK = re.compile(r"(?ms)^```python\n(.*?)^```$")
GUIDE = BLOCK.findall((ROOT / "docs/guides/python.md").read_text(encoding="utf-8"))
IK_GUIDE = BLOCK.findall((ROOT / "docs/guides/ik_test.md").read_text(encoding="utf-8"))
SCENARIO = """\
scenario: A motion
steps: [{move_to: %s}]
expect: [{always: within_limits}]
"""
PLUG_INS = {
    "class ViaPoint": SCENARIO % "up" + "robot: ur3e\nplanning: {pipeline: via_point}\n",
    "class ComputedTorque": SCENARIO % "up"
    + "robot: {model: ur3e, joint_controller: computed_torque}\n",
    "class Crates": SCENARIO % "home" + "robot: small_arm\nworld: cell.crates\n",
}
"""A scenario that needs the plug-ins of a block, by words of the block."""
ELSEWHERE = {
    "overrides={": "tests/suite/test_api.py",
    "robot=": "tests/suite/test_api.py",
    "class Remark(": "tests/suite/test_api.py",
    "(Predicate)": "tests/suite/test_api.py",
    "class Nod(": "tests/plugins/test_a_step_that_moves_the_arm.py",
    "(IkSolver)": "tests/plugins/test_ik_solvers.py",
    "(Command)": "tests/plugins/test_worked_examples.py",
}
"""Tests that run the other blocks, by words of the block."""


@pytest.mark.nightly
@pytest.mark.parametrize("words", PLUG_INS)
def test_the_plug_ins_of_a_block_are_used_by_a_scenario(words, tmp_path):
    [block] = [each for each in GUIDE if words in each]
    (tmp_path / "own.py").write_text(block, encoding="utf-8")
    (tmp_path / "cell.crates").write_text("left 0.6 0.5 0.05\nright 0.6 -0.5 0.05\n")
    shutil.copytree(ROOT / "robots/open_manipulator_x", tmp_path / "robots/small_arm")
    facts = tmp_path / "robots/small_arm/robot.yaml"
    facts.write_text(facts.read_text().replace("robot: open_manipulator_x", "robot: small_arm"))
    (tmp_path / "move.scenario.yaml").write_text(PLUG_INS[words])
    reporter = ["--reporter", "margins"] if "class Margins" in block else []
    command = ["run", "move.scenario.yaml", "--plugin", "own.py", *reporter]
    done = harness(*command, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    written = [file.read_text() for file in tmp_path.rglob("margins.txt")]
    assert len(written) == bool(reporter)
    assert all("within limits" in text for text in written)


def run_pytest(folder, text):
    (folder / "test_own.py").write_text(text, encoding="utf-8")
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_own.py"]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 passed" in done.stdout


@pytest.mark.nightly
def test_the_fixture_of_the_guide_runs_a_scenario_in_pytest(tmp_path):
    (tmp_path / "pick.scenario.yaml").write_text(SCENARIO % "up" + "robot: {model: ur3e}\n")
    run_pytest(tmp_path, next(each for each in GUIDE if "harness_scenario" in each))


@pytest.mark.nightly
@pytest.mark.parametrize("words", ["check_ik", "reachable_poses"])
def test_the_tests_of_the_guide_to_inverse_kinematics_run(words, tmp_path):
    shutil.copy(ROOT / "scenarios/ik_test/corrected_ik.py", tmp_path / "my_ik.py")
    [block] = [each for each in IK_GUIDE if words in each]
    own = "def my_property(pose, joint_positions):\n    return len(joint_positions) == 6\n\n\n"
    run_pytest(tmp_path, own + block)


def test_every_block_of_the_guide_is_run():
    words = [*PLUG_INS, *ELSEWHERE, "harness_scenario"]
    assert [block for block in GUIDE if not any(each in block for each in words)] == []
    assert [each for each in words if not any(each in block for block in GUIDE)] == []
    assert all((ROOT / file).is_file() for file in ELSEWHERE.values())
