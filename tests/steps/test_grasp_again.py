"""A gripper that grasps what it holds is refused; nothing is held twice."""

import pytest

from tests.running import run_case

ONE = "robot: {model: ur3e, gripper: suction_cup}"
TWO = """\
robots:
  left: {model: ur3e, gripper: suction_cup, base: {xyz: [0, 0.8, 0]}}
  right: {model: ur3e, gripper: suction_cup}"""
SCENARIO = """\
scenario: it grasps again
ROBOT
objects:
  - {name: slab, box: {size: [0.1, 0.1, 0.03]}, pose: {xyz: [0.4, -0.2, 0.015]}, mass: 0.2}
steps:
  - pick: slab
    WHO
  - grasp: AGAIN
    WHO
    expect_error: INVALID_OBJECT_NAME
  - release: slab
    WHO
"""
HARDER = "{object: slab, max_effort: 0.2}"


@pytest.mark.nightly(but=["by one arm"])
@pytest.mark.parametrize(
    ("robot", "who", "again"),
    [(ONE, "", "slab"), (ONE, "", HARDER), (TWO, "robot: right", "slab")],
    ids=["by one arm", "with another effort", "by one of two arms"],
)
def test_what_a_gripper_holds_is_not_grasped_again(robot, who, again, tmp_path):
    text = SCENARIO.replace("ROBOT", robot).replace("WHO", who).replace("AGAIN", again)
    file = tmp_path / "again.scenario.yaml"
    file.write_text(text)
    result = run_case(file, page=False, stills=False)
    assert result.outcome == "passed", (result.message, result.steps)
    grasp = next(step for step in result.steps if step.verb == "grasp" and "." not in step.id)
    assert grasp.message == "'slab' is attached already"
