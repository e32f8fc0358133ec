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
THICKNESS = 0.1  # of the block [m]
TIP = 0.135  # lowest point of the quill at the start [m]


def result_of(folder, words, height=0.05):
    (folder / "gantry.xml").write_text(GANTRY, encoding="utf-8")
    file = folder / "touch.scenario.yaml"
    file.write_text(SCENARIO % (height, words), encoding="utf-8")
    return harness.run(file)


@pytest.mark.nightly(but=["0.01-0.035"])
@pytest.mark.parametrize(("speed", "gap"), [(0.002, 0.005), (0.01, 0.035), (0.05, 0.035)])
def test_a_touch_stops_the_arm_within_what_its_deceleration_allows(tmp_path, speed, gap):
    words = f"contact: true, max_distance: 5 cm, speed: {speed}"
    result = result_of(tmp_path, words, height=TIP - gap - THICKNESS / 2)
    assert result, str(result)
    found = result.step("down").result.find(GuardedMove)
    assert found.noticed_force >= 0.1
    late = speed * (0.004 + found.stopping_time / 2 + 0.001)
    assert gap - 1e-4 < found.travelled < gap + late + 1e-4
    z = result.run.signals.tcp_pose[:, 2]
    end = result.step("down").end_index
    assert np.ptp(z[end:]) < 2e-5, "it stays where it stopped"
    assert np.abs(np.diff(z)).max() < 1.05 * max(speed, 0.5) * 1e-3


@pytest.mark.nightly
@pytest.mark.parametrize("limit", [5.0, 20.0])
def test_a_force_is_the_mean_of_the_recorded_contact_forces(tmp_path, limit):
    words = f"force: {limit}, max_distance: 5 cm, speed: 1 mm/s"
    result = result_of(tmp_path, words, height=0.08)  # 5 mm below the tip
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


@pytest.mark.nightly(but=[0, 2])
@pytest.mark.parametrize(
    ("limit", "tare", "said"),
    [
        ("force: {:.3f}", "", "before the move begins: `tare` it"),
        ("torque: {:.4f}", "", "before the move begins: `tare` it"),
        ("force: {:.3f}", "tare: wrist", "nothing pressed the robot with"),
        ("torque: {:.4f}", "tare: wrist", "no torque reached"),
    ],
)
def test_the_weight_of_the_tool_is_nothing_that_was_met(tmp_path, limit, tare, said):
    """The limit is half of what the quill's 1 kg is at the sensor; it goes up through empty air."""
    half = 0.5 * 9.8 * (0.1 if "torque" in limit else 1.0)
    sensor = "wrench_sensors: {wrist: {link: quill, xyz: [10 cm, 0, 0]}}}"
    move = f"{limit.format(half)}, sensor: wrist, max_distance: 2 cm, speed: 1 cm/s"
    text = SCENARIO % (-0.2, move)
    text = text.replace("tcp_link: tip}", f"tcp_link: tip, {sensor}").replace("0, -1]", "0, 1]")
    if tare:
        text = text.replace("  - allow_collisions", f"  - {tare}\n  - allow_collisions")
    (tmp_path / "gantry.xml").write_text(GANTRY, encoding="utf-8")
    file = tmp_path / "touch.scenario.yaml"
    file.write_text(text, encoding="utf-8")
    result = harness.run(file)
    assert result.step("down").error_code == "CONTROL_FAILED"
    assert said in str(result)


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


VALVE = """
scenario: valve
robot: {mjcf: gantry.xml, tcp_link: tip, wrench_sensors: {wrist: {link: quill, xyz: [0, 0, %s]}}}
world: empty
objects:
  - name: valve
    static: true
    cylinder: {radius: 2 cm, length: 10 cm}
    pose: {xyz: [0.2, -0.1, 0.05]}
    joints:
      - name: lever
        hinge: {axis: [0, 0, 1], range: [-90 deg, 90 deg], friction: %s}
        shapes:
          - {sphere: {radius: 1 cm}, pose: {xyz: [0, 0.1, 0.13]}, friction: 0.001}
steps:
  - move_to: {joints: {x: 0.17, y: 0, z: 0}}
  - allow_collisions:
      pairs: [[quill, valve/lever]]
      during:
        - move_until: {direction: {xyz: [1, 0, 0]}, torque: %s, max_distance: 13 mm, speed: 3 mm/s}
          id: turn
"""
LEVER, KNOB, QUILL = 0.1, 0.18, 0.3  # of the valve; heights of its knob and of the sensor's link


@pytest.mark.nightly(but=["0.99-0.5-0.0"])
@pytest.mark.parametrize(("friction", "offset"), [(0.5, 0.0), (0.2, 0.05)])
@pytest.mark.parametrize("share", [0.99, 1.02])
def test_a_valve_turns_with_the_torque_that_its_friction_needs(tmp_path, friction, offset, share):
    """Its friction resists with a force of torque / lever, which has a lever about the sensor."""
    expected = friction / LEVER * (QUILL + offset - KNOB)
    (tmp_path / "gantry.xml").write_text(GANTRY, encoding="utf-8")
    file = tmp_path / "valve.scenario.yaml"
    file.write_text(VALVE % (offset, friction, share * expected), encoding="utf-8")
    result = harness.run(file)
    signals = result.run.signals
    turned = signals.object_poses["valve/lever"][-1]
    angle = 2 * np.arctan2(-turned[6], turned[3])
    if share < 1:
        assert result, str(result)
        found = result.step("turn").result.find(GuardedMove)
        assert share * expected <= found.noticed_force < 1.01 * expected
        assert abs(angle) < 0.02, "it stops before the valve turns"
        return
    assert f"no torque reached {share * expected:g} N m" in str(result)
    assert 0.06 < angle < 0.1, "the lever is shorter by less than half a percent at the end"
    end = result.step("turn").end_index
    moving = signals.wrenches["wrist"][end - 1200 : end - 400, 3:]
    assert np.linalg.norm(moving, axis=1).mean() == pytest.approx(expected, rel=0.01)
