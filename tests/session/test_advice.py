"""What a failure advises, where the planner has not explained it."""

from types import SimpleNamespace

import pytest

from harness.core.errors import StepFailed
from harness.plugins.diagnosis.advice import advice
from harness.recording.execution_failures import ContactForce, ControlFailure
from tests.session.front_door import run


def advised(*touched, known=True, controller="pd_servo", faults=()):
    """Of a joint that did not follow its command while links touched bodies."""
    contacts = tuple(ContactForce(("arm", name), 5.0) for name in touched)
    failure = ControlFailure("shoulder", 0.2, 0.1, "rad", 1.0, contacts)
    obj = SimpleNamespace(in_planning=known)
    cell = SimpleNamespace(
        presence={"crate": SimpleNamespace(obj=obj)},
        description=SimpleNamespace(joint_controller=controller),
        faults=dict(faults),
    )
    return advice(StepFailed("CONTROL_FAILED", "", failure), cell)


@pytest.mark.parametrize(
    ("touched", "known", "said"),
    [
        (("crate",), False, "the planner does not know crate (it is `in: simulation`)"),
        (("crate",), True, "look where crate stood when this was planned"),
        (("floor", "crate"), True, "look where crate stood when this was planned"),
        ((), True, "lower the scaling factors in `planning`"),
        (("floor",), True, "lower the scaling factors in `planning`"),
    ],
)
def test_a_joint_that_does_not_follow_is_explained_by_what_the_robot_touches(touched, known, said):
    assert advised(*touched, known=known).startswith(said)


def test_what_nothing_is_known_of_has_no_advice():
    assert advice(StepFailed("FAILURE", ""), SimpleNamespace()) == ""


def test_a_fault_that_was_injected_is_the_first_thing_to_look_at():
    faults = {"joint stall of elbow": 7, "command latency": 9}
    said = "look first at the faults that were injected: joint stall of elbow (line 7), command"
    assert advised("crate", faults=faults).startswith(said)


def test_a_stalled_joint_is_explained_by_the_step_that_stalled_it(tmp_path):
    steps = """
    - inject: {joint_stall: elbow_joint}
    - move_to: {joints: {elbow_joint: 30 deg}}
    """
    result, _ = run(tmp_path, steps)
    [_, step] = result.steps
    assert step.error_code == "CONTROL_FAILED"
    assert any("joint stall of elbow_joint (line " in line for line in step.explanation)
