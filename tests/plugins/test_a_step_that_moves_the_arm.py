"""The guide's step that moves the arm, and where the mistakes of a plug-in are reported."""

import re
from pathlib import Path

import pytest

from tests.plugins.commands import harness

PAGE = Path(__file__).parents[2].joinpath("docs/guides/python.md").read_text(encoding="utf-8")
NOD = next(
    code for code in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL) if "class Nod(" in code
)
SCENARIO = """\
scenario: a nod
robot: open_manipulator_x
objects:
  - {name: cube, box: {size: [2 cm, 2 cm, 2 cm]}, pose: {xyz: [0.2, 0, %s]}, static: true}
steps:
  - nod: {object: cube, by: 3 cm}
expect:
  - joints: {positions: {joint1: 0}, tolerance: 1 deg}
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "nod.py").write_text(NOD)
    (tmp_path / "nod.scenario.yaml").write_text(SCENARIO % 0.01)
    return tmp_path


def run(folder, command="run", code=0):
    more = ["--no-report"] if command == "run" else []
    return harness(folder, command, "nod.scenario.yaml", "--plugin", "nod.py", *more, code=code)


@pytest.mark.nightly
def test_the_guide_s_step_moves_the_arm(folder):
    assert "3 steps" in run(folder)
    assert "nod.scenario.yaml: ok" in run(folder, "check")
    (folder / "nod.scenario.yaml").write_text(SCENARIO % 0.5)
    assert "GOAL_STATE_INVALID: 'cube' is above the TCP" in run(folder, code=1)


@pytest.mark.nightly(
    but=[
        f"return self.object\\n-return self.objekt\\n-return self.objekt-AttributeError-{command}"
        for command in ("run", "check")
    ]
)
@pytest.mark.parametrize("command", ["run", "check"])
@pytest.mark.parametrize(
    ("right", "wrong", "line", "error"),
    [
        ("cell.run_children(", "cell.run_child(", "cell.run_child(", "AttributeError"),
        ("return self.object\n", "return self.objekt\n", "return self.objekt", "AttributeError"),
        ("at.scope.check_present(", "1 / 0, (", "1 / 0, (", "ZeroDivisionError"),
        ("cell.frame(self.object)", "cell.frame([])", "cell.frame([])", "TypeError"),
    ],
)
def test_a_mistake_is_located_in_the_plugin(folder, command, right, wrong, line, error):
    """Without the lines of the program through which it was called, or which it called."""
    (folder / "nod.py").write_text(NOD.replace(right, wrong))
    said = run(folder, command, code=3)
    assert "a plug-in raised an exception" in said
    number = NOD.replace(right, wrong)[: NOD.replace(right, wrong).index(line)].count("\n") + 1
    assert re.search(rf"nod\.py\", line {number}, in ", said)
    assert error in said
    assert "nod.py" in said[said.index("File ") :].splitlines()[0]
    assert "harness/" not in said.replace("nod.scenario.yaml", "")


def test_a_plugin_that_cannot_be_imported_says_in_which_line(folder):
    (folder / "nod.py").write_text(NOD + "\nclass Other(Stepp):\n    pass\n")
    said = run(folder, code=2)
    assert f"name 'Stepp' is not defined (nod.py:{NOD.count(chr(10)) + 2})" in said


TURN = """\
from harness.steps import At, Cell, Ptp, Step


class Turn(Step):
    \"\"\"Turn a joint that the arm may not have.\"\"\"

    verb = "turn"

    def summary(self) -> str:
        return "a turn"

    def execute(self, cell: Cell) -> None:
        cell.run_children([cell.child("turn", Ptp(joints={"%s": 0.01}), "ptp")])
"""


@pytest.mark.nightly(but=["gripper_left_joint"])
@pytest.mark.parametrize("joint", ["gripper_left_joint", "elbow"])
def test_a_motion_made_by_a_step_names_joints_of_its_group(tmp_path, joint):
    (tmp_path / "nod.py").write_text(TURN % joint)
    (tmp_path / "nod.scenario.yaml").write_text(
        "scenario: a turn\nrobot: open_manipulator_x\nsteps: [turn]\n"
    )
    shown = run(tmp_path, code=1)
    assert f"INVALID_GOAL_CONSTRAINTS: there is no joint '{joint}' of 'arm'" in shown
