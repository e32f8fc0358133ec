"""`harness check` of picks from belts, whose places it does not know."""

import pytest

from harness.session.check import check_file

CELL = """
scenario: belt
robot: {model: ur3e, gripper: rh_p12_rn_a}
objects:
  - {name: belt, static: true, surface_velocity: 0, box: {size: [1.6, 0.25, 0.1]},
      pose: {xyz: [0.1, 0.28, 0.05]}}
  - {name: tray, static: true, box: {size: [0.2, 0.2, 0.02]}, pose: {xyz: [0.3, -0.2, 0.01]}}
  - {name: box, box: {size: [4 cm, 6 cm, 5 cm]}, pose: {xyz: [-0.6, 0.28, 0.125]}, mass: 0.2}
  - {name: stone, box: {size: [4 cm, 6 cm, 5 cm]}, pose: {xyz: [-0.9, -0.9, 0.025]}, mass: 0.2}
steps:
  - conveyor: {object: belt, velocity: 10 cm/s}
"""
BEAM = "wait: {until: {beam: {from: [0.1, 0.1, 0.13], to: [0.1, 0.5, 0.13]}}}"


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        (["wait: 7 s", "conveyor: {object: belt, velocity: 0}", "pick: box"], ""),
        ([BEAM, "pick: box", "place: {object: box, on: tray}"], ""),
        ([BEAM, "pick: stone"], "NO_IK_SOLUTION"),
    ],
)
def test_what_a_belt_brings_is_not_said_to_be_out_of_reach(tmp_path, steps, said):
    file = tmp_path / "belt.scenario.yaml"
    file.write_text(CELL + "".join(f"  - {each}\n" for each in steps), encoding="utf-8")
    found = check_file(file)
    assert not found.problems
    assert [each.message.split(":")[0] for each in found.predicted] == ([said] if said else [])
