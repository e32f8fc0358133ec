"""However mistakes are combined, each of them is reported at its place, and nothing else is."""

import random

import pytest

from harness.core.errors import SpecError
from harness.session.prepare import prepare

FILE = """\
scenario: Mistakes
robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}
world: lesson_ur
seed: 3
params: {lift: 5 cm}
planning: {planner_id: RRTConnect, max_velocity_scaling_factor: 0.2, planning_attempts: 2}
objects:
  - {name: crate, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [0.5, 0.3, 2]}}
  - {name: ball, sphere: {radius: 0.05}, mass: 0.2, pose: {xyz: [0.5, -0.3, 2]}}
cameras:
  - {name: top, pose: {xyz: [0, 0, 3]}, update_rate: 10}
steps:
  - move_to: {joints: {shoulder_pan_joint: 10 deg}}
  - move_to: {pose: {xyz: [0.3, 0.1, 1.3], rpy: [0, 0, 0], frame: world}}
    id: reach
    planning: {planner_id: RRTstar}
  - gripper: open
  - wait: 0.5 s
  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: "${lift}"}
  - repeat: {times: 2, steps: [{wait: 0.1 s}, {gripper: closed}]}
  - lin: {pose: {xyz: [0.3, 0, 1.4], rpy: [0, 0, 0]}}
  - remove_object: ball
expect:
  - lifted: {object: crate, above: 5 cm}
  - never: {collision: {between: [robot, Table]}}
  - upright: {object: crate, during: reach}
  - formula: always z(crate) > 0 m
samples: 3
expect_rate: {at_least: 0.5}
"""
MISTAKES = {
    "a robot that does not exist": ("model: ur3e", "model: ur3§x", "ur3x"),
    "a gripper's key": (", gripper:", ", §griper:", "unknown key `griper`"),
    "a unit in the robot's base": ("1.02]", "§1 kg]", "`1 kg` is a mass"),
    "a world that does not exist": ("world: lesson_ur", "world: §lesson_or", "lesson_or"),
    "a seed below 0": ("seed: 3", "seed: §-3", "`seed` must be at least 0"),
    "a parameter without a value": ("${lift}", "${lft}", "no parameter is called `lft`"),
    "an unknown planner": ("RRTConnect", "§RRTConect", "RRTConect"),
    "a scaling factor above 1": ("factor: 0.2", "factor: §1.2", "must be at most 1"),
    "a planner of a step": ("RRTstar", "§RRTstr", "RRTstr"),
    "a number that is none": ("planning_attempts: 2", "planning_attempts: §.nan", "not a finite"),
    "an infinite size": ("0.1, 0.1]}", "0.1, §.inf]}", "`.inf` is not a finite"),
    "a unit inside an object's pose": ("[0.5, -0.3, 2]", "[0.5, §3 s, 2]", "`3 s` is a time"),
    "a key twice": (
        "update_rate: 10",
        "update_rate: 10, §update_rate: 9",
        "the key `update_rate` is here twice",
    ),
    "a tag": ("name: top", "name: §!!str top", "is a tag"),
    "a unit inside a step's pose": ("[0.3, 0.1, 1.3]", "[0.3, §1 N, 1.3]", "`1 N` is a force"),
    "a verb": ("- gripper: open", "- §griper: open", "no verb is called `griper`"),
    "a time that is a length": ("wait: 0.5 s", "wait: §5 mm", "`5 mm` is a length"),
    "a unit in a nested step": ("wait: 0.1 s", "wait: §0.1 m", "`0.1 m` is a length"),
    "a predicate": ("- lifted:", "- §lifed:", "no predicate is called `lifed`"),
    "an object that is not there": ("[robot, Table]", "[robot, §Tabel]", "Tabel"),
    "a step that is not there": ("during: reach", "during: §raech", "raech"),
    "a word in a formula": ("z(crate)", "z(§crat)", "crat"),
    "a rate above 1": ("at_least: 0.5", "at_least: §1.5", "must be at most 1"),
    "a joint that is not there": ("shoulder_pan_joint", "§shoulder_pen_joint", "shoulder_pen"),
    "a colour": ("mass: 0.2", "mass: 0.2, color: §rd", "no colour is called `rd`"),
}
DEPENDENT = {
    "a robot that does not exist": {"a joint that is not there", "a gripper's key"},
    "a world that does not exist": {"an object that is not there"},
}
"""What cannot be known once the first is wrong: whose names there are."""

DEPENDS_ON_BOTH = {"an object that is not there", "a word in a formula"}


def with_mistakes(names):
    text = FILE
    for name in names:
        old, new, _ = MISTAKES[name]
        assert text.count(old) == 1, (name, text.count(old))
        text = text.replace(old, new)
    return text


def reported(folder, names):
    """Every mistake that is to be reported, and the problems that are."""
    text = with_mistakes(names)
    path = folder / "mistakes.scenario.yaml"
    path.write_text(text.replace("§", ""))
    with pytest.raises(SpecError) as caught:
        prepare(path)
    hidden = set().union(*(DEPENDENT.get(name, set()) for name in names))
    if {"a robot that does not exist", "a world that does not exist"} & set(names):
        hidden |= DEPENDS_ON_BOTH
    return [MISTAKES[name][2] for name in names if name not in hidden], caught.value.problems


def missed(folder, names):
    expected, problems = reported(folder, names)
    return [word for word in expected if not any(word in each.message for each in problems)]


def test_without_a_mistake_the_file_is_right(tmp_path):
    path = tmp_path / "right.scenario.yaml"
    path.write_text(FILE)
    assert prepare(path).program.steps


@pytest.mark.parametrize("name", MISTAKES)
def test_each_mistake_alone_is_one_problem_at_its_place(tmp_path, name):
    (word,), (problem,) = reported(tmp_path, [name])
    text = with_mistakes([name])
    assert word in problem.message
    if "§" in text:
        before = text[: text.index("§")]
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        assert problem.line == line
        assert problem.column <= column < problem.column + max(problem.length, 30)


@pytest.mark.parametrize("seed", range(24))
def test_any_mistakes_together_are_all_reported(tmp_path, seed):
    rng = random.Random(seed)
    names = rng.sample(sorted(MISTAKES), rng.randint(2, 6))
    assert missed(tmp_path, names) == [], names
    _, problems = reported(tmp_path, names)
    assert len(problems) <= len(names), [str(each) for each in problems]


def test_all_mistakes_together_are_all_reported(tmp_path):
    assert missed(tmp_path, list(MISTAKES)) == []
