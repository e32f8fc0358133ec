"""A third-party planning pipeline is verified, timed, explained and compared like `ompl`."""

import json
import re
from json import JSONDecoder

import pytest

from tests.plugins.commands import MODULES, harness

GO = "move_to: {joints: {shoulder_pan_joint: %s, shoulder_lift_joint: -0.6, elbow_joint: 0.6}}"
WALL = f"""\
scenario: past a post
robot: ur3e
objects:
  - {{name: post, box: {{size: [0.02, 0.02, 0.6]}}, pose: {{xyz: [0.3, 0.3, 0.3]}}, static: true}}
planning: {{pipeline: via_point}}
steps:
  - {GO % 0}
  - {GO % 1.4}
expect:
  - never: collision
"""
PLANNERS = ("--plugin", MODULES / "planners.py")
HEAD = """
import numpy as np
from harness.ports import PathPlanner, PathRequest, PathResult
"""
MINE = """
class Mine{0}(PathPlanner):
    \"\"\"A planner under test.\"\"\"

    name = "mine{0}"

    def find_path(self, request: PathRequest) -> PathResult:
        {1}
"""


@pytest.fixture
def wall(tmp_path):
    """The folder of a scenario whose second motion has to go around a post."""
    (tmp_path / "post.scenario.yaml").write_text(WALL, encoding="utf-8")
    return tmp_path


def use(folder, old, new):
    assert old in WALL
    (folder / "post.scenario.yaml").write_text(WALL.replace(old, new), encoding="utf-8")


@pytest.mark.nightly
def test_a_planner_s_path_is_timed_verified_executed_and_recorded(wall):
    out = harness(wall, "run", "post.scenario.yaml", "-v", *PLANNERS)
    (file,) = wall.glob("reports/**/run.json")
    _, step = json.loads(file.read_text(encoding="utf-8"))["steps"]
    planner = step["planner"]
    assert planner["planner_id"] == "via_point"
    assert planner["vertices"] >= 1
    assert planner["search_checks"] > 0
    assert planner["path_length"] <= planner["raw_path_length"]
    again = harness(wall, "run", "post.scenario.yaml", "-v", "--no-report", *PLANNERS)
    assert again.split("digest ")[1].split()[0] == out.split("digest ")[1].split()[0]


def test_a_planner_that_goes_through_an_obstacle_is_caught_with_the_pair_and_its_name(wall):
    use(wall, "via_point", "straight_through")
    out = harness(wall, "run", "post.scenario.yaml", "--no-report", *PLANNERS, code=1)
    assert "post.scenario.yaml:8: move_to" in out
    assert "INVALID_MOTION_PLAN: paths of the planning pipeline `straight_through` of the" in out
    assert "package `planners` were found, but none passes verification" in out
    assert re.search(r"it would come too near: \w+_link and post \(", out)
    assert "what to do: correct the plug-in `straight_through`" in out


@pytest.mark.nightly
def test_a_step_s_own_pipeline_does_not_inherit_the_scenario_s_planner(wall):
    ours, own = "planning: {pipeline: via_point}", "    planning: {pipeline: via_point%s}\nexpect:"
    text = WALL.replace(ours, "planning: {planner_id: RRT, parameters: {goal_bias: 0.1}}")
    file = wall / "post.scenario.yaml"
    for more, problem in (
        ("", ""),
        (", parameters: {spread: 0.2}", ""),
        (", planner_id: RRT", "9:49: the planning pipeline `via_point` has no planner 'RRT'"),
        (", parameters: {sprd: 1}", "`via_point` has no parameter 'sprd' (it has: spread)"),
    ):
        file.write_text(text.replace("expect:", own % more), encoding="utf-8")
        code = 2 if problem else 0
        assert problem in harness(wall, "check", file.name, *PLANNERS, code=code)


@pytest.mark.nightly
def test_without_the_plug_in_the_pipeline_is_a_located_error(wall):
    out = harness(wall, "run", "post.scenario.yaml", code=2)
    assert "post.scenario.yaml:5:22: there is no planning pipeline `via_point`" in out
    assert "planning pipelines: ompl" in out
    words = " ".join(out.replace("|", "").split())
    assert "a planning pipeline of a plug-in that is not installed needs `--plugin`" in words
    use(wall, "via_point", "ompll")
    out = harness(wall, "check", "post.scenario.yaml", code=2)
    assert "did you mean `ompl`?" in out
    assert "--plugin" not in out
    use(wall, "via_point", "pilz_industrial_motion_planner")
    out = harness(wall, "check", "post.scenario.yaml", code=2)
    assert "5:22: Pilz's planners are steps here" in out


