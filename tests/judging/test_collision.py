"""Collisions of the robot: contacts, distances, and what is allowed to touch."""

from dataclasses import replace

import numpy as np
import pytest

from harness.judging.expectations.always import Always
from harness.judging.expectations.collision import Collision
from harness.judging.expectations.eventually import Eventually
from harness.judging.expectations.never import Never
from harness.recording.run import Finding
from tests.judging import evidence_runs as shared
from tests.judging.collisions import NEVER, WALL, collides, touching
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import (
    BOX,
    TABLE,
    force,
    lift_run,
    make_run,
    step,
    thing,
    verdict,
)


def test_a_link_that_hits_a_wall_is_reported_with_pair_force_first_time_and_duration():
    run = touching("arm_link", "wall", (30, 41), (60, 70), value=12.0)
    answer = verdict(run, NEVER)
    assert answer.status == "failed"
    assert (answer.margin, answer.unit, answer.time) == (-12.0, "N", pytest.approx(0.3))
    assert answer.reason == (
        "arm_link and wall collide from t=0.300 s for 0.21 s in all, with up to 12.0 N"
    )
    once = verdict(touching("arm_link", "wall", (30, 41), value=12.0), NEVER)
    assert once.reason == "arm_link and wall collide from t=0.300 s for 0.11 s, with up to 12.0 N"
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


def test_a_step_that_was_not_reached_has_no_collisions_to_be_proud_of():
    run = make_run(steps=(step("later", 200, 200, status="not reached"),))
    assert verdict(run, NEVER, "later").status == "not reached"


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
