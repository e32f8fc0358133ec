"""What a hand carries, how it moved, and when fingers press: by small signals made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.judging.hold import (
    HOLD_TIME,
    carried_weight,
    cradled,
    gripped,
    held_by_fingers,
    held_for,
    moves_in_hand,
    raised_by_hand,
    recent_mean,
    weight_of,
    welded,
    why_not_between,
)
from tests.judging.synthetic_run import (
    DT,
    ROBOT,
    TABLE,
    at,
    attachment,
    changed,
    force,
    heights,
    lift_run,
    make_run,
    pressed,
    step,
    thing,
)

N = 40
WEIGHT = 0.98
LEFT, RIGHT = ("left_finger", "box"), ("right_finger", "box")


def test_a_recent_mean_is_that_of_the_samples_of_the_last_span():
    times = np.array([0.0, 0.01, 0.02, 0.05, 0.1, 0.11])
    rows = np.arange(12.0).reshape(6, 2) ** 2
    run = replace(make_run(6), signals=replace(make_run(6).signals, times=times))
    expected = [rows[(times >= now - 0.05 - 1e-9) & (times <= now)].mean(axis=0) for now in times]
    assert recent_mean(run, rows, 0.05) == pytest.approx(np.array(expected))


def test_weight_is_that_of_the_worlds_gravity_and_of_no_unknown_mass():
    run = make_run(N)
    assert weight_of(run, "box") == pytest.approx(WEIGHT)
    assert weight_of(replace(run, gravity=(3.0, 0.0, -4.0)), "box") == pytest.approx(0.5)
    assert weight_of(make_run(N, objects=(TABLE, thing("box", mass=np.nan))), "box") == 0.0


@pytest.mark.parametrize("gravity", [(0, 0, -9.81), (0, 9.81, 0), (-4.905, 0, 0)])
def test_the_hand_carries_with_fingers_and_palm_against_gravity(gravity):
    up = -np.array(gravity) / np.linalg.norm(gravity)
    presses = {
        LEFT: pressed(np.full(N, 2.0), (0, 0, 0), up),
        ("palm", "box"): pressed(force(N, (20, N), value=0.5), (0, 0, 0), -up),
        ("arm_link", "box"): pressed(np.full(N, 7.0), (0, 0, 0), up),
        ("left_finger", "Table"): pressed(np.full(N, 7.0), (0, 0, 0), up),
    }
    run = replace(make_run(N, presses=presses), gravity=gravity)
    assert carried_weight(run, "box") is None
    frictions = {RIGHT: np.tile(0.25 * up, (N, 1)), ("arm_link", "box"): np.tile(up, (N, 1))}
    carried = carried_weight(changed(run, frictions=frictions), "box")
    assert carried is not None
    assert carried[:20] == pytest.approx(2.25)
    assert carried[-1] == pytest.approx(1.75)
    assert carried[24] == pytest.approx(2.25 - 0.5 * 5 / 11), "a mean of the last 0.1 s"
    assert carried_weight(changed(run, frictions=frictions), "Table") is None


def test_what_is_welded_is_carried_by_the_weld_as_long_as_it_lasts():
    """A grasp that failed is no weld, nor what is only attached; a weld may end before the rest."""
    grasp = step("grasp", 5, 11, "grasp", result={"mode": "weld"})
    frictions = {LEFT: np.zeros((N, 3))}

    def run_with(welded):
        record = replace(attachment("box", 10, 30, represents="soap"), welded=welded)
        return make_run(N, steps=(grasp,), attachments=(record,), frictions=frictions)

    for span, expected in ((None, []), ((0.1, 0.3), range(10, 30)), ((0.12, 0.2), range(12, 20))):
        for name, samples in (("box", expected), ("soap", expected), ("Table", [])):
            assert np.flatnonzero(welded(run_with(span), name)).tolist() == list(samples)
    run = run_with((0.12, 0.2))
    carried = carried_weight(run, "box")
    assert carried is not None
    assert np.isinf(carried).tolist() == welded(run, "box").tolist()


@pytest.mark.parametrize(
    ("share", "beyond", "is_cradled"),
    [(0.5, 0, True), (0.49, 0, False), (0.9, 0.9, True), (0.9, -0.9, True), (0.9, 1.1, False),
     (0.9, -1.1, False)],
)  # fmt: skip
def test_an_object_is_cradled_where_normal_forces_carry_it_and_the_gripper_stands_still(
    share, beyond, is_cradled
):
    """The gripper's joint moves by 0.03 m: it presses where it is commanded 0.3 mm further."""
    presses = {LEFT: pressed(np.full(N, share * WEIGHT + 1e-9), (0, 0, 0), (0, 0, 1))}
    run = make_run(N, presses=presses)
    commands = run.signals.joint_positions.copy()
    commands[:, 1] += 0.0003 * beyond
    commands[:, 0] += 1.0
    run = changed(run, joint_commands=commands)
    assert cradled(run, "box").all() == cradled(run, "box").any() == is_cradled
    weightless = replace(run, objects=(TABLE, thing("box", mass=0.0)))
    assert not cradled(weightless, "box").any()


