"""What `explain` prints of a small program, and which predicted failures no step expects."""

import pytest

from harness.cell.program import step_seed
from harness.cli.main import main
from harness.session.predict import unexpected
from tests.judging.synthetic_run import step

SCENARIO = """\
scenario: what explain says
robot: {model: open_manipulator_x, base: {xyz: [0, 0, 0.01]}}
objects:
  - {name: red_box, box: {size: [0.04, 0.04, 0.08]}, pose: {xyz: [0.25, 0, 0.041]}, mass: 50 g}
  - {name: ghost, sphere: {radius: 0.0123456}, pose: {xyz: [1.23456, 0.3, 1]}, static: true,
     in: planning, friction: 0.7}
  - {name: real, sphere: {radius: 0.01}, pose: {xyz: [-1, 0.3, 1]}, mass: 1 kg, in: simulation}
seed: 5
steps:
  - wait: 1 s
    expect: [{upright: red_box}]
  - repeat: {times: 2, steps: [{gripper: open}]}
  - move_to: {position: {xyz: [2, 0, 0.1]}}
    expect_error: NO_IK_SOLUTION
  - move_to: {position: {xyz: [2, 0, 0.1]}}
expect:
  - never: collision
"""
EXPLAINED = """\
what explain says

robot open_manipulator_x, TCP end_effector_link, inverse kinematics: auto
  group arm: joint1, joint2, joint3, joint4; named states: init, home
  group gripper: gripper_left_joint; named states: open, close
  starts at joint1 0 deg, joint2 0 deg, joint3 0 deg, joint4 0 deg

world empty, physics step 1 ms
  ground_plane: static, at (0, 0, 0) mm, friction 1, in planning and simulation
  red_box: 0.05 kg, at (250, 0, 41) mm, friction 1, in planning and simulation
  ghost: static, at (1234.56, 300, 1000) mm, friction 0.7, in planning
  real: 1 kg, at (-1000, 300, 1000) mm, friction 1, in simulation

steps
    10  wait 1 s  [seed {0}]
          {TCP}
          expect red_box is upright
    12  repeat 2 times  [seed {1}]
          {TCP}
      12  gripper open  [seed {2}]
            {TCP}
      12  gripper open  [seed {3}]
            {TCP}
    13  move_to (2000, 0, 100) mm  [seed {4}]
          {TCP}
          fails (as expected): NO_IK_SOLUTION: {why}
    15  move_to (2000, 0, 100) mm  [seed {5}]
          {TCP}
          fails (NOT EXPECTED): NO_IK_SOLUTION: {why}

expected of the whole run
    17  never: collision
"""


def test_a_program_is_explained_line_by_line(tmp_path, capsys):
    path = tmp_path / "small.scenario.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    main(["explain", str(path)])
    said = capsys.readouterr().out
    (why,) = {line.partition("NO_IK_SOLUTION: ")[2] for line in said.splitlines()} - {""}
    paths = ("steps[0]", "steps[1]", "steps[1].repeat[0][0]", "steps[1].repeat[1][0]", "steps[2]",
             "steps[3]")  # fmt: skip
    expected = EXPLAINED.replace("{why}", why).replace(
        "{TCP}", "TCP at {xyz: [0.286, 0, 0.1975], quat_xyzw: [0, 0, 0, 1]}"
    )
    for number, place in enumerate(paths):
        expected = expected.replace(f"{{{number}}}", str(step_seed(5, place)))
    assert said == expected


FAILED = {"status": "failed", "error_code": "NO_IK_SOLUTION"}
EXPECTED = {"status": "expected error", "error_code": "NO_IK_SOLUTION"}


@pytest.mark.parametrize(
    ("records", "found"),
    [
        ({"steps[0]": {}}, []),
        ({"steps[0]": {"status": "not reached"}}, []),
        ({"steps[0]": {"status": "failed"}}, []),
        ({"steps[0]": EXPECTED}, []),
        ({"steps[0]": FAILED}, ["steps[0]"]),
        ({"steps[0]": FAILED, "steps[0].approach": FAILED}, ["steps[0].approach"]),
        ({"steps[0]": EXPECTED, "steps[0].approach": FAILED}, []),
        ({"steps[0]": EXPECTED, "steps[01]": FAILED}, ["steps[01]"]),
        (
            {"steps[0]": FAILED, "steps[0].a": {**FAILED, "error_code": "TIMED_OUT"}},
            ["steps[0]", "steps[0].a"],
        ),
        ({"steps[0]": FAILED, "steps[1].a": FAILED}, ["steps[0]", "steps[1].a"]),
    ],
)
def test_a_failure_that_no_step_expects_is_reported_at_its_innermost_step(records, found):
    steps = [step("go", 0, 1, path=path, **fields) for path, fields in records.items()]
    assert [each.path for each in unexpected(steps)] == found
