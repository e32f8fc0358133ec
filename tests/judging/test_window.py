"""Which samples an expectation is judged over, joints and their targets, and numbers in words."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.amounts import amount, amounts, percentages
from harness.judging.expectations.always import Always
from harness.judging.expectations.gripper import GripperState
from harness.judging.expectations.joints import Joints
from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.never import Never
from harness.judging.expectations.placed import Placed
from harness.judging.expectations.upright import Upright
from harness.judging.joints import hand_joints, is_measured, near, resting_joints
from harness.judging.window import (
    NotObservable,
    NotReached,
    refuse_changed_later,
    refuse_unrecorded_steps,
    window_of,
)
from harness.plugins.arms.expectations.named_target import NamedTarget
from harness.plugins.cameras.expectations.sees import Sees
from harness.plugins.formulas.expectations.formula import Formula
from harness.plugins.formulas.expectations.until import Until
from harness.plugins.objects.expectations.in_contact import InContact
from harness.plugins.objects.expectations.on import On
from harness.plugins.objects.expectations.static import Static
from harness.robot.mechanism import Mimic
from tests.judging.synthetic_run import ROBOT, changed, make_run, step

STEPS = (
    step("go", 10, 20, path="steps[0]"),
    step("fail", 19, 40, path="steps[1]", status="failed", error_code="CONTROL_FAILED"),
    step("late", 40, 40, path="steps[2]", status="not reached"),
    step("moment", 40, 41, path="steps[3]"),
)


def test_what_a_step_puts_somewhere_shows_in_the_sample_after_it():
    """The step begins with it, a step that it is part of ends with it, a later one begins there."""
    put = {"result": {"moved": ["box"]}}
    steps = (
        step("wait", 0, 11, path="steps[0]"),
        step("before", 10, 11, path="steps[1]"),
        step("all", 10, 11, "sequence", path="steps[2]"),
        step("put", 10, 11, "move_object", path="steps[2].steps[0]", **put),
        step("after", 10, 11, path="steps[3]"),
        step("move", 10, 21, path="steps[4]"),
        step("last", 59, 60, "move_object", path="steps[5]", **put),
    )
    run = make_run(60, steps=steps)
    windows = {name: window_of(run, name) for name in ("wait", "before", "all", "put", "after")}
    assert {name: (window.start, window.stop) for name, window in windows.items()} == {
        "wait": (0, 11), "before": (10, 11), "all": (10, 12), "put": (11, 12), "after": (11, 12)
    }  # fmt: skip
    assert (window_of(run, "move").start, window_of(run, "move").stop) == (11, 21)
    with pytest.raises(NotReached, match="nothing was recorded"):
        window_of(run, "last")


PUT_A, PUT_B = ({"result": {"moved": [name]}} for name in ("a", "b"))
ROW = (
    step("before", 0, 11, path="steps[0]"),
    step("all", 10, 11, "sequence", path="steps[1]"),
    step("put a", 10, 11, "move_object", path="steps[1].steps[0]", **PUT_A),
    step("put b", 10, 11, "move_object", path="steps[1].steps[1]", **PUT_B),
    step("again", 10, 11, "move_object", path="steps[2]", **PUT_A),
    step("go", 10, 30, path="steps[3]"),
    step("later", 29, 30, "move_object", path="steps[4]", **PUT_B),
)


@pytest.mark.parametrize(
    ("name", "names", "by"),
    [
        ("put a", {"b"}, "put b"),
        ("put a", {"a"}, "again"),
        ("put a", {"c", "b"}, "put b"),
        ("all", {"a"}, "again"),
        ("all", {"b"}, ""),  # what its own steps did is its own
        ("put b", {"b"}, ""),
        ("put a", {"b2"}, ""),
        ("put a", {"c"}, ""),
        ("again", {"a"}, ""),
        ("before", {"a"}, ""),  # it ends with the sample before
        ("go", {"b"}, ""),
        ("", {"b"}, ""),
    ],
)
def test_what_a_later_step_changed_at_the_same_moment_is_not_judged(name, names, by):
    run = make_run(60, steps=ROW)
    if not by:
        refuse_changed_later(run, name, names)
        return
    with pytest.raises(NotObservable, match=f"step '{by}' changed '.' at the same moment"):
        refuse_changed_later(run, name, names)


POSE = {"frame": "c", "xyz": [0, 0, 0]}


@pytest.mark.parametrize(
    ("spec", "names"),
    [
        (Upright(object="a", name="b", during="c"), "a"),
        (On(object="a", support="b"), "a b"),
        (Placed.model_validate({"object": "a", "on": "b", "pose": POSE}), "a b c"),
        (Never(predicate=InContact(between=("a", "robot"))), "a robot"),
        (Always(predicate=Static(object="points"), during="a"), "points"),
        (Until(predicate=Upright(object="a"), until=Lifted(object="b")), "a b"),
        (Formula(formula="z(a) > 1 cm implies force(robot, b) > position(c)"), "a b c robot"),
        (Formula(formula="z(time) > 1 cm and time > 1"), "time"),
        (Sees(camera="a", object="b"), "b"),
        (Sees(camera="a", marker={"id": 1}), ""),
        (NamedTarget(state="home", group="arm"), ""),
        (GripperState(named_target="open"), ""),
        (Joints(positions={"a": 0.1}), ""),
    ],
)
def test_an_expectation_is_about_the_names_in_its_values_and_not_about_its_keys(spec, names):
    assert spec.names() - {"world"} == set(names.split())


def test_a_window_is_that_of_a_step_by_name_or_path_or_the_whole_run():
    run = make_run(60, steps=STEPS)
    for name in ("go", "steps[0]"):
        window = window_of(run, name)
        assert (window.start, window.stop, window.step) == (10, 20, STEPS[0])
    assert window.times.tolist() == run.signals.times[10:20].tolist()
    assert window.time(3) == pytest.approx(0.13)
    assert window.tcp_position.shape == (10, 3)
    whole = window_of(run, "")
    assert (whole.start, whole.stop, whole.step) == (0, 60, None)
    assert window_of(run, "moment").stop == 41
    for name, reason in (
        ("late", "the run ended before step 'late'"),
        ("other", "there is no step 'other'"),
    ):
        with pytest.raises(NotReached, match=reason):
            window_of(run, name)
    for stop in (20, 19):
        with pytest.raises(NotReached, match="nothing was recorded"):
            window_of(make_run(60, steps=(step("go", 20, stop),)), "go")
    unknown = replace(run, unrecorded=("steps",))
    assert window_of(unknown, "go").stop == 20
    with pytest.raises(NotObservable, match="when step 'other' ran"):
        window_of(unknown, "other")
    refuse_unrecorded_steps(run)
    with pytest.raises(NotObservable):
        refuse_unrecorded_steps(unknown)


def test_a_window_is_cut_short_by_a_step_that_failed_and_not_by_one_that_timed_out():
    run = make_run(60, steps=STEPS)
    said = "step 'fail' failed before then: CONTROL_FAILED"
    assert window_of(run, "").cut_short == ""
    assert window_of(run, "go").cut_short == ""
    assert window_of(run, "fail").cut_short == said
    ended = replace(run, ended_early="it stopped")
    assert window_of(ended, "").cut_short == said
    assert window_of(replace(ended, steps=STEPS[:1]), "").cut_short.endswith("then: it stopped")
    for change in ({"error_code": "TIMED_OUT"}, {"error_code": ""}, {"status": "passed"}):
        other = replace(STEPS[1], **change)
        assert window_of(replace(run, steps=(other,)), "fail").cut_short == ""
    inner = replace(STEPS[1], id="inner", path="steps[1][0]")
    nested = replace(run, steps=(*STEPS, inner))
    assert window_of(nested, "fail").cut_short.startswith("step 'inner' failed")


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.9994, "m", "999 mm"),
        (0.9874, "m", "987 mm"),
        (1.0, "m", "1.0 m"),
        (-0.5, "m", "-500 mm"),
        (0.0999, "m", "99.9 mm"),
        (0.1, "m", "100 mm"),
        (0.00004, "m", "0.04 mm"),
        (0.00005, "m", "0.05 mm"),
        (1e-6, "m", "0.001 mm"),
        (0.9e-6, "m", "0 mm"),
        (np.pi, "rad", "180 deg"),
        (5e-6, "rad", "0.0003 deg"),
        (5e-7, "rad", "0 deg"),
        (np.pi / 4, "rad/s", "45.0 deg/s"),
        (0.9874, "m/s", "987 mm/s"),
        (1.0, "m/s", "1.0 m/s"),
        (-1.5, "m/s", "-1.5 m/s"),
        (0.25, "1", "0.25"),
        (3.0, "N", "3.0 N"),
        (np.inf, "N", "inf N"),
        (-np.nan, "m", "nan m"),
    ],
)
def test_numbers_are_written_as_people_read_them(value, unit, text):
    assert amount(value, unit) == text


def test_numbers_that_differ_are_written_with_digits_that_differ():
    assert amounts(0.1, 0.2, "m") == ("100 mm", "200 mm")
    assert amounts(0.10001, 0.10002, "m") == ("100.01 mm", "100.02 mm")
    assert percentages(0.5, 0.25) == ("50.0 %", "25.0 %")
    assert percentages(0.50001, 0.50002) == ("50.001 %", "50.002 %")


def test_joints_that_may_rest_are_the_grippers_its_followers_and_idle_ones():
    shoulder, finger = ROBOT.movable_joints
    idle, driven = replace(shoulder, name="idle"), replace(shoulder, name="driven")
    mimic = replace(finger, name="mimic", mimic=Mimic("finger"))
    robot = replace(ROBOT, joints=(*ROBOT.joints, idle, driven, mimic))
    run = make_run(20, robot=robot)
    commands = run.signals.joint_commands.copy()
    commands[:, 3] = np.arange(20)
    run = changed(run, joint_commands=commands)
    assert hand_joints(run.robot) == {"finger", "mimic"}
    assert resting_joints(run) == {"finger", "mimic", "idle"}
    assert resting_joints(replace(run, unrecorded=("joint_commands",))) == {"finger", "mimic"}
    bare = replace(run, robot=replace(robot, gripper=None))
    assert hand_joints(bare.robot) == frozenset()
    assert resting_joints(bare) == {"finger", "mimic", "idle"} - (
        {"finger"} if (commands[:, 1] != commands[0, 1]).any() else set()
    )
    missing = np.full(20, np.nan)
    assert not is_measured(missing, mimic, "position")
    with pytest.raises(NotObservable, match="the effort of idle was not recorded"):
        is_measured(missing, idle, "effort")
    missing[3] = 0.0
    assert is_measured(missing, idle, "effort")


@pytest.mark.parametrize(
    ("kind", "given", "limit"),
    [("prismatic", False, 0.002), ("prismatic", True, 0.01), ("revolute", False, 0.01)],
)
def test_a_tolerance_that_is_not_given_is_smaller_for_joints_that_slide(kind, given, limit):
    joint = replace(ROBOT.movable_joints[0], kind=kind)
    run = make_run(5, robot=replace(ROBOT, joints=(joint, ROBOT.movable_joints[1])))
    for target, sign in ((limit * 0.99, 1), (limit * 1.01, -1), (-limit * 1.01, -1)):
        margins = near(window_of(run, ""), {"shoulder": target}, 0.01, given)
        assert (margins.values * sign > 0).all()
        assert margins.unit == ("m" if kind == "prismatic" else "rad")
    tight = near(window_of(run, ""), {"shoulder": 0.0015}, 0.001, given)
    assert (tight.values < 0).all()


def test_a_continuous_joint_is_off_by_the_shorter_way_and_the_worst_joint_counts():
    endless = replace(ROBOT.movable_joints[0], kind="continuous")
    run = make_run(5, robot=replace(ROBOT, joints=(endless, ROBOT.movable_joints[1])))
    margins = near(window_of(run, ""), {"shoulder": 2 * np.pi - 0.1}, 0.2, is_given=True)
    assert margins.values == pytest.approx(0.1)
    both = near(window_of(run, ""), {"shoulder": 0.1, "finger": 0.0}, 0.2, is_given=True)
    assert both.values == pytest.approx(0.5)
    assert both.evidence(0).text == "shoulder is off its target by 5.7 deg of 11.5 deg"
    with pytest.raises(NotObservable, match="no joint 'thumb'"):
        near(window_of(run, ""), {"thumb": 0.1}, 0.2, is_given=True)
