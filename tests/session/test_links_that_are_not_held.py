"""A motion of an object that the step before could not take is refused, by `check` and by `run`."""

import pytest

from harness.session.check import check_file
from tests.running import run_case

SCENARIO = """\
scenario: The pick fails
robot: open_manipulator_x
objects:
  - {name: chip, box: {size: [2 cm, 2 cm, 4 cm]}, mass: 20 g, pose: {xyz: [0.2, 0, 0.02]}}
steps:
  - pick: chip
    EXPECTED
  - MOTION
"""
MOTIONS = {
    "circ": "circ: {link: chip, pose: {xyz: [0.2, 0.1, 0.1]}, center: {xyz: [0.2, 0.05, 0.05]}}",
    "lin": "lin: {link: chip, pose: {xyz: [0.2, 0.1, 0.1]}}",
    "cartesian_path": "cartesian_path: {link: chip, waypoints: [{xyz: [0.2, 0.1, 0.1]}]}",
    "move_to": "move_to: {link: chip, pose: {xyz: [0.2, 0.1, 0.1]}}",
}


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
@pytest.mark.parametrize("expected", ["", "expect_error: GOAL_STATE_INVALID"])
def test_a_motion_of_what_is_not_held_is_reported(motion, expected, tmp_path):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(SCENARIO.replace("MOTION", motion).replace("EXPECTED", expected))
    checked = check_file(file)
    found = (*checked.problems, *checked.predicted)
    assert found
    assert all(problem.path and problem.line in (6, 8) for problem in found), found
    result = run_case(file, page=False, stills=False)
    assert result.outcome in ("failed", "invalid")
    if expected and result.steps:
        assert result.steps[-1].error_code == "INVALID_LINK_NAME"
        assert "'chip'" in result.steps[-1].message
