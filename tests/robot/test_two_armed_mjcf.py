"""An MJCF file with two arms: each picks with its own hand."""

import pytest

import harness
from tests.robot.two_armed_mjcf import MJCF

SCENARIO = """
scenario: two hands
robot: {mjcf: two.xml}
objects:
  - {name: a, box: {size: [3 cm, 3 cm, 6 cm]}, mass: 0.05, pose: {xyz: [0.3, 0.25, 0.03]}}
  - {name: b, box: {size: [3 cm, 3 cm, 6 cm]}, mass: 0.05, pose: {xyz: [0.3, -0.25, 0.03]}}
steps:
  - {pick: %s, robot: %s}
expect:
  - grasped: {object: %s, by: %s}
  - lifted: {object: %s, above: 3 cm, by: %s}
  - never: collision
"""


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(("name", "arm"), [("a", "port"), ("b", "starboard")])
def test_either_hand_of_a_file_with_two_arms_picks(tmp_path, name, arm):
    (tmp_path / "two.xml").write_text(MJCF, encoding="utf-8")
    file = tmp_path / "two.scenario.yaml"
    file.write_text(SCENARIO % ((name, arm) * 3), encoding="utf-8")
    result = harness.run(file)
    assert result, str(result)
