"""Collisions of what the hand holds: pressing, dragging, leaving and being put down."""

from dataclasses import replace

import numpy as np
import pytest

from harness.judging.expectations.collision import Collision
from harness.judging.expectations.never import Never
from tests.judging.collisions import (
    GRIP,
    NEVER,
    WALL,
    carried,
    collides,
    held_down,
    shelf_poses,
    touching,
)
from tests.judging.synthetic_run import (
    BOX,
    ROBOT,
    TABLE,
    attachment,
    changed,
    force,
    lift_run,
    make_run,
    step,
    thing,
    verdict,
)


def test_a_box_in_the_hand_that_hits_a_wall_is_a_collision_and_one_that_falls_is_not():
    held = lift_run(objects=(TABLE, BOX, WALL))
    assert collides(touching("box", "wall", (150, 155), run=held))
    let_go = lift_run(objects=(TABLE, BOX, WALL), grip=(50, 140))
    assert not collides(touching("box", "wall", (150, 155), run=let_go))
    assert not collides(touching("box", "wall", (30, 35), run=held)), "before it was gripped"


def test_setting_down_and_letting_go_is_no_collision_but_dragging_it_over_the_table_is():
    def lowered(let_go):
        z = np.full(200, 0.12)
        z[:100] = 0.02
        z[150:] = 0.02
        base = lift_run(grip=(50, let_go))
        poses = base.signals.object_poses["box"].copy()
        poses[:, 2] = z
        run = changed(base, object_poses={**base.signals.object_poses, "box": poses})
        return touching("Table", "box", (0, 100), (150, 200), run=run)

    assert not collides(lowered(180))
    assert collides(lowered(200)), "still held at the end: it was never put down"


def test_leaving_the_support_and_bumping_into_it_again_is_a_collision():
    run = touching("Table", "box", (0, 100), (130, 135), run=lift_run())
    assert collides(run)
    within_a_tenth_of_a_second = touching("Table", "box", (0, 100), (105, 107), run=lift_run())
    assert not collides(within_a_tenth_of_a_second)


def test_objects_that_are_not_held_may_touch():
    assert not collides(touching("Table", "box", (0, 200)))
    assert not collides(touching("box", "wall", (0, 200)))


@pytest.mark.parametrize(("newton", "expected"), [(0.98, False), (2.9, False), (3.1, True)])
def test_what_the_hand_holds_presses_with_twice_its_weight_and_a_newton_at_most(newton, expected):
    run = held_down(newton)
    assert collides(run) is expected
    if expected:
        assert "3.1 N over 50 ms, where weight and grip explain 3.0 N" in verdict(run, NEVER).reason


def test_a_short_blow_is_judged_by_its_impulse():
    assert not collides(held_down(5.0, span=(120, 121)))
    assert collides(held_down(40.0, span=(120, 121)))


@pytest.mark.parametrize("blow", [(118, 121), (119, 122), (121, 124)])
def test_the_largest_force_is_never_below_the_average_that_makes_a_collision(blow):
    run = held_down(9.0, span=blow)
    forces = run.signals.contact_forces["Table", "box"]
    forces[blow[1] : blow[1] + 3] = 1.5
    assert "with up to 9.0 N" in verdict(run, NEVER).reason


@pytest.mark.parametrize("names", [("box", "wall"), ("box", "Table"), ("Table", "wall")])
def test_objects_that_the_hand_never_holds_are_not_observable(names):
    run = touching(*names, (30, 60), value=1000.0)
    answer = verdict(run, Never(predicate=Collision(between=names)))
    assert answer.status == "not observable"
    assert "`in_contact` judges" in answer.reason
    objects = (TABLE, BOX, WALL)
    held = touching("box", "wall", (120, 130), run=lift_run(objects=objects), value=1000.0)
    expected = {("box", "wall"): "failed", ("box", "Table"): "passed"}
    answer = verdict(held, Never(predicate=Collision(between=names)))
    assert answer.status == expected.get(names, "not observable")


