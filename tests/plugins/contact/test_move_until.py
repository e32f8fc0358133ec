"""move_until: a guarded move stops at a force, says which, and fails where nothing is met."""

import numpy as np
import pytest

import harness
from harness.plugins.contact.steps.move_until import GuardedMove
from tests.simulation.test_pushing import GANTRY

SCENARIO = """
scenario: touch
robot: {mjcf: gantry.xml, tcp_link: tip}
world: empty
objects:
  - {name: block, static: true, box: {size: [0.2, 0.2, 0.1]}, pose: {xyz: [0.1, 0, %s]}}
steps:
  - move_to: {joints: {x: 0.1, y: 0, z: 0}}
  - allow_collisions:
      pairs: [[quill, block]]
      during:
        - move_until: {direction: {xyz: [0, 0, -1]}, %s}
          id: down
  - {wait: 0.1}
"""
TOP = 0.1  # of the block [m]
TIP = 0.135  # lowest point of the quill at the start [m]


def result_of(folder, words, height=0.05):
    (folder / "gantry.xml").write_text(GANTRY, encoding="utf-8")
    file = folder / "touch.scenario.yaml"
    file.write_text(SCENARIO % (height, words), encoding="utf-8")
    return harness.run(file)


@pytest.mark.parametrize("speed", [0.002, 0.01, 0.05])
def test_a_touch_stops_the_arm_within_what_its_deceleration_allows(tmp_path, speed):
    result = result_of(tmp_path, f"contact: true, max_distance: 5 cm, speed: {speed}")
    assert result, str(result)
    found = result.step("down").result.find(GuardedMove)
    assert found.noticed_force >= 0.1
    late = speed * (0.004 + found.stopping_time / 2 + 0.001)
    assert TIP - TOP - 1e-4 < found.travelled < TIP - TOP + late + 1e-4
    z = result.run.signals.tcp_pose[:, 2]
    end = result.step("down").end_index
    assert np.ptp(z[end:]) < 2e-5, "it stays where it stopped"
    assert np.abs(np.diff(z)).max() < 1.05 * max(speed, 0.5) * 1e-3


@pytest.mark.parametrize("limit", [5.0, 20.0])
def test_a_force_is_the_mean_of_the_recorded_contact_forces(tmp_path, limit):
    result = result_of(tmp_path, f"force: {limit}, max_distance: 5 cm, speed: 1 mm/s")
    assert result, str(result)
    step = result.step("down")
    found = step.result.find(GuardedMove)
    force = result.run.signals.contact_forces["quill", "block"]
    braked = round(found.stopping_time / result.run.timestep)
    noticed = step.end_index - 1 - braked
    assert found.noticed_force == pytest.approx(force[noticed - 3 : noticed + 1].mean(), rel=0.01)
    assert limit <= found.noticed_force < 1.5 * limit
    assert not (force[: noticed - 8] > limit).any(), "it was not there before"


def test_a_move_that_meets_nothing_fails_with_the_largest_force(tmp_path):
    result = result_of(tmp_path, "contact: true, max_distance: 3 cm, speed: 5 cm/s", height=-0.2)
    assert not result
    assert "CONTROL_FAILED" in str(result)
    assert "nothing pressed the robot with 0.1 N within 30 mm; the largest force was 0 N" in str(
        result
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("max_distance: 5 cm", "`force`, `torque` and `contact`"),
        ("force: 5, contact: true, max_distance: 5 cm", "`force`, `torque` and `contact`"),
        ("contact: false, max_distance: 5 cm", "a move until no contact never ends"),
        ("force: -5, max_distance: 5 cm", "force"),
        ("contact: true", "max_distance"),
    ],
)
def test_bad_input_is_a_located_error(tmp_path, words, said):
    result = result_of(tmp_path, words)
    assert result.case.outcome == "invalid"
    assert said in str(result)
    assert "touch.scenario.yaml:12:" in str(result)
