"""Suction cups in other cells: under another gravity, and on several arms."""

import pytest

from harness.recording.read_run import read_run
from harness.session.check import check_file

CELL = """
scenario: a load under another gravity
robot: {{model: ur5e, gripper: suction_cup}}
world: moon.yaml
objects:
  - name: slab
    box: {{size: [15 cm, 15 cm, 5 cm]}}
    mass: {mass}
    pose: {{xyz: [0.5, 0.1, 0.025]}}
steps:
  - pick: slab
"""


def problems(folder, gravity, mass):
    world = f"world: a world\nphysics: {{gravity: [0, 0, {-gravity}]}}\n"
    (folder / "moon.yaml").write_text(world, encoding="utf-8")
    path = folder / "a.scenario.yaml"
    path.write_text(CELL.format(mass=mass), encoding="utf-8")
    return [problem.message for problem in check_file(path).problems if "weighs" in problem.message]


@pytest.mark.parametrize(
    ("gravity", "mass", "weight"),
    [(9.8, 15, 147.0), (9.8, 1, None), (1.62, 15, None), (1.62, 100, 162.0), (24.8, 6, 148.8)],
)
def test_the_weight_of_a_load_follows_from_the_world(gravity, mass, weight, tmp_path):
    found = problems(tmp_path, gravity, mass)
    expected = [] if weight is None else [f"'slab' weighs {weight:.1f} N"]
    assert [message.partition(", ")[0] for message in found] == expected


TWO = """
scenario: two arms with cups
robots:
  left: {model: ur5e, gripper: suction_cup, base: {xyz: [0, 0.5, 0]}}
  right: {model: ur5e, gripper: suction_cup, base: {xyz: [0, -0.5, 0]}}
objects:
  - {name: a, box: {size: [15 cm, 15 cm, 5 cm]}, mass: 0.4, pose: {xyz: [0.5, 0.5, 0.025]}}
  - {name: b, box: {size: [15 cm, 15 cm, 5 cm]}, mass: 0.4, pose: {xyz: [0.5, -0.5, 0.025]}}
steps:
  - pick: a
    robot: left
  - pick: b
    robot: right
    expect: [grasped: {object: a, by: left}]
  - release: {}
    robot: left
  - wait: 0.3
expect:
  - grasped: {object: b, by: right}
  - lifted: {object: b, by: right}
  - released: {object: a, by: left}
  - never: {collision: {between: [left, right]}}
  - grasped: {object: b, by: left}
"""


@pytest.mark.nightly
def test_each_arm_has_its_own_vacuum(recorded_run):
    """A check that looks for any cup that holds would say that the left one holds both."""
    verdicts = read_run(recorded_run(TWO, "failed") / "run").verdicts
    assert [verdict.status for verdict in verdicts] == ["passed"] * 5 + ["failed"]
    assert "the suction is off" in verdicts[-1].reason
