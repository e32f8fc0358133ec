"""`clearance` by the names of arms: between two of them, and of one to objects."""

from dataclasses import replace

import numpy as np
import pytest

from harness.judging.contacts import was_in_robot, welded
from harness.judging.expectations.collision import Collision
from harness.judging.expectations.released import Released
from harness.judging.hands import of_arm
from harness.judging.hold import weld_note
from harness.plugins.arms.expectations.clearance import Clearance
from harness.plugins.objects.expectations.in_contact import InContact
from harness.recording.read_run import read_run
from harness.session.check import check_file
from tests.steps.test_several_arms import PAIR, box

TOWARDS = f"""
scenario: one arm picks and turns towards the other
{PAIR}
objects:
{box("a", 0.3, 0.3)}
steps:
  - pick: a
    robot: left
  - move_to: {{joints: {{left_shoulder_pan_joint: -20 deg}}}}
    robot: left
expect:
  - clearance: {{between: [left, right], at_least: 20 cm}}
"""


@pytest.fixture
def run(recorded_run):
    return read_run(recorded_run(TOWARDS) / "run").run


def worst(run, first, second, at_least=0.01):
    return Clearance(between=(first, second), at_least=at_least).verdict(run, "")


def test_two_arms_have_a_distance_in_either_order(run):
    verdicts = [worst(run, *pair) for pair in (("left", "right"), ("right", "left"))]
    assert {verdict.status for verdict in verdicts} == {"passed"}
    assert verdicts[0].margin == verdicts[1].margin
    smallest = float(np.nanmin(run.signals.clearances["left", "right"]))
    assert worst(run, "left", "right", smallest + 0.01).status == "failed"


def test_the_robot_is_as_near_as_its_nearest_arm(run):
    distances = run.signals.clearances
    for name in ("a", "ground_plane"):
        parts = [distances[arm, name] for arm in ("left", "right")]
        whole = distances["robot", name]
        known = np.isfinite(whole)
        assert known.any()
        assert (whole[known] <= np.fmin(*parts)[known] + 1e-9).all()
        assert np.isclose(whole[known], np.fmin(*parts)[known], atol=2e-3).mean() > 0.9


def test_what_one_hand_holds_has_a_distance_to_the_other_arm(run):
    assert np.isnan(run.signals.clearances["left", "a"][-1])
    assert 0.2 < run.signals.clearances["right", "a"][-1] <= 0.25
    assert worst(run, "right", "a").status == worst(run, "a", "right").status == "passed"
    assert np.isnan(run.signals.clearances["robot", "a"][-1])


def test_any_of_an_arm_includes_the_other_arm(run):
    between = float(np.nanmin(run.signals.clearances["left", "right"]))
    verdict = worst(run, "right", "any", between + 0.01)
    assert verdict.status == "failed"


def test_contacts_of_an_arm_by_its_name(run):
    assert Collision(between=("left", "right")).verdict(run, "").status == "failed"  # none
    assert InContact(between=("left", "a")).verdict(run, "").status == "passed"
    assert InContact(between=("right", "a")).verdict(run, "").status == "failed"


@pytest.mark.parametrize("pair", ["left, left", "robot, left", "right, robot"])
def test_an_arm_and_what_contains_it(pair, tmp_path):
    path = tmp_path / "a.scenario.yaml"
    text = f"scenario: a test\n{PAIR}steps:\n  - move_to: up\n    group: arms\n"
    rest = f"expect:\n  - clearance: {{between: [{pair}], at_least: 1 cm}}\n"
    path.write_text(text + rest, encoding="utf-8")
    [problem] = check_file(path).problems
    assert (problem.line, problem.hint) == (9, "name two different arms")


def test_no_object_may_have_the_name_of_an_arm(tmp_path):
    path = tmp_path / "a.scenario.yaml"
    objects = "objects:\n  - {name: left, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [1, 1, 1]}}\n"
    path.write_text(f"scenario: a test\n{PAIR}{objects}steps:\n  - wait: 1\n", encoding="utf-8")
    [problem] = check_file(path).problems
    assert problem.message == "'left' is the name of an arm"


def test_what_an_arm_let_go_says_nothing_of_the_arm_that_never_had_it(run):
    late = slice(len(run.signals.times) - 1, None)
    assert was_in_robot(run, "a", late)
    verdict = Released(object="a", by="right").verdict(run, "")
    assert verdict.status == "passed"
    assert "right does not touch a" in verdict.reason
    assert [each.message for each in verdict.warnings] == ["right never touched a"]
    assert Released(object="a", by="left").verdict(run, "").status == "failed"


def test_a_weld_to_one_hand_is_none_to_the_other(run):
    [record] = run.attachments
    begin, end = float(run.signals.times[-200]), float(run.signals.times[-100])
    run = replace(run, attachments=(replace(record, welded=(begin, end)),))
    assert welded(run, "a").sum() == 100
    assert welded(of_arm(run, "left"), "a").sum() == 100
    assert not welded(of_arm(run, "right"), "a").any()
    assert weld_note(run, "a", -150)
    assert not weld_note(run, "a", -50)
    assert not weld_note(of_arm(run, "right"), "a", -150)