@pytest.mark.parametrize(
    ("effort", "stalled", "is_cradled"),
    [(2.0, "", False), (1.01, "", False), (0.99, "", True), (3.99, "", False), (4.01, "", True),
     (0.0, "", True), (2.0, "finger", True), (2.0, "shoulder", False)],
)  # fmt: skip
def test_fingers_press_an_object_where_the_force_of_the_drive_reaches_it(
    effort, stalled, is_cradled
):
    """Each side presses with 1 N, horizontally; the gap changes twice as fast as the joint."""
    up = np.array([0.0, 0.0, WEIGHT / 2])
    presses = {
        LEFT: pressed(np.ones(N), (0, -0.02, 0), np.array([0, 1, 0]) + up),
        RIGHT: pressed(np.ones(N), (0, 0.02, 0), np.array([0, -1, 0]) + up),
    }
    faults = {"faults": [{"fault": "joint_stall", "target": stalled, "before": False,
                          "after": True}]}  # fmt: skip
    steps = (step("inject", 0, 1, "inject", result=faults),) if stalled else ()
    run = make_run(N, presses=presses, steps=steps)
    efforts = np.tile([0.0, -effort], (N, 1))
    commands = run.signals.joint_positions - 0.01
    run = changed(run, joint_commands=commands, joint_efforts=efforts)
    assert cradled(run, "box").all() == cradled(run, "box").any() == is_cradled


def test_every_side_must_press_with_the_required_force():
    grips = {
        LEFT: pressed(np.full(N, 1.0), (0, -0.02, 0), (0, 1, 0)),
        RIGHT: pressed(np.full(N, 2.0), (0, 0.02, 0), (0, -1, 0)),
    }
    forces = {LEFT: np.full(N, 1.0), RIGHT: np.full(N, 2.0)}
    run = make_run(N, contact_forces=forces, presses=grips)
    commands = run.signals.joint_positions - 0.01
    run = changed(run, joint_commands=commands)
    assert held_by_fingers(run, "box").all()
    assert held_by_fingers(run, "box", 1.0).all()
    assert not held_by_fingers(run, "box", 1.01).any()
    one = changed(run, contact_forces={LEFT: forces[LEFT]})
    assert not held_by_fingers(one, "box").any()
    faint = {LEFT: np.full(N, 0.001), RIGHT: np.full(N, 2.0)}
    assert held_by_fingers(changed(run, contact_forces=faint), "box", 0.0).all()
    fainter = {LEFT: np.full(N, 0.0009), RIGHT: np.full(N, 2.0)}
    assert not held_by_fingers(changed(run, contact_forces=fainter), "box", 0.0).any()
    without = changed(run, presses={LEFT: grips[LEFT]})
    assert held_by_fingers(without, "box").all(), "an older run has no directions"


