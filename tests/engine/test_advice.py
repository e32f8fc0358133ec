"""What a failure advises, where the planner has not explained it."""

from types import SimpleNamespace

import pytest

from harness.core.errors import StepFailed
from harness.engine.advice import advice
from harness.recording.execution_failures import ContactForce, ControlFailure


def advised(*touched, known=True, controller="pd_servo"):
    """Of a joint that did not follow its command while links touched bodies."""
    contacts = tuple(ContactForce(("arm", name), 5.0) for name in touched)
    failure = ControlFailure("shoulder", 0.2, 0.1, "rad", 1.0, contacts)
    obj = SimpleNamespace(in_planning=known)
    cell = SimpleNamespace(
        presence={"crate": SimpleNamespace(obj=obj)},
        description=SimpleNamespace(joint_controller=controller),
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
