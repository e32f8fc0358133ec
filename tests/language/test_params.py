from pathlib import Path

import pytest

from harness.core.errors import SpecError
from harness.language.reading.load import load_scenario, parse_scenario
from harness.language.reading.params import REFERENCE

TEXT = """\
scenario: "${what}: ${count} lifts of ${lift} m"
robot: {model: ur3e}
params: {lift: 0.1, what: Cans, count: 3, place: [0.3, 0, 0.2], really: true}
steps:
  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: "${lift}"}
  - move_to: {position: "${place}"}
  - wait: ${count} s
  - clear_objects: {world: "${really}"}
"""


def parse(text=TEXT, **overrides):
    given = {key.replace("__", "."): value for key, value in overrides.items()}
    return parse_scenario(text, Path("f.yaml"), given).scenario


def problems(text=TEXT, overrides=None):
    with pytest.raises(SpecError) as caught:
        parse_scenario(text, Path("f.yaml"), overrides)
    return caught.value.problems


def test_a_reference_alone_keeps_the_parameters_type():
    scenario = parse()
    assert scenario.steps[0].distance == 0.1
    assert scenario.steps[1].position.xyz == (0.3, 0.0, 0.2)
    assert scenario.steps[3].world is True


def test_a_reference_inside_a_text_is_written_out():
    scenario = parse()
    assert scenario.scenario == "Cans: 3 lifts of 0.1 m"
    assert scenario.steps[2].duration == 3.0


def test_a_doubled_dollar_is_no_reference():
    assert parse(TEXT.replace("${what}", "$${what}")).scenario.startswith("${what}: 3")


@pytest.mark.parametrize(
    ("old", "new", "message", "hint"),
    [
        ('"${lift}"', '"${lft}"', "no parameter is called `lft`", "did you mean `lift`?"),
        ('"${lift}"', '"${lift} + 1"', "a length is a number", ""),
        ('"${lift}"', '"${place} m"', "`${place}` is a list; it cannot stand inside", ""),
        ('"${lift}"', '"${}"', "no parameter is called ``", "params: lift, what"),
    ],
)
def test_what_cannot_be_filled_in_is_one_located_problem(old, new, message, hint):
    (problem,) = problems(TEXT.replace(old, new))
    assert (problem.line, problem.column) == (5, problem.source_line.index(new) + 1)
    assert message in problem.message
    assert hint in problem.hint


def test_overrides_take_dotted_paths_indices_and_parameters():
    scenario = parse(
        robot__model="ur5e",
        lift="20 cm",
        params__count="4",
        steps__1__move_to="up",
        planning__planner_id="PRM",
        tags="[a, b]",
        seed="5",
    )
    assert scenario.robot.model == "ur5e"
    assert scenario.steps[0].distance == 0.2
    assert scenario.steps[2].duration == 4.0
    assert scenario.steps[1].named_target == "up"
    assert scenario.planning.planner_id == "PRM"
    assert (scenario.tags, scenario.seed) == (("a", "b"), 5)


@pytest.mark.parametrize("robot", ["ur3e", "{model: ur3e}"])
def test_the_robots_model_is_set_however_the_file_says_it(robot):
    text = f"scenario: x\nrobot: {robot}\nsteps: [settle]\n"
    loaded = parse_scenario(text, Path("f.yaml"), {"robot.model": "ur5e", "robot.gripper": "g"})
    assert loaded.scenario.robot.model == "ur5e"
    assert loaded.scenario.robot.gripper == "g"


@pytest.mark.parametrize(
    ("path", "value", "message", "hint"),
    [
        ("lft", "1", "the file has no `lft` to set", "did you mean `lift`?"),
        ("stps.0.wait", "1", "the file has no `stps` to set", "did you mean `steps`?"),
        ("steps.9.wait", "1", "`9` in `steps.9.wait` is no index of this list of 4", "0 to 3"),
        ("steps.x", "1", "`x` in `steps.x` is no index", "0 to 3"),
        ("scenario.a", "1", "`scenario` is `${what}: ${count}", "--set scenario=..."),
        ("robot.modl", "ur5e", "unknown key `modl`", "did you mean `model`?"),
        ("robot.model", "[a", "`[a` is not a YAML value", "quote"),
        ("seed", "-1", "`seed` must be at least 0, not `-1`", ""),
        ("steps.2.wait", "5 kg", "`5 kg` is a mass; a time is expected", "ms"),
        ("", "5", "the file has no `` to set", "what can be set"),
    ],
)
def test_a_wrong_override_is_a_problem_of_the_option(path, value, message, hint):
    (problem,) = problems(overrides={path: value})
    assert problem.path == f"--set {path}={value}"
    assert problem.line == 0
    assert message in problem.message
    assert hint in problem.hint


def test_several_wrong_overrides_are_found_at_once():
    assert len(problems(overrides={"a": "1", "b": "2", "lift": "0.2"})) == 2


def test_a_seed_given_from_outside_wins(tmp_path):
    path = tmp_path / "f.yaml"
    path.write_text(TEXT + "seed: 3\n")
    assert load_scenario(path).scenario.seed == 3
    assert load_scenario(path, seed=8).scenario.seed == 8


def test_without_params_a_reference_says_so():
    (problem,) = problems("scenario: x\nrobot: ur3e\nsteps: [{wait: '${t}'}]\n")
    assert problem.hint == "there are no params"
    assert REFERENCE.search("${t}")
