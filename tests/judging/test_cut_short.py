"""Verdicts of a run that a failed step ended early: only what is decided fails."""

import numpy as np
import pytest

from harness.judging.expectations.always import Always
from harness.judging.expectations.eventually import Eventually
from harness.judging.expectations.grasped import Grasped
from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.never import Never
from harness.judging.expectations.placed import Placed
from harness.judging.expectations.upright import Upright
from harness.plugins.arms.expectations.named_target import NamedTarget
from harness.plugins.formulas.expectations.formula import Formula
from harness.plugins.formulas.expectations.until import Until
from harness.plugins.objects.expectations.displaced import Displaced
from harness.plugins.objects.expectations.in_contact import InContact
from harness.plugins.objects.expectations.static import Static
from harness.plugins.paths.expectations.tcp_path import TcpPath
from tests.judging.synthetic_run import force, heights, lift_run, make_run, step, verdict

EARLY = "PLANNING_FAILED: no path"


def failed(name, start, stop, code="PLANNING_FAILED", **fields):
    return step(name, start, stop, status="failed", error_code=code, **fields)


def stopped(**signals):
    """A run whose second step fails, which ends it."""
    steps = (step("go", 0, 100), failed("pick", 99, 200), failed("pick.reach", 120, 200))
    return make_run(steps=steps, ended_early=EARLY, **signals)


WAITING = [
    Lifted(object="box", above=0.08),
    Lifted(object="box", above=0.08, **{"for": 5}),
    Grasped(object="box"),
    Placed(object="box"),
    Displaced(object="box"),
    NamedTarget(state="open", group="gripper"),
    Upright(object="box"),
    Eventually(predicate=Grasped(object="box"), within=3),
    Until(predicate=Upright(object="box"), until=Lifted(object="box")),
    TcpPath(line={"start": {"xyz": [0, 0, 0.3]}, "end": {"xyz": [0, 0, 0.5]}}),
    Formula(formula="eventually z(box) > 5 cm"),
    Formula(formula="not always z(box) < 5 cm"),
    Formula(formula="z(box) < 5 cm until z(box) > 5 cm"),
]


@pytest.mark.parametrize("spec", WAITING, ids=lambda spec: type(spec).__name__)
@pytest.mark.parametrize("place", ["", "pick"])
def test_what_could_still_come_true_is_not_reached_and_names_the_step_that_failed(spec, place):
    answer = verdict(stopped(), spec, place)
    assert answer.status == "not reached"
    assert answer.reason == "step 'pick.reach' failed before then: PLANNING_FAILED"
    complete = make_run(steps=(step("pick", 0, 200),))
    assert verdict(complete, spec, place).status in ("failed", "passed")


MOVING = {"tcp_pose": heights(np.where(np.arange(200) < 50, 0.3, 0.32))}
TOUCH = {"contact_forces": {("palm", "box"): force(200, (120, 130))}}
DECIDED = [
    (Always(predicate=Lifted(object="box")), {}),
    (Never(predicate=InContact(between=("palm", "box"))), TOUCH),
    (Eventually(predicate=Grasped(object="box"), within=0.5), {}),
    (Eventually(predicate=Grasped(object="box"), within=0.2, **{"for": 0.3}), {}),
    (Until(predicate=Lifted(object="box"), until=Grasped(object="box")), {}),
    (Until(predicate=Upright(object="box"), until=Lifted(object="box"), within=0.5), {}),
    (TcpPath(line={"start": {"xyz": [1, 0, 0.3]}, "end": {"xyz": [1, 0, 0.5]}}), {}),
    (Formula(formula="always z(box) > 5 cm"), {}),
    (Formula(formula="eventually[0, 0.5] z(box) > 5 cm"), {}),
    (Formula(formula="z(box) > 5 cm until z(box) > 9 cm"), {}),
]


@pytest.mark.parametrize(("spec", "signals"), DECIDED)
def test_what_no_continuation_could_make_good_fails_with_its_numbers(spec, signals):
    for place in ("", "pick"):
        answer = verdict(stopped(**signals), spec, place)
        assert answer.status == "failed"
        assert answer.margin < 0


def test_what_held_until_then_and_what_was_complete_before_pass():
    run = stopped()
    for spec in (Always(predicate=Upright(object="box")), Never(predicate=Lifted(object="box"))):
        assert verdict(run, spec).status == "passed"
    assert verdict(run, Static(object="box"), "go").status == "passed"
    assert verdict(run, Grasped(object="box"), "go").status == "failed"
    lifted = lift_run(ended_early=EARLY)
    assert verdict(lifted, Lifted(object="box", above=0.08)).status == "passed"
    assert verdict(lifted, Formula(formula="eventually z(box) > 8 cm")).status == "passed"


@pytest.mark.parametrize("code", ["TIMED_OUT", ""])
def test_a_step_that_had_all_of_its_time_is_judged(code):
    """A step that timed out, and one that should have failed and did not."""
    run = make_run(steps=(failed("wait", 0, 200, code),), ended_early="TIMED_OUT: late")
    answer = verdict(run, Displaced(object="box"), "wait")
    assert (answer.status, answer.unit) == ("failed", "m")


def test_a_step_that_failed_as_expected_is_judged():
    run = make_run(
        steps=(step("go", 0, 200, status="expected error", error_code="NO_IK_SOLUTION"),)
    )
    assert verdict(run, Displaced(object="box"), "go").status == "failed"
    assert verdict(run, Displaced(object="box")).status == "failed"
