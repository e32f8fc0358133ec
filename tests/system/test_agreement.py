"""Every run reports where plan and physics differed, with the numbers."""

from pathlib import Path

import numpy as np
import pytest

from harness.recording.read_run import read_run
from tests.running import run_case
from tests.session.front_door import run

ROOT = Path(__file__).parents[2]


def findings(saved, kind):
    return [found for found in saved.findings if found.kind == kind]


@pytest.fixture(scope="module")
def weak_grip(tmp_path_factory):
    folder = tmp_path_factory.mktemp("weak") / "r"
    path = ROOT / "scenarios/faults/weak_grip.scenario.yaml"
    run_case(path, report_dir=folder, stills=False, page=False)
    return read_run(folder).run


def test_an_object_that_slips_out_is_reported_with_the_time_of_its_loss(weak_grip):
    (found,) = findings(weak_grip, "held")
    assert "believed that it held green_cylinder; the physics lost it at" in found.message
    lift = next(step for step in weak_grip.steps if step.id.endswith(".lift"))
    assert lift.start_time < found.values["lost_at"] < lift.end_time
    assert found.values["drift"] > 0.05


def test_planned_clearance_stands_next_to_the_actual_one(weak_grip):
    found = findings(weak_grip, "clearance")[0]
    pair = tuple(found.values["pair"])
    row = round(found.time / weak_grip.timestep)
    assert found.values["actual"] == weak_grip.signals.clearances[pair][row]
    grip = 1.5e-3  # [m] how far the set point of the fingers is beyond where the object stops them
    assert found.values["planned"] == pytest.approx(found.values["actual"], abs=grip)


@pytest.mark.nightly
def test_coming_nearer_than_planned_can_be_forbidden_and_is_measured_against_the_plan(tmp_path):
    result, saved = run(
        tmp_path,
        """
        - move_to: mogi_home
        - inject: {command_latency: 60 ms}
        - ptp: {joints: {shoulder_pan_joint: -2}}
          id: swing
        """,
        rest="""
        objects:
          - {name: post, box: {size: [0.06, 0.06, 0.9]}, static: true,
             pose: {frame: base_link, xyz: [0.517, 0.188, 0.45]}}
        expect:
          - clearance: {between: [robot, post], max_below_plan: 1 mm, during: swing}
          - clearance: {between: [robot, post], max_below_plan: 5 cm, during: swing}
        """,
    )
    tight, loose = result.verdicts
    assert (tight.status, loose.status) == ("failed", "passed"), result.verdicts
    assert "planned" in tight.reason
    actual, planned = saved.signals.clearances, saved.signals.planned_clearances
    loss = planned["robot", "post"] - actual["robot", "post"]
    assert tight.measures[0].value == pytest.approx(np.nanmax(loss))
    lag = np.nanmax(np.abs(saved.signals.joint_commands - saved.signals.joint_positions))
    assert 0.1 * lag < np.nanmax(loss) < lag, "the arm reaches half a metre"


@pytest.mark.nightly
def test_pressing_fingers_are_not_planned_to_be_inside_of_what_they_press(tmp_path):
    result, saved = run(
        tmp_path,
        """
        - move_to: mogi_home
        - pick: green_cylinder
        """,
        world="lesson_ur",
        rest="""
        expect:
          - clearance: {max_below_plan: 2 mm}
          - clearance: {between: [green_cylinder, any], max_below_plan: 3 mm}
        """,
    )
    assert [verdict.status for verdict in result.verdicts] == ["passed"] * 2, result.verdicts
    assert {key for key in saved.signals.planned_clearances if key[0] == "green_cylinder"}


def test_the_worst_joint_is_reported_with_its_lag(tmp_path):
    _, saved = run(
        tmp_path,
        "- inject: {command_latency: 20 ms}\n- ptp: {joints: {shoulder_pan_joint: 1.0}}",
    )
    (found,) = findings(saved, "tracking")
    assert found.values["joint"] == "shoulder_pan_joint"
    assert found.values["error"] > 0.01


def test_an_allowed_pair_that_touched_is_reported_with_time_and_force(tmp_path):
    _, saved = run(
        tmp_path,
        """
        - move_to: mogi_home
        - allow_collisions:
            pairs: [[robot, post]]
            during:
              - ptp: {joints: {shoulder_pan_joint: -1.5707}}
                expect_error: CONTROL_FAILED
        """,
        rest="""
        objects:
          - name: post
            box: {size: [0.06, 0.06, 0.9]}
            pose: {frame: base_link, xyz: [0.3, 0.3, 0.45]}
            static: true
        """,
    )
    found = findings(saved, "allowed_contact")
    assert found
    message = found[0].message
    assert "post touched, as step allow_collisions robot-post allows: first at" in message
    assert found[0].values["peak_force"] > 1.0
