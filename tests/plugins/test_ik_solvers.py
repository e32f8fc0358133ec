"""A third-party inverse kinematics solver is selected by name, and its answers are verified."""

import json
import re

import pytest

from docs import ROOT
from tests.plugins.commands import MODULES, harness

SCENARIO = """\
scenario: to a pose
robot: {model: ur3e, ik_solver: newton}
steps:
  - move_to: {pose: {xyz: [0.3, 0.1, 0.3], rpy: [180 deg, 0, 0]}}
  - move_to: {position: [0.3, 0.0, 0.3]}
"""
SOLVERS = ("--plugin", MODULES / "ik_solvers.py")
WRONG = '''
import numpy as np
from harness.ports import IkRequest, IkResult, IkSolver


class Mine(IkSolver):
    """A solver under test."""

    name = "mine"

    def solve(self, request: IkRequest) -> IkResult:
        return [lambda: 1 / 0, lambda: IkResult(([0.0, 1.0],)), lambda: None][
            int(request.goal.pose.translation[0] * 10)
        ]()
'''


@pytest.fixture
def scenario(tmp_path):
    """The folder of a scenario that names a solver."""
    (tmp_path / "pose.scenario.yaml").write_text(SCENARIO, encoding="utf-8")
    return tmp_path


def steps(folder):
    (file,) = folder.glob("reports/**/run.json")
    return json.loads(file.read_text(encoding="utf-8"))["steps"]


@pytest.mark.nightly
def test_a_solver_is_used_where_it_fits_and_explained_by_its_name(scenario):
    harness(scenario, "run", "pose.scenario.yaml", *SOLVERS)
    pose, position = steps(scenario)
    assert pose["explanation"]["ik_method"] == "newton"
    assert position["explanation"]["ik_method"] == "numeric"


@pytest.mark.nightly
def test_wrong_answers_are_refused_by_forward_kinematics_and_the_solver_is_named(scenario):
    for command, code in (("check", 1), ("run", 1)):
        out = harness(
            scenario, command, "pose.scenario.yaml", "--set", "robot.ik_solver=off_by_a_bit",
            *SOLVERS, code=code,
        )  # fmt: skip
        assert "pose.scenario.yaml:4" in out
        assert "NO_IK_SOLUTION: the inverse kinematics solver `off_by_a_bit` of the package" in out
        assert re.search(
            r"by forward kinematics its answer puts tool0 \d\.\d mm and \d\.\d° away", out
        )
        assert "1 answer refused by forward kinematics" in out
        assert "what to do: correct the plug-in `off_by_a_bit`" in out
    explanation = steps(scenario)[0]["explanation"]
    [refused] = explanation["refused_solutions"]
    assert refused["residual"]["position"] == explanation["position_error"] > 1e-3


@pytest.mark.nightly
def test_a_solver_that_goes_wrong_fails_the_step_and_is_named(scenario):
    (scenario / "mine.py").write_text(WRONG, encoding="utf-8")
    motion = "  - move_to: {pose: {xyz: [%s, 0.1, 0.3], rpy: [180 deg, 0, 0]}}\n"
    text = SCENARIO.split("steps:")[0].replace("newton", "mine") + "steps:\n"
    text += "".join(motion % x + "    expect_error: CRASH\n" for x in (0.05, 0.15, 0.25))
    file = scenario / "pose.scenario.yaml"
    file.write_text(text, encoding="utf-8")
    harness(scenario, "run", file.name, "--plugin", "mine.py")
    for step, message in zip(
        steps(scenario),
        (
            "raised ZeroDivisionError: division by zero (mine.py:12)",
            "returned a solution that is not 6 joint positions",
            "returned NoneType, not an IkResult",
        ),
        strict=True,
    ):
        assert step["error_code"] == "CRASH"
        assert step["explanation"]["ik_solver"] == "mine"
        assert (
            f"the inverse kinematics solver `mine` of the package `mine` {message}"
            in (step["message"])
        )


def test_without_the_plug_in_the_solver_is_a_located_error(scenario):
    out = harness(scenario, "check", "pose.scenario.yaml", code=2)
    assert "pose.scenario.yaml:2:33: there is no inverse kinematics solver `newton`" in out
    assert "inverse kinematics solvers: auto, numeric, open_manipulator_x, ur" in out


