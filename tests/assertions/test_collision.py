"""Which contacts are collisions, and what a collision's verdict says."""

from dataclasses import replace

import numpy as np
import pytest

from harness.assertions.collision import colliding
from harness.core.geometry import Box
from harness.expectations.always import Always
from harness.expectations.collision import Collision
from harness.expectations.eventually import Eventually
from harness.expectations.never import Never
from harness.recording.run import Finding
from tests.assertions import evidence_runs as shared
from tests.assertions.evidence import Evidence, Free, Three
from tests.assertions.synthetic_run import (
    BOX,
    ROBOT,
    TABLE,
    attachment,
    changed,
    force,
    lift_run,
    make_run,
    pressed,
    step,
    thing,
    verdict,
)

NEVER = Never(predicate=Collision())
WALL = thing("wall", Box((0.02, 1, 1)), static=True, pose=(1, 0, 0.5, 1, 0, 0, 0))


def collides(run, spec=NEVER, step_id=""):
    return {"passed": False, "failed": True}[verdict(run, spec, step_id).status]


def touching(a, b, *spans, run=None, value=1.0, **changes):
    """A run with one more contact."""
    base = run or make_run(objects=(TABLE, BOX, WALL), **changes)
    n = len(base.signals.times)
    forces = {**base.signals.contact_forces, (a, b): force(n, *spans, value=value)}
    return changed(base, contact_forces=forces)


def test_a_link_that_hits_a_wall_is_reported_with_pair_force_first_time_and_duration():
    run = touching("arm_link", "wall", (30, 41), (60, 70), value=12.0)
    answer = verdict(run, NEVER)
    assert answer.status == "failed"
    assert (answer.margin, answer.unit, answer.time) == (-12.0, "N", pytest.approx(0.3))
    assert answer.reason == (
        "arm_link and wall collide from t=0.300 s for 0.19 s in all, with up to 12.0 N"
    )
    once = verdict(touching("arm_link", "wall", (30, 41), value=12.0), NEVER)
    assert once.reason == "arm_link and wall collide from t=0.300 s for 0.1 s, with up to 12.0 N"
    measure = answer.measures[0]
    assert (measure.detail, measure.limit, measure.comparison) == ("arm_link and wall", 0.0, "<=")
    assert verdict(run, Collision(between=("robot", "wall"))).status == "passed"


def test_a_moment_without_a_collision_is_one_newton_from_one_by_definition():
    answer = verdict(touching("arm_link", "wall", (30, 41)), Always(predicate=Collision()))
    assert (answer.status, answer.margin, answer.unit) == ("failed", -1.0, "N")
    assert answer.reason.startswith("no collision at this moment")


def test_the_least_force_between_robot_and_wall_is_a_collision():
    assert collides(touching("arm_link", "wall", (30, 31), value=1e-9))
    assert not collides(touching("arm_link", "wall"))


def test_between_picks_the_pair():
    run = touching("arm_link", "wall", (30, 41))
    for pair, expected in (
        (("robot", "wall"), True),
        (("wall", "any"), True),
        (("arm_link", "wall"), True),
        (("gripper", "wall"), False),
        (("robot", "Table"), False),
    ):
        assert collides(run, Never(predicate=Collision(between=pair))) is expected
    unknown = verdict(run, Never(predicate=Collision(between=("robot", "ghost"))))
    assert unknown.status == "not observable"


def test_no_collision_reports_the_distance_that_was_left():
    wall = np.full(200, 0.15)
    wall[80] = 0.03
    run = make_run(
        objects=(TABLE, BOX, WALL),
        clearances={("robot", "wall"): wall, ("robot", "robot"): np.full(200, 0.05)},
    )
    answer = verdict(run, Never(predicate=Collision(between=("robot", "wall"))))
    assert (answer.status, answer.margin, answer.unit) == ("passed", 0.03, "m")
    assert answer.time == pytest.approx(0.8)
    assert "30.0 mm were left between robot and wall" in answer.reason
    itself = verdict(run, Never(predicate=Collision(between=("robot", "robot"))))
    assert "50.0 mm were left between robot and itself" in itself.reason
    assert verdict(make_run(), NEVER).unit == "1", "nothing was measured"
    eventually = verdict(run, Eventually(predicate=Collision(between=("robot", "wall"))))
    assert (eventually.status, eventually.margin) == ("failed", -0.03)


