"""Mistakes of every kind in one file are reported at once, each at its place, none twice."""

import pytest

from harness.core.errors import SpecError
from harness.session.prepare import prepare

MISTAKES = """\
scenario: Mistakes
robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}
world: lesson_ur
planning: {planner_id: RRTConect}
steps:
  - move_to: mogi_hom
  - move_too: up
  - gripper: opn
  - lin: {pose: {frame: base_lnk, xyz: [0.3, 0, 0.3]}}
  - move_to: {joints: {shoulder_pan: 0}}
  - move_to: {pose: {xyz: [0.3, 0, 1.3], quat_xyzw: [0.9, -0.6, 0, 0]}}
  - wait: 3 mm
  - grasp: green_cilinder
  - pick: {object: Table}
expect:
  - lifted: {object: green_cylinder, above: 5 cms}
  - never: {collision: {between: [robot, Tabel]}}
  - grasped: nothing
"""
PLACES = [
    (4, 24, "RRTConect"),
    (6, 14, "mogi_hom"),
    (7, 5, "move_too"),
    (8, 14, "opn"),
    (9, 25, "base_lnk"),
    (10, 24, "shoulder_pan"),
    (11, 53, "norm"),
    (12, 11, "3 mm"),
    (13, 12, "green_cilinder"),
    (14, 20, "static"),
    (16, 45, "cms"),
    (17, 42, "Tabel"),
    (18, 14, "nothing"),
]


def problems(tmp_path, text):
    path = tmp_path / "mistakes.scenario.yaml"
    path.write_text(text)
    with pytest.raises(SpecError) as caught:
        prepare(path)
    return caught.value.problems


def test_words_values_and_names_that_are_wrong_are_reported_together(tmp_path):
    found = problems(tmp_path, MISTAKES)
    assert [(problem.line, problem.column) for problem in found] == [place[:2] for place in PLACES]
    for problem, (_, _, word) in zip(found, PLACES, strict=True):
        assert word in problem.message
        assert problem.source_line


def test_a_wrong_robot_and_a_wrong_world_are_reported_together(tmp_path):
    text = "scenario: Two\nrobot: ur3x\nworld: lesson_or\nsteps:\n  - wait: 1 s\n"
    found = problems(tmp_path, text)
    assert [problem.line for problem in found] == [2, 3]


def test_what_follows_from_another_mistake_is_not_reported(tmp_path):
    text = """\
scenario: One
robot: open_manipulator_x
steps:
  - add_object: {name: crate, box: {size: [0.1, 0.1]}, pose: {xyz: [0.5, 0, 0.05]}}
    id: add
  - remove_object: crate
expect:
  - static: {object: crate, during: add}
"""
    found = problems(tmp_path, text)
    assert [problem.line for problem in found] == [4]


FORMULAS = """\
scenario: Formulas
robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}
world: lesson_ur
steps:
  - wait: 0.2 s
expect:
  - formula: always (z(green_cylindr) > 1 m and position(elbow) < 2)
  - formula: "always z(tcp > 1"
  - formula: >-
      always (z(tcp) > 1 m
      implies time < force(robot, Table))
  - formula: {formula: 'not eventually z(tcp) > 1 parsec', points: 2}
"""


def test_a_mistake_in_a_formula_is_reported_at_its_word(tmp_path):
    path = tmp_path / "formulas.scenario.yaml"
    path.write_text(FORMULAS)
    with pytest.raises(SpecError) as caught:
        prepare(path)
    underlined = [
        (p.line, p.column, p.source_line[p.column - 1 :][: p.length]) for p in caught.value.problems
    ]
    assert underlined == [
        (7, 24, "green_cylindr"),
        (7, 58, "elbow"),
        (8, 28, ">"),
        (11, 15, "t"),  # where the comparison begins
        (12, 51, "parsec"),
    ]


@pytest.mark.parametrize("expected", ["tcp_path", "always: tcp_path", "tcp_path: {for: 1 s}"])
def test_the_path_of_no_step_is_reported_before_anything_runs(expected, tmp_path):
    text = "scenario: Path\nrobot: ur3e\nsteps:\n  - ptp: {joints: {elbow_joint: 1}}\n    id: go\n"
    (tmp_path / "whole.scenario.yaml").write_text(f"{text}expect:\n  - {expected}\n")
    with pytest.raises(SpecError) as caught:
        prepare(tmp_path / "whole.scenario.yaml")
    (problem,) = caught.value.problems
    assert (problem.line, problem.column) == (7, 5)
    assert "`tcp_path` without `line` or `arc`" in problem.message
    assert "`during`" in problem.hint
    step = f"{text}    expect:\n      - {expected}\n"
    (tmp_path / "step.scenario.yaml").write_text(step)
    assert prepare(tmp_path / "step.scenario.yaml").program.expectations


@pytest.mark.parametrize(
    "unusable",
    [
        "mesh: {file: nowhere.stl}, static: true",
        "plane: {}",
        "visuals: [{box: {size: [1, 1, 1]}}]",
    ],
)
def test_an_object_that_cannot_be_used_is_reported_once_and_not_at_each_use(tmp_path, unusable):
    text = f"""\
scenario: Once
robot: {{model: ur3e, gripper: rh_p12_rn_a}}
objects:
  - {{name: part, {unusable}}}
steps:
  - pick: part
    expect: [lifted: part]
  - move_to: {{pose: {{frame: part, xyz: [0, 0, 0.1]}}}}
expect:
  - never: {{collision: {{between: [robot, part]}}}}
  - upright: other
"""
    found = problems(tmp_path, text)
    assert [problem.line for problem in found] == [4, 11]
    assert found[0].message.startswith("object 'part': ")