def test_what_is_not_between_the_fingers_says_why():
    def why(left, right, at_left=(0, -0.02, 0), at_right=(0, 0.02, 0), beyond=0.01):
        run = make_run(
            N,
            presses={
                LEFT: pressed(np.full(N, 2.0), at_left, left),
                RIGHT: pressed(np.full(N, 2.0), at_right, right),
            },
        )
        return why_not_between(
            changed(run, joint_commands=run.signals.joint_positions - beyond), "box", 20
        )

    assert why((0, 1, 0), (0, -1, 0)) == ""
    assert why((0, 1, 0), (0, 1, 0)) == "they press it from the same side"
    assert why((0, 0, 1), (0, 0, 1), beyond=0) == "it lies on them and they do not press it"
    near = why((0, 1, 0), (0, -1, 0), (0, -0.001, 0), (0, 0.001, 0))
    assert near == "they press it at places 2.0 mm apart, and it is 40.0 mm thick"


def test_a_hold_lasts_since_its_first_sample():
    held = np.array([False, True, True, True, False, True])
    assert held_for(make_run(6), held) == pytest.approx([0, 0, DT, 2 * DT, 0, 0])


def test_what_moves_in_the_hand_is_compared_with_a_tenth_of_a_second_before():
    poses = at(N, (0, 0, 0.1))
    poses[20:, 0] = 0.003
    poses[25:, 3:] = SE3.from_xyz_rpy(rpy=(0, 0, 0.2)).quat_wxyz
    moving = np.linspace(0, 1, N)
    poses[:, 2] += moving
    run = make_run(N, object_poses={"box": poses}, tcp_pose=heights(moving))
    moved, turned = moves_in_hand(run, "box")
    late = round(HOLD_TIME / DT)
    assert np.flatnonzero(moved > 0.002).tolist() == list(range(20, 20 + late))
    assert moved[20:30] == pytest.approx(0.003)
    assert turned[25:35] == pytest.approx(0.2)
    assert np.flatnonzero(turned > 0.1).tolist() == list(range(25, 25 + late))


def test_the_hands_motion_raises_what_it_holds_since_the_hold_began():
    tcp, poses = heights(np.arange(N) * 0.01), heights(np.arange(N) * 0.02)
    run = make_run(N, object_poses={"box": poses}, tcp_pose=tcp)
    held = np.zeros(N, dtype=bool)
    held[5:10] = held[12:15] = held[30:35] = True
    raised = raised_by_hand(run, "box", held)
    assert raised[5:15] == pytest.approx(np.arange(10) * 0.01), "a short gap ends no hold"
    assert raised[30:35] == pytest.approx(np.arange(5) * 0.01)
    assert not raised[:5].any()
    assert not raised[15:30].any()
    assert not raised[35:].any()


def test_a_tilting_hand_raises_what_it_holds_by_the_tilt():
    tcp = at(N)
    tcp[20:, 3:] = SE3.from_xyz_rpy(rpy=(0, -np.pi / 2, 0)).quat_wxyz
    run = make_run(N, object_poses={"box": at(N, (0.1, 0, 0))}, tcp_pose=tcp)
    raised = raised_by_hand(run, "box", np.ones(N, dtype=bool))
    assert raised[:20] == pytest.approx(0.0)
    assert raised[20:] == pytest.approx(0.1)


def test_an_object_is_gripped_where_it_is_welded_or_between_the_fingers():
    run = lift_run(attachments=(attachment("box", 20, 30, is_welded=True),))
    expected = [*range(20, 30), *range(50, 200)]
    assert np.flatnonzero(gripped(run, "box")).tolist() == expected
    bare = replace(run, robot=replace(ROBOT, gripper=None))
    assert np.flatnonzero(gripped(bare, "box")).tolist() == list(range(20, 30))
    believed = lift_run(attachments=(attachment("box", 20, 30),))
    assert np.flatnonzero(gripped(believed, "box")).tolist() == list(range(50, 200))