def test_the_distance_to_what_the_planner_alone_knows_is_left_out():
    belief = thing("belief", physics=False)
    key = ("robot", "belief")
    run = make_run(objects=(belief,), clearances={key: np.full(200, -0.01)})
    answer = verdict(run, NEVER)
    assert (answer.status, answer.unit) == ("passed", "1")


def test_distances_that_are_not_known_leave_those_that_are():
    distances = {("robot", "Table"): np.full(200, np.nan), ("robot", "wall"): np.full(200, 0.15)}
    run = make_run(objects=(TABLE, BOX, WALL), clearances=distances)
    answer = verdict(run, NEVER)
    assert (answer.status, answer.margin, answer.unit) == ("passed", 0.15, "m")


def test_pairs_beyond_the_second_are_counted():
    run = touching("arm_link", "wall", (30, 41))
    fingers = ("left_finger", "right_finger")
    for more, said in (
        (("palm",), ""),
        (("palm", *fingers[:1]), "; and 1 more pairs"),
        (("palm", *fingers), "; and 2 more pairs"),
    ):
        several = run
        for link in more:
            several = touching(link, "wall", (50, 60), run=several)
        reason = verdict(several, NEVER).reason
        assert reason.endswith(f"with up to 1.0 N{said}")


def test_a_distance_of_zero_without_contact_is_no_collision():
    run = make_run(objects=(WALL,), clearances={("robot", "wall"): np.zeros(200)})
    assert not collides(run)


def test_pairs_that_touch_by_design_are_no_collision():
    assert collides(touching("arm_link", "palm", (0, 200)))
    allowed = make_run(allowed_contacts=(("palm", "arm_link"),))
    assert not collides(touching("arm_link", "palm", (0, 200), run=allowed))
    assert not collides(touching("base_link", "Table", (0, 200)))
    assert not collides(touching("left_finger", "right_finger", (50, 80)))


def test_allow_collisions_holds_for_its_steps_only():
    steps = (
        step("free", 0, 50),
        step(
            "allowed",
            50,
            100,
            "allow_collisions",
            result={"allowed_collisions": [["robot", "wall"]]},
        ),
        step("later", 100, 200),
    )
    assert not collides(touching("arm_link", "wall", (60, 90), steps=steps))
    assert collides(touching("arm_link", "wall", (90, 105), steps=steps))
    strict = Never(predicate=Collision(count_allowed=True))
    assert collides(touching("arm_link", "wall", (60, 90), steps=steps), strict)
    assert not collides(lift_run(), strict), "a grasp stays one"


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


def test_a_step_that_was_not_reached_has_no_collisions_to_be_proud_of():
    run = make_run(steps=(step("later", 200, 200, status="not reached"),))
    assert verdict(run, NEVER, "later").status == "not reached"


def held_down(newton, *, span=(100, 200), run=None, **changes):
    """The box, held at the height of the table, with a force between the two."""
    base = run or lift_run(leave=200, **changes)
    forces = {**base.signals.contact_forces, ("Table", "box"): force(200, (0, 200), value=1.0)}
    forces["Table", "box"][slice(*span)] = newton
    return changed(base, contact_forces=forces)


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


GRIP = np.tile([0.0, 20.0], (200, 1))
"""Efforts; the gap changes by 2 m a metre: 10 N on each side."""


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
    for mode, expected in (("weld", True), ("friction", False)):
        grasp = step("grasp", 39, 80, "grasp", result={"mode": mode, "attached": "box"})
        run = make_run(
            objects=(TABLE, BOX, WALL),
            steps=(grasp,),
            attachments=[attachment("box", 60, 200)],
            contact_forces=hits,
        )
        assert collides(run) is expected


