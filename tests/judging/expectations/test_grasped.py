"""grasped: both finger sides touch the object and it moves with the gripper."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.judging.expectations.eventually import Eventually
from harness.judging.expectations.grasped import Grasped
from harness.judging.expectations.gripper import GripperState
from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.placed import Placed
from harness.judging.expectations.released import Released
from tests.judging import evidence_runs as shared
from tests.judging.evidence import AT_ONCE, Evidence, Free, Three
from tests.judging.synthetic_run import (
    BOX,
    ROBOT,
    TABLE,
    attachment,
    changed,
    force,
    heights,
    lift_run,
    make_run,
    pressed,
    thing,
    verdict,
)

ABSENT = np.full((200, 7), np.nan)


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


def test_a_box_between_the_fingers_that_moves_with_them_is_grasped():
    answer = verdict(lift_run(), Grasped(object="box", max_slip=0.005))
    assert answer.status == "passed"
    assert answer.margin == pytest.approx(0.005)


def test_sliding_in_the_hand_a_little_too_far_is_no_grasp():
    run = lift_run()
    slipping = heights(run.signals.object_poses["box"][:, 2] - np.linspace(0, 0.0052 / 0.75, 200))
    answer = verdict(changed(run, object_poses={"box": slipping}), Grasped(object="box"))
    assert answer.status == "failed"
    assert answer.unit == "m"
    assert -0.0005 < answer.margin < 0
    assert "moved 5." in answer.reason


def test_turning_in_the_hand_counts():
    run = lift_run()
    turned = run.signals.object_poses["box"].copy()
    turned[150:, 3:] = SE3.from_xyz_rpy(rpy=(0, 0, 0.11)).quat_wxyz
    answer = verdict(changed(run, object_poses={"box": turned}), Grasped(object="box"))
    assert (answer.status, answer.unit) == ("failed", "rad")
    assert answer.margin == pytest.approx(-0.01)


def test_too_little_force_on_one_side_is_no_grasp_and_both_are_reported():
    run = lift_run()
    weak = {
        **run.signals.contact_forces,
        ("right_finger", "box"): force(200, (50, 200), value=0.04),
    }
    answer = verdict(changed(run, contact_forces=weak), Grasped(object="box", min_force=0.05))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-0.01)
    assert answer.reason.startswith("left finger 2.0 N, right finger 0.04 N")


def test_an_object_only_attached_is_neither_grasped_nor_lifted():
    run = make_run(attachments=[attachment("box", 20, 200)])
    answer = verdict(run, Grasped(object="box"))
    assert answer.status == "failed"
    assert "left finger 0 N, right finger 0 N" in answer.reason
    assert "the planning scene has it attached" in answer.reason
    assert verdict(run, Lifted(object="box")).status == "failed"


@pytest.mark.parametrize("span", [(20, 100), (150, 180)])
def test_an_attachment_at_another_time_is_not_mentioned(span):
    run = make_run(attachments=[attachment("box", *span)])
    answer = verdict(run, Grasped(object="box"))
    assert answer.status == "failed"
    assert "is not between the fingers" in answer.reason
    assert "attached" not in answer.reason


def test_a_planning_object_is_not_grasped_and_the_real_one_is_named():
    stand_in = thing("stand_in", physics=False, pose=(0, 0, 0.02, 1, 0, 0, 0))
    run = lift_run(
        objects=(TABLE, BOX, stand_in),
        attachments=[attachment("stand_in", 45, 200, represents="box")],
    )
    answer = verdict(run, Grasped(object="stand_in"))
    assert answer.status == "failed"
    assert "stands for box" in answer.reason


def test_an_absent_object_is_not_reached_by_the_gripper():
    for spec in (Grasped(object="box"), Released(object="box"), Placed(object="box")):
        assert verdict(absent_box(), spec).status == "not reached"


def test_a_robot_without_a_gripper_grasps_nothing():
    run = replace(make_run(), robot=replace(ROBOT, gripper=None))
    for spec in (Grasped(object="box"), Lifted(object="box"), GripperState(position=0.0)):
        assert verdict(run, spec).status == "not observable"
    assert verdict(run, Grasped(object="nothing")).status == "not observable"


def presses(left, right, n=200, span=(50, 200)):
    """Contact points and forces of both fingers, each (place, force)."""
    sides = {("left_finger", "box"): left, ("right_finger", "box"): right}
    return {pair: pressed(force(n, span), *press) for pair, press in sides.items()}


def test_fingers_that_press_from_the_same_side_hold_nothing():
    down = presses(((0, -0.02, 0), (0, 0, -1)), ((0, 0.02, 0), (0, 0, -1)))
    answer = verdict(lift_run(presses=down), Grasped(object="box"))
    assert answer.status == "failed"
    assert "not between the fingers, they press it from the same side" in answer.reason


def test_the_gap_is_measured_where_the_fingers_touch():
    """Not by the table of the gripper, which may be that of other parts of the fingers."""
    narrow = replace(
        ROBOT, gripper=replace(ROBOT.gripper, widths=np.array([(0.0, 0.0), (0.03, 0.01)]))
    )
    run = replace(lift_run(), robot=narrow)
    assert verdict(run, Grasped(object="box")).status == "passed"
    near = presses(((0, -0.01, 0), (0, 1, 0)), ((0, 0.01, 0), (0, -1, 0)))
    answer = verdict(lift_run(presses=near), Grasped(object="box"))
    assert answer.status == "failed"
    assert "at places 20.0 mm apart, and it is 40.0 mm thick" in answer.reason


@pytest.mark.parametrize(
    ("commanded", "effort", "status"),
    [(0.02, 1.6, "failed"), (0.0, 1.6, "passed"), (0.0, 16.0, "failed")],
)
def test_what_lies_on_fingers_is_grasped_only_if_they_press_it(commanded, effort, status):
    """With 0.8 N each, along the gap, which changes twice as fast as the joint."""
    slanted = presses(((0, -0.02, 0), (0, 0.8, 0.6)), ((0, 0.02, 0), (0, -0.8, 0.6)))
    commands = np.tile([0.0, commanded], (200, 1))
    efforts = np.tile([0.0, effort], (200, 1))
    run = lift_run(presses=slanted, joint_commands=commands, joint_efforts=efforts)
    answer = verdict(run, Grasped(object="box"))
    assert answer.status == status
    if status == "failed":
        assert "it lies on them and they do not press it" in answer.reason
        assert verdict(run, Lifted(object="box", above=0.05)).status == "failed"
        assert verdict(run, Lifted(object="box", above=0.05, cradled=True)).status == "passed"


@pytest.mark.parametrize(("samples", "status"), [(9, "failed"), (12, "passed")])
def test_a_grasp_lasts_for_a_tenth_of_a_second(samples, status):
    run = lift_run(grip=(200 - samples, 200), leave=200)
    answer = verdict(run, Grasped(object="box"))
    assert answer.status == status
    assert (
        answer.status == "passed"
    ) or "pressed for 0.08 s so far, a grasp takes 0.1 s" in answer.reason


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Grasped(object="box"),
            lift_run(),
            shared.slid(lift_run(), 0.0051),
            -1e-4,
            "m",
            shared.NO_BOX,
        ),
    ),
    mutation_cases=((Grasped(object="box"), lift_run(), ""),),
    picture=(
        ("pick", "{object: red_box, during: lift}"),
        ("slippery", "{object: red_box, during: hold}"),
    ),
    free_shifts=(
        Free(
            "a firmer grip is a grip",
            "grasped",
            "contact_forces left_finger, contact_forces right_finger",
            "+",
        ),
        Free(
            "where a finger presses is free, only that they press against each other as far"
            " apart as the object is thick",
            "grasped",
            "presses left_finger",
            "+-x +-z -y +force_y",
        ),
        Free(
            "the same from the other side", "grasped", "presses right_finger", "+-x +-z +y -force_y"
        ),
        Free(
            "an object that was held elsewhere all the time has not moved in the hand",
            "grasped",
            "object_poses box, tcp_pose",
            "+-x +-y +-z +-roll +-pitch +-yaw",
            (AT_ONCE,),
        ),
    ),
)


def test_a_hold_that_is_too_short_states_the_two_rules_in_two_sentences():
    """A grasp takes 0.1 s of pressing, and `for` requires a second of it."""
    spec = Eventually(predicate=Grasped(object="box"), for_=1.0)
    answer = verdict(lift_run(grip=(192, 200)), spec)
    assert answer.status == "failed"
    first, second = answer.reason.split(". It was true ")
    assert first.split(" at t=")[0].endswith("pressed for 0.07 s so far, a grasp takes 0.1 s")
    assert second == "for 0 s at a time at most, and `for` requires 1.0 s"
