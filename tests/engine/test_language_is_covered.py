"""Every verb and every predicate is carried out or refused; none is silently accepted."""

from typing import get_args

import pytest

from harness.assertions.judge import EXECUTED
from harness.core.errors import SpecError
from harness.engine.registry import execute, is_available
from harness.session.prepare import prepare
from harness.spec.checks import AnyExpectation
from harness.spec.steps import AnyStep

VERBS = {
    "capture": "{camera: gripper_camera}",
}
CHECKS = {
    "in": "in: {object: red_box, container: Table}",
    "tcp_path": "tcp_path: {line: {start: {xyz: [0, 0, 0]}, end: {xyz: [0, 0, 1]}}}",
    "fraction": "fraction: {at_least: 1}",
    "sees": "sees: {camera: gripper_camera, object: red_box}",
    "until": "{always: within_limits, until: within_limits}",
    "formula": "formula: {formula: x > 0}",
}
PROMISED_VERBS = """
    move_to ptp lin circ sequence cartesian_path
    move_relative gripper grasp release attach_object detach_object add_object
    remove_object move_object clear_objects allow_collisions pick place wait settle
    inject repeat parallel
"""
PROMISED_CHECKS = """
    lifted grasped released in_contact collision clearance tcp_pose joints named_target gripper
    within_limits tracking_error duration placed static always never eventually
"""
SCENARIO = """
scenario: One word of the language
robot: {{model: open_manipulator_x, base: {{xyz: [0, 0, 1.02]}}}}
world: lesson_om
steps:
  - {step}
expect:
  - {check}
"""


def problems(tmp_path, *, step="wait: 1 s", check="within_limits"):
    path = tmp_path / "word.scenario.yaml"
    path.write_text(SCENARIO.format(step=step, check=check))
    with pytest.raises(SpecError) as caught:
        prepare(path)
    return caught.value.problems


def refused_verbs():
    return sorted(
        model.model_fields["do"].default for model in get_args(AnyStep) if not is_available(model)
    )


def refused_checks():
    models = set(get_args(AnyExpectation)) - EXECUTED
    return sorted(model.model_fields["check"].default for model in models)


@pytest.mark.parametrize("verb", refused_verbs())
def test_a_verb_that_is_not_carried_out_is_refused_at_its_line(tmp_path, verb):
    found = problems(tmp_path, step=f"{verb}: {VERBS[verb]}")
    assert [(p.line, p.message) for p in found] == [(6, f"the step `{verb}` is not yet available")]


@pytest.mark.parametrize("check", refused_checks())
def test_a_predicate_that_is_not_judged_is_refused_at_its_line(tmp_path, check):
    found = problems(tmp_path, check=CHECKS[check])
    assert [p.line for p in found] == [8]
    assert found[0].message == f"the expectation `{check}` is not yet available"


def test_everything_that_this_version_promises_is_carried_out():
    verbs = {model.model_fields["do"].default for model in execute}
    assert verbs >= {*PROMISED_VERBS.split()}
    checks = {model.model_fields["check"].default for model in EXECUTED}
    assert checks >= {*PROMISED_CHECKS.split()}