def test_bodies_that_overlap_at_the_start_are_a_collision_by_their_depth():
    overlap = Finding("overlap", "", values={"pair": ["arm_link", "wall"], "depth": 0.012})
    run = replace(touching("arm_link", "wall", (0, 5), value=50.0), findings=(overlap,))
    answer = verdict(run, NEVER)
    assert (answer.status, answer.margin, answer.unit) == ("failed", -0.012, "m")
    assert answer.reason.startswith("arm_link and wall overlap by 12.0 mm at the start")
    [measure] = answer.measures
    assert (measure.value, measure.limit, measure.comparison) == (-0.012, 0.0, ">=")
    assert measure.time == 0.0
    later = replace(touching("arm_link", "wall", (3, 8), value=50.0), findings=(overlap,))
    assert verdict(later, NEVER).unit == "N", "they were apart at the first sample"
    elsewhere = replace(overlap, values={"pair": ["palm", "wall"], "depth": 0.012})
    assert verdict(replace(run, findings=(elsewhere,)), NEVER).unit == "N", "another pair"
    always = verdict(run, Always(predicate=Collision()))
    assert (always.status, always.margin, always.unit) == ("failed", -1e-6, "m")
    assert always.reason.startswith("no collision at this moment")


def test_links_inside_each_other_that_the_srdf_excludes_count_where_allowed_pairs_do():
    depth = force(200, (50, 80), value=0.04)
    run = make_run(
        link_overlaps={("arm_link", "palm"): depth}, allowed_contacts=(("arm_link", "palm"),)
    )
    strict = Never(predicate=Collision(count_allowed=True))
    assert not collides(run)
    answer = verdict(run, strict)
    assert (answer.status, answer.margin, answer.unit) == ("failed", -0.04, "m")
    assert "arm_link and palm are up to 40.0 mm inside each other from t=0.500 s" in answer.reason
    elsewhere = Never(predicate=Collision(between=("palm", "box"), count_allowed=True))
    assert not collides(run, elsewhere)


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Never(predicate=Collision(between=("robot", "box"))),
            shared.near(0.05),
            shared.touched(0.05),
            -0.05,
            "N",
        ),
    ),
    mutation_cases=(
        (
            Never(predicate=Collision(between=("robot", "box"))),
            shared.late(
                contact_forces={("arm_link", "box"): force(shared.N, (20, 60))},
                clearances={("robot", "box"): shared.DISTANT},
            ),
            "late",
        ),
        (
            Never(predicate=Collision(count_allowed=True)),
            shared.late(
                link_overlaps={("arm_link", "palm"): force(shared.N, (20, 60), value=0.04)}
            ),
            "late",
        ),
        (
            Never(predicate=Collision()),
            shared.late(clearances={("robot", "box"): shared.DISTANT}),
            "late",
        ),
    ),
    picture=(("pick", "never: {collision: {}}"), ("wall", "never: {collision: {}}")),
    free_shifts=(
        Free("less than no contact is none", "collision", "contact_forces", "-"),
        Free("less than no overlap is none", "collision 2", "link_overlaps", "-"),
        Free("contacts decide; how near it came is shown", "collision 3", "clearances", "+-"),
    ),
)


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


def test_names_of_allowed_pairs_and_their_words_count_in_either_order():
    for allowed, expected in (
        (("arm_link", "wall"), False),
        (("wall", "arm_link"), False),
        (("wall", "robot"), False),
        (("any", "wall"), False),
        (("gripper", "wall"), True),
        (("arm_link", "Table"), True),
        (("box", "wall"), True),
    ):
        base = make_run(objects=(TABLE, BOX, WALL), allowed_contacts=(allowed,))
        assert collides(touching("arm_link", "wall", (30, 41), run=base)) is expected, allowed


def test_a_fixed_link_that_hits_what_moves_and_a_moving_one_that_hits_a_table_collide():
    assert collides(touching("base_link", "box", (30, 41)))
    assert collides(touching("arm_link", "Table", (30, 41)))


def carried(*spans, **changes):
    """A box that is held from 0.5 to 1.5 s and touches a shelf below it at some spans."""
    shelf = thing("shelf", Box((0.5, 0.5, 0.02)), static=True)
    run = lift_run(grip=(50, 150), objects=(TABLE, BOX, shelf), **changes)
    forces = {**run.signals.contact_forces, ("box", "shelf"): force(200, *spans, value=1.0)}
    poses = {**run.signals.object_poses, "shelf": shelf_poses(-0.02)}
    return changed(run, contact_forces=forces, object_poses=poses)


def shelf_poses(z):
    poses = np.zeros((200, 7))
    poses[:, 2], poses[:, 3] = z, 1.0
    return poses


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
    assert reason == "box and shelf collide from t=0.800 s for 0.04 s, with up to 1.0 N"


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
    above = changed(run, object_poses={**run.signals.object_poses, "shelf": shelf_poses(0.5)})
    assert collides(above)


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
