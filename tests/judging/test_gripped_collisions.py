"""Contacts of the hand with what it grips: when a grip excuses them, and how hard it may press."""

import numpy as np
import pytest

from harness.judging.collision import colliding
from tests.judging.collisions import GRIP, NEVER, carried, collides, held_down, touching
from tests.judging.synthetic_run import (
    attachment,
    changed,
    force,
    lift_run,
    make_run,
    pressed,
    step,
    verdict,
)


def test_a_pick_and_a_lift_are_no_collision():
    assert not collides(lift_run())


def test_a_finger_that_knocks_against_the_box_on_its_way_is_a_collision():
    run = lift_run()
    knocked = touching("left_finger", "box", (20, 25), (50, 200), run=run)
    assert collides(knocked)
    assert verdict(knocked, NEVER).time == pytest.approx(0.2)
    assert not collides(knocked, NEVER, "lift")


def test_the_arm_s_own_link_against_the_box_is_a_collision_even_while_it_is_gripped():
    assert collides(touching("arm_link", "box", (120, 121), run=lift_run()))


def test_a_finger_that_drags_the_box_after_letting_go_is_a_collision():
    steps = (
        step("close", 40, 80, "gripper"),
        step("open", 80, 100, "gripper"),
        step("rest", 100, 120, "wait"),
        step("away", 120, 200),
    )
    both = force(200, (50, 85))
    for until, expected in ((115, False), (125, True)):
        run = make_run(
            steps=steps,
            contact_forces={
                ("left_finger", "box"): force(200, (50, until)),
                ("right_finger", "box"): both,
                ("Table", "box"): force(200, (0, 200)),
            },
        )
        assert collides(run) is expected


def test_being_attached_prolongs_a_grip_but_excuses_no_knock():
    """What the planning scene says makes no push a grip; a grip may lose one finger meanwhile."""
    steps = (step("move", 0, 50), step("close", 50, 60, "gripper"), step("carry", 60, 200))
    attached = make_run(steps=steps, attachments=[attachment("box", 20, 200)])
    assert collides(touching("left_finger", "box", (30, 40), run=attached))
    one_sided = touching("left_finger", "box", (55, 150), run=attached)
    assert collides(one_sided), "a finger that pushes alone grips nothing"
    gripped = touching("right_finger", "box", (55, 58), run=one_sided)
    assert not collides(gripped)
    assert collides(touching("left_finger", "box", (55, 150), run=make_run(steps=steps)))


@pytest.mark.parametrize(
    ("newton", "samples", "expected"),
    [(12.9, 4, False), (12.9, 8, True), (18.0, 4, False), (20.0, 4, True)],
)
def test_what_leaves_its_support_presses_it_with_the_grip_for_a_tenth_of_a_second(
    newton, samples, expected
):
    run = held_down(newton, span=(120, 120 + samples), joint_efforts=GRIP)
    assert collides(run) is expected
    twice = held_down(newton, span=(160, 160 + samples), run=run)
    twice.signals.contact_forces["Table", "box"][120 : 120 + samples] = newton
    assert collides(twice), "the tenth of a second is of the whole contact"


def test_the_grip_explains_more_while_the_gripper_moves():
    gripping = (step("close", 39, 200, "gripper"),)
    assert collides(held_down(20.0, joint_efforts=GRIP))
    assert not collides(held_down(20.0, joint_efforts=GRIP, steps=gripping))
    assert collides(held_down(35.0, joint_efforts=GRIP, steps=gripping))


def test_a_link_of_the_hand_presses_with_its_grip_and_the_weight_at_most():
    run = lift_run(joint_efforts=GRIP)
    assert not collides(touching("palm", "box", (90, 200), run=run, value=20.0))
    rammed = touching("palm", "box", (90, 200), run=run, value=24.0)
    assert collides(rammed)
    assert "where weight and grip explain 23.0 N" in verdict(rammed, NEVER).reason


def test_the_hand_may_grip_hard_only_as_far_as_its_motor_explains():
    """The motor presses with 2 N: fingers and weight explain 2 (2 + 0.98) + 1 = 6.96 N."""
    for value, expected in ((6.9, False), (7.0, True)):
        run = lift_run(value=value)
        efforts = np.zeros((200, 2))
        efforts[:, 1] = 4.0
        run = changed(run, joint_efforts=efforts)
        assert collides(run) is expected
        reason = verdict(run, NEVER).reason
        assert ("7.000 N over 50 ms, where weight and grip explain 6.960 N" in reason) is expected


def excused(grip, *steps, left=None, **changes):
    """Samples at which the left finger touches the box without a collision."""
    run = lift_run(grip=grip, steps=steps, **changes)
    forces = dict(run.signals.contact_forces)
    if left is not None:
        spans = left if isinstance(left[0], tuple) else (left,)
        forces["left_finger", "box"] = force(200, *spans, value=2.0)
        presses = dict(run.signals.presses)
        presses["left_finger", "box"] = pressed(
            forces["left_finger", "box"], (0, -0.02, 0), (0, 1, 0)
        )
        run = changed(run, contact_forces=forces, presses=presses)
    guilty = colliding(run, ("left_finger", "box"))
    return np.flatnonzero((forces["left_finger", "box"] > 0) & ~guilty).tolist()


def test_a_grip_begins_in_a_step_that_moves_the_gripper_and_in_or_next_to_which_it_holds():
    go, still = step("go", 0, 40), step("stay", 60, 200, "wait")
    grip = step("close", 40, 50, "gripper")
    assert excused((50, 100), go, grip, still, left=(45, 100)) == list(range(45, 100))
    assert excused((51, 100), go, grip, still, left=(45, 100)) == []
    assert excused((0, 30), step("close", 0, 5, "gripper")) == list(range(30))
    # held to sample 59: to one before the step that moves the gripper, or to two before it
    for start, expected in ((60, range(60, 80)), (61, ())):
        steps = (step("go", 0, start), step("open", start, 80, "gripper"), step("on", 80, 200))
        assert excused((50, 59), *steps, left=(50, 100)) == list(expected)


def test_a_grip_within_its_limits_is_no_reason_for_another_collision():
    knocked = touching("left_finger", "box", (20, 25), (50, 200), run=lift_run())
    assert "explain" not in verdict(knocked, NEVER).reason


def test_a_grip_ends_with_its_contact_and_lasts_while_every_side_touches():
    steps = (step("go", 0, 40), step("close", 40, 60, "gripper"), step("on", 60, 200))
    record = attachment("box", 60, 200)
    again = ((50, 100), (120, 130))
    held = excused((50, 100), *steps, left=again, attachments=(record,))
    assert held == list(range(50, 100)), "what was let go is struck, and not gripped"
    faint = lift_run(steps=steps)
    for value, expected in ((0.001, range(50, 200)), (0.0009, range(50, 121))):
        forces = dict(faint.signals.contact_forces)
        forces["right_finger", "box"] = np.where(
            np.arange(200) < 120, forces["right_finger", "box"], value
        )
        guilty = colliding(changed(faint, contact_forces=forces), ("left_finger", "box"))
        assert np.flatnonzero(~guilty[50:]).tolist() == [each - 50 for each in expected]


def test_a_gap_of_a_hold_is_no_moment_at_which_it_was_gripped():
    """The fingers lose the box for four samples, in which it hits the shelf."""
    run = carried((92, 100))
    for side in ("left", "right"):
        run.signals.contact_forces[f"{side}_finger", "box"][90:95] = 0.0
    assert collides(run)
