"""jerk and path_efficiency against theory, on motions of a gantry."""

import numpy as np
import pytest

import harness
from tests.simulation.test_pushing import GANTRY

SCENARIO = """
scenario: smooth
robot: {mjcf: gantry.xml, tcp_link: tip}
steps:
  - move_to: {joints: {x: 0.1, y: 0, z: 0}}
%s
"""
STRAIGHT = "  - lin: {pose: {xyz: [0.1, 0.2, 0.15]}}\n    id: go\n    expect: [%s]"
BACK = """
  - repeat:
      times: 1
      steps:
        - move_relative: {direction: {xyz: [0, 1, 0]}, distance: 10 cm}
        - move_relative: {direction: {xyz: [1, 0, 0]}, distance: 10 cm}
    id: corner
    expect: [path_efficiency: %s]
"""


def run_of(folder, steps):
    (folder / "gantry.xml").write_text(GANTRY, encoding="utf-8")
    file = folder / "smooth.scenario.yaml"
    file.write_text(SCENARIO % steps, encoding="utf-8")
    return harness.run(file)


@pytest.mark.parametrize(("share", "holds"), [(0.70, True), (0.72, False)])
def test_a_right_angle_has_the_efficiency_of_its_diagonal(tmp_path, share, holds):
    result = run_of(tmp_path, BACK % share)
    verdict = result.case.verdicts[0]
    assert (verdict.status == "passed") == holds
    assert verdict.margin == pytest.approx(np.sqrt(0.5) - share, abs=1e-3)


def test_a_line_has_an_efficiency_of_one_and_a_rest_is_not_reached(tmp_path):
    steps = STRAIGHT % "path_efficiency: 0.999"
    result = run_of(tmp_path, f"{steps}\n  - {{wait: 0.1, expect: [path_efficiency: 0.9]}}")
    line, rest = result.case.verdicts
    assert line.status == "passed"
    assert rest.status == "not reached"


def test_the_jerk_is_the_change_of_the_mean_acceleration_over_the_window(tmp_path):
    result = run_of(tmp_path, STRAIGHT % "jerk: 1 m/s**3")
    [verdict] = result.case.verdicts
    assert verdict.status == "failed"
    [measure] = [each for each in verdict.measures if each.detail == "y"]
    signals, step = result.run.signals, result.step("go")
    speed = signals.joint_command_velocities[step.start_index : step.end_index, 1]
    acceleration = np.convolve(np.diff(speed) / 0.001, np.full(10, 0.1), "valid")
    jerk = np.abs(acceleration[10:] - acceleration[:-10]).max() / 0.01
    assert measure.value == pytest.approx(jerk, rel=0.1), "the servo smooths it by 7 %"
    assert measure.unit == "m/s**3"


@pytest.mark.parametrize("words", ["jerk: 0", "jerk: 5 m", "path_efficiency: 1.5", "jerk: {}"])
def test_bad_input_is_a_located_error(tmp_path, words):
    result = run_of(tmp_path, STRAIGHT % words)
    assert result.case.outcome == "invalid"
    assert "smooth.scenario.yaml:" in str(result)
