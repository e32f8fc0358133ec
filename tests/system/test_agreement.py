"""Every run tells where plan and physics differed, with the numbers."""

from pathlib import Path

import pytest

from harness.recording.store import read_run
from harness.session.run_case import run_case
from tests.engine.front_door import run

ROOT = Path(__file__).parents[2]


def findings(saved, kind):
    return [found for found in saved.findings if found.kind == kind]


@pytest.fixture(scope="module")
def weak_grip(tmp_path_factory):
    folder = tmp_path_factory.mktemp("weak") / "r"
    path = ROOT / "scenarios/faults/weak_grip.scenario.yaml"
    run_case(path, report_dir=folder, stills=False)
    return read_run(folder).run


def test_an_object_that_slips_out_is_told_with_the_time_of_its_loss(weak_grip):
    (found,) = findings(weak_grip, "held")
    assert "believed that it held green_cylinder; the physics lost it at" in found.message
    lift = next(step for step in weak_grip.steps if step.id.endswith(".lift"))
    assert lift.start_time < found.values["lost_at"] < lift.end_time
    assert found.values["drift"] > 0.05


def test_planned_clearance_stands_beside_the_actual_one(weak_grip):
    found = findings(weak_grip, "clearance")[0]
    pair = tuple(found.values["pair"])
    row = round(found.time / weak_grip.timestep)
    assert found.values["actual"] == weak_grip.signals.clearances[pair][row]
    assert found.values["planned"] == pytest.approx(found.values["actual"], abs=5e-4)


def test_the_worst_joint_is_told_with_its_lag(tmp_path):
    _, saved = run(
        tmp_path,
        "- inject: {command_latency: 20 ms}\n- ptp: {joints: {shoulder_pan_joint: 1.0}}",
    )
    (found,) = findings(saved, "tracking")
    assert found.values["joint"] == "shoulder_pan_joint"
    assert found.values["error"] > 0.01


def test_an_allowed_pair_that_touched_is_told_with_time_and_force(tmp_path):
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
    assert "post touched, as step steps[1] allows: first at" in found[0].message
    assert found[0].values["peak_force"] > 1.0