@pytest.mark.nightly
def test_ik_test_tests_a_registered_solver_by_its_name(tmp_path):
    head, _, _ = WRONG.partition("        return [")
    zero = f"{head}        return IkResult((np.zeros(6),))\n"
    (tmp_path / "zero.py").write_text(zero, encoding="utf-8")
    arguments = ("--robot", "ur3e", "--examples", "2", "--no-report")
    out = harness(tmp_path, "ik-test", "mine", *arguments, "--plugin", "zero.py", code=1)
    assert "mine" in out
    assert "mm" in out
    harness(tmp_path, "ik-test", "ur", *arguments)
    out = harness(tmp_path, "ik-test", "ur5", *arguments, code=2)
    assert "no solver has that name; solvers: own, numeric, open_manipulator_x, ur" in out


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("returned", "reported"),
    [
        ("np.zeros((1, 6))", "mine returned ndarray, not an IkResult; the joints are shoulder_pan"),
        ("None", "mine returned NoneType, not an IkResult"),
        ("IkResult(np.zeros(6))", "mine returned a solution that is not 6 joint positions"),
    ],
)
def test_ik_test_refuses_a_solver_that_returns_no_ik_result(tmp_path, returned, reported):
    head, _, _ = WRONG.partition("        return [")
    (tmp_path / "mine.py").write_text(f"{head}        return {returned}\n", encoding="utf-8")
    arguments = ("--robot", "ur3e", "--examples", "2", "--no-report", "--plugin", "mine.py")
    assert reported in harness(tmp_path, "ik-test", "mine", *arguments, code=2)


@pytest.mark.nightly
def test_ik_test_blames_the_solvers_own_line_and_passes_nothing_that_was_not_observed(tmp_path):
    head, _, _ = WRONG.partition("        return [")
    body = "        return request.missing\n"
    (tmp_path / "mine.py").write_text(head + body, encoding="utf-8")
    arguments = ("--robot", "ur3e", "--examples", "10", "--no-report", "--plugin", "mine.py")
    out = harness(tmp_path, "ik-test", "mine", *arguments, code=1)
    assert "mine raises AttributeError at mine.py:12 (13 of 13)" in out
    assert " ok, " not in out
    assert out.count("NOT OBSERVED, 1") == 4


@pytest.mark.nightly
def test_the_example_of_the_documentation_is_a_solver(tmp_path):
    page = (ROOT / "docs/guides/python.md").read_text(encoding="utf-8")
    [example] = [
        block for block in re.findall(r"(?ms)^```python\n(.*?)^```", page) if "(IkSolver)" in block
    ]
    (tmp_path / "solvers.py").write_text(example, encoding="utf-8")
    file = tmp_path / "pose.scenario.yaml"
    file.write_text(SCENARIO.replace("newton", "least_squares"), encoding="utf-8")
    harness(tmp_path, "run", file.name, "--plugin", "solvers.py")
    pose, position = steps(tmp_path)
    assert pose["explanation"]["ik_method"] == "least_squares"
    assert position["explanation"]["ik_method"] == "numeric"


def test_the_list_has_the_solver_and_its_package(tmp_path):
    rows = harness(tmp_path, "list", "ik-solvers", *SOLVERS).splitlines()
    assert [row.split(maxsplit=2)[:2] for row in rows] == [
        ["numeric", "armharness"],
        ["open_manipulator_x", "armharness"],
        ["ur", "armharness"],
        ["newton", "ik_solvers"],
        ["off_by_a_bit", "ik_solvers"],
    ]


def test_a_solver_that_finds_nothing_is_named_where_the_goal_is_reachable(scenario):
    (scenario / "none.py").write_text(
        WRONG.split("    def solve")[0]
        + "    def solve(self, request: IkRequest) -> IkResult:\n        return IkResult(())\n",
        encoding="utf-8",
    )
    out = harness(
        scenario, "check", "pose.scenario.yaml", "--plugin", "none.py",
        "--set", "robot.ik_solver=mine", code=1,
    )  # fmt: skip
    assert "the inverse kinematics solver `mine` of the package `none` finds no solution" in out
    assert "tool0 reaches (300, 100, 300) mm as requested" in out