WRONG = [
    ("return 1 / 0", "CRASH", "of the package `mine` raised ZeroDivisionError: division by zero"),
    ("return None", "INVALID_MOTION_PLAN", "returned NoneType, not a PathResult"),
    ("return PathResult(np.zeros(6))", "INVALID_MOTION_PLAN", "waypoints of shape (6), not (N, 6)"),
    ("return PathResult([request.start] * 2)", "INVALID_MOTION_PLAN", "ends away from a goal: "),
    ("return PathResult([request.goals[0]] * 2)", "INVALID_MOTION_PLAN",
     "begins away from the start"),
    ("return PathResult([request.start, request.start * np.nan])", "INVALID_MOTION_PLAN",
     "waypoints that are not finite"),
    ("request.start[0] = 1", "CRASH", "ValueError: assignment destination is read-only"),
    ("return PathResult(None)", "PLANNING_FAILED", "no free path to the goal was found by the "
     "planning pipeline `mine7` of the package `mine` in at most 2000 state checks"),
    ("while True: request.is_state_free(request.start)", "PLANNING_FAILED", "found by the planning"
     " pipeline `mine8`"),
]  # fmt: skip


@pytest.mark.nightly
def test_a_planner_that_goes_wrong_fails_the_step_and_is_named(wall):
    classes = [MINE.format(number, body) for number, (body, _, _) in enumerate(WRONG)]
    (wall / "mine.py").write_text(HEAD + "".join(classes), encoding="utf-8")
    steps = [
        f"  - {GO % 1.4}\n    expect_error: {code}\n    planning: {{pipeline: mine{number}, "
        "max_state_checks: 2000}\n"
        for number, (_, code, _) in enumerate(WRONG)
    ]
    use(wall, f"  - {GO % 1.4}\n", "".join(steps))
    harness(wall, "run", "post.scenario.yaml", "--plugin", "mine.py", "--plugin", PLANNERS[1])
    (file,) = wall.glob("reports/**/run.json")
    _, *steps = json.loads(file.read_text(encoding="utf-8"))["steps"]
    for number, (step, (_, code, message)) in enumerate(zip(steps, WRONG, strict=True)):
        assert step["error_code"] == code, step
        assert message in step["message"]
        assert f"the planning pipeline `mine{number}` of the package `mine`" in step["message"]
        assert step["explanation"]["planner"] == f"mine{number}"


def test_a_planner_without_a_method_or_a_docstring_is_refused_when_it_is_loaded(tmp_path):
    whole = HEAD + MINE.format("", "...")
    for source, problem in (
        (whole.replace("def find_path", "def find_pth"), "needs the method `find_path`"),
        (whole.replace('    """A planner under test."""\n', ""), "has no docstring"),
    ):
        (tmp_path / "mine.py").write_text(source, encoding="utf-8")
        out = harness(tmp_path, "list", "pipelines", "--plugin", "mine.py", code=2)
        assert f"the planning pipeline `mine` {problem}" in out


@pytest.mark.nightly
def test_bench_compares_a_planner_with_the_built_in_ones(wall):
    names = ("BalancedConnect", "via_point", "straight_through")
    out = harness(
        wall, "bench", "post.scenario.yaml", "--seeds", "2", "--json", "--no-report",
        "--planners", ",".join(names), *PLANNERS,
    )  # fmt: skip
    found, _ = JSONDecoder().raw_decode(out, out.index("{"))
    trials = [trial for motion in found["motions"] for trial in motion["trials"]]
    rows = {name: [trial for trial in trials if trial["planner"] == name] for name in names}
    assert all(not trial["error_code"] for trial in rows["via_point"])
    assert all(trial["state_checks"] > 0 for trial in rows["via_point"])
    assert [t["error_code"] for t in rows["straight_through"]] == ["INVALID_MOTION_PLAN"] * 2
    assert set(rows["via_point"][0]) == set(rows["BalancedConnect"][0])


@pytest.mark.nightly
def test_bench_says_why_a_planner_fails(wall):
    out = harness(
        wall, "bench", "post.scenario.yaml", "--seeds", "2", "--no-report",
        "--planners", "BalancedConnect,straight_through", *PLANNERS,
    )  # fmt: skip
    assert "straight_through: 2 times INVALID_MOTION_PLAN, with seed 1: paths of the plan" in out
    assert "BalancedConnect: " not in out


@pytest.mark.nightly
def test_the_lists_have_the_planner_and_its_package(tmp_path):
    rows = harness(tmp_path, "list", "pipelines", *PLANNERS).splitlines()
    assert [row.split(maxsplit=2)[:2] for row in rows] == [
        ["ompl", "armharness"],
        ["straight_through", "planners"],
        ["via_point", "planners"],
    ]
    assert "via_point" in harness(tmp_path, "list", "planners", *PLANNERS).split()
    schema = json.loads(harness(tmp_path, "schema", *PLANNERS))
    assert "via_point" in json.dumps(schema["$defs"]["Planning"])