def test_what_is_put_down_presses_with_twice_its_weight_and_a_newton_at_most():
    z = np.full(200, 0.1)
    z[:100] = z[150:] = 0.02
    base = lift_run(grip=(50, 180), joint_efforts=GRIP)
    poses = base.signals.object_poses["box"].copy()
    poses[:, 2] = z
    placed = changed(base, object_poses={**base.signals.object_poses, "box": poses})
    put_down = touching("Table", "box", (0, 100), (150, 200), run=placed)
    assert not collides(put_down)
    pressed = put_down.signals.contact_forces["Table", "box"].copy()
    pressed[160:164] = 12.9
    forces = {**put_down.signals.contact_forces, ("Table", "box"): pressed}
    assert collides(changed(put_down, contact_forces=forces))


@pytest.mark.parametrize(("distance", "expected"), [(0.019, False), (0.021, True)])
def test_a_held_object_that_is_dragged_along_a_table_is_a_collision(distance, expected):
    aside = np.tile([0.0, 0, 0.02, 1, 0, 0, 0], (200, 1))
    aside[100:, 1] = np.linspace(0, distance, 100)
    run = held_down(0.98, object_poses={"box": aside}, tcp_pose=aside)
    assert collides(run) is expected
    if expected:
        assert "dragged along it by 21.0 mm" in verdict(run, NEVER).reason


@pytest.mark.parametrize(("distance", "expected"), [(0.018, False), (0.022, True)])
def test_letting_go_on_the_way_makes_no_new_drag_and_leaving_the_table_does(distance, expected):
    """Half of the way in each of two holds; what happens between them is no drag."""
    y = np.zeros(200)
    y[60:100] = np.linspace(0, distance / 2, 40)
    y[100:140] = np.linspace(distance / 2, distance / 2 + 0.05, 40)
    y[140:] = np.linspace(y[139], y[139] + distance / 2, 60)
    aside = np.tile([0.0, 0, 0.02, 1, 0, 0, 0], (200, 1))
    aside[:, 1] = y
    base = lift_run(leave=200, object_poses={"box": aside}, tcp_pose=aside)
    spans = [(50, 100), (140, 200)]
    forces = {
        pair: force(200, *spans, value=1.0) if "finger" in pair[0] else values
        for pair, values in base.signals.contact_forces.items()
    }
    run = changed(base, contact_forces=forces)
    on_table = Never(predicate=Collision(between=("box", "Table")))
    assert collides(run, on_table) is expected
    if expected:
        assert "dragged along it by 22.0 mm" in verdict(run, on_table).reason
    lifted_between = {**forces, ("Table", "box"): force(200, (0, 110), (140, 200), value=1.0)}
    assert not collides(changed(base, contact_forces=lifted_between), on_table)


@pytest.mark.parametrize(("newton", "expected"), [(4.4, False), (6.0, True)])
def test_a_contact_that_flickers_presses_with_its_mean(newton, expected):
    """Every other sample, 3 or 4 of the 6 of a mean, against 2.96 N: no break begins a new one."""
    run = held_down(newton)
    forces = run.signals.contact_forces["Table", "box"].copy()
    forces[101::2] = 0.0
    every = {**run.signals.contact_forces, ("Table", "box"): forces}
    assert collides(changed(run, contact_forces=every)) is expected


@pytest.mark.parametrize(("distance", "expected"), [(0.019, False), (0.021, True)])
def test_a_contact_that_flickers_is_dragged_as_one(distance, expected):
    aside = np.tile([0.0, 0, 0.02, 1, 0, 0, 0], (200, 1))
    aside[100:, 1] = np.linspace(0, distance, 100)
    run = held_down(0.98, object_poses={"box": aside}, tcp_pose=aside)
    forces = run.signals.contact_forces["Table", "box"].copy()
    forces[110:199] = 0.0
    forces[110:199:9] = 0.98
    every = {**run.signals.contact_forces, ("Table", "box"): forces}
    assert collides(changed(run, contact_forces=every)) is expected


def test_what_rests_on_a_held_object_weighs_too():
    run = held_down(3.9)
    top = thing("top", mass=0.05)
    poses = {**run.signals.object_poses, "top": run.signals.object_poses["box"] + 0.0}
    poses["top"][:, 2] += 0.04
    forces = {**run.signals.contact_forces, ("box", "top"): force(200, (0, 200), value=0.49)}
    loaded = changed(
        replace(run, objects=(*run.objects, top)), object_poses=poses, contact_forces=forces
    )
    assert collides(run)
    assert not collides(loaded)


def test_a_welded_object_is_held_though_no_finger_touches_it():
    hits = {("box", "wall"): force(200, (120, 140))}
    for welded, expected in (((0.6, 2.0), True), ((0.6, 1.1), False), (None, False)):
        run = make_run(
            objects=(TABLE, BOX, WALL),
            attachments=[replace(attachment("box", 60, 200), welded=welded)],
            contact_forces=hits,
        )
        assert collides(run) is expected


@pytest.mark.parametrize(
    ("spans", "expected"),
    [
        (((40, 45),), False),  # before it is held
        (((40, 60),), False),  # it was there when it was gripped
        (((50, 55),), False),
        (((51, 55),), True),
        (((150, 190),), False),  # after it was released
        (((151, 190),), False),
        (((152, 190),), False),
        (((149, 190),), False),  # put down: it stays where it is
        (((148, 151),), True),  # it touched on its way: the hold lasts to sample 150
        (((148, 152),), False),
        (((40, 48), (55, 60)), False),  # a short gap ends no contact
        (((30, 40), (55, 60)), True),
    ],
)
def test_what_the_hand_holds_may_leave_and_be_put_down_but_hits_nothing_on_its_way(spans, expected):
    assert collides(carried(*spans)) is expected


def test_a_contact_that_nothing_excuses_is_not_explained_by_one_that_is_excused():
    """It leaves the shelf, which presses it with 1 N of 3 N, and hits it again."""
    reason = verdict(carried((40, 60), (80, 85)), NEVER).reason
    assert reason == "box and shelf collide from t=0.800 s for 0.05 s, with up to 1.0 N"


def test_what_is_gripped_again_is_in_the_hand_again():
    run = lift_run(grip=(10, 200), leave=150, objects=(TABLE, BOX, WALL))
    forces = {
        pair: force(200, (10, 40), (90, 200), value=1.0) if "finger" in pair[0] else values
        for pair, values in run.signals.contact_forces.items()
    }
    again = changed(run, contact_forces=forces)
    of_box = Never(predicate=Collision(between=("box", "wall")))
    assert not collides(touching("box", "wall", (50, 60), run=again), of_box), "nothing holds it"
    assert collides(touching("box", "wall", (120, 125), run=again), of_box)


def test_the_put_down_needs_something_below():
    run = carried((145, 180))
    assert not collides(run)
    poses = run.signals.object_poses
    assert collides(changed(run, object_poses={**poses, "shelf": shelf_poses(0.5)}))
    for gone, expected in ((150, True), (151, False)):  # the hand holds it last at sample 150
        shelf = np.where(np.arange(200)[:, None] < gone, poses["shelf"], shelf_poses(0.5))
        assert collides(changed(run, object_poses={**poses, "shelf": shelf})) is expected


def test_what_is_held_may_press_as_much_as_its_weight_explains():
    """2 * 0.98 + 1 = 2.96 N; while the gripper moves the grip of 2 N counts too."""
    efforts = np.zeros((200, 2))
    efforts[:, 1] = 4.0
    for value, steps, expected in (
        (2.9, (), False),
        (3.0, (), True),
        (6.9, (step("open", 85, 200, "gripper"),), False),
        (7.0, (step("open", 85, 200, "gripper"),), True),
    ):
        run = carried((145, 180), steps=(step("close", 39, 80, "gripper"), *steps))
        forces = dict(run.signals.contact_forces)
        forces["box", "shelf"] = force(200, (145, 180), value=value)
        assert collides(changed(run, contact_forces=forces, joint_efforts=efforts)) is expected


def test_what_is_held_may_not_be_dragged_along_what_it_left():
    for distance, expected in ((0.0199, False), (0.0201, True)):
        run = carried((40, 100))
        poses = run.signals.object_poses["box"].copy()
        poses[80:, 0] = distance
        tcp = run.signals.tcp_pose.copy()
        tcp[80:, 0] = distance
        moved = {**run.signals.object_poses, "box": poses}
        run = changed(run, object_poses=moved, tcp_pose=tcp)
        assert collides(run) is expected
        assert ("dragged along it by 20.1 mm" in verdict(run, NEVER).reason) is expected


def test_two_objects_that_no_hand_holds_never_collide():
    assert not collides(touching("box", "wall", (30, 41)))
    bare = replace(ROBOT, gripper=None)
    assert not collides(touching("box", "wall", (30, 41), robot=bare))
