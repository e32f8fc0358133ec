"""Who touched whom, and who could have: by forces made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.geometry import Box, Mesh
from harness.core.spatial import SE3
from harness.judging.contacts import (
    attached,
    bodies,
    bodies_touching,
    could_touch,
    debounced,
    finger_gap,
    force_between,
    is_there,
    pairs_of,
    robot_contact,
    sample_time,
    unseen_contacts,
    was_in_robot,
)
from harness.judging.hands import gripper_of
from harness.judging.window import NotObservable
from tests.judging.synthetic_run import (
    BOX,
    CYLINDER,
    ROBOT,
    TABLE,
    at,
    attachment,
    changed,
    force,
    make_run,
    thing,
)

N = 40


def where(mask):
    return np.flatnonzero(mask).tolist()


def test_the_force_between_two_sets_is_the_sum_over_their_pairs_in_either_order():
    forces = {
        ("left_finger", "box"): np.full(N, 1.0),
        ("box", "right_finger"): np.full(N, 2.0),
        ("Table", "box"): np.full(N, 4.0),
        ("left_finger", "right_finger"): np.full(N, 8.0),
    }
    run = make_run(N, contact_forces=forces)
    fingers = {"left_finger", "right_finger"}
    assert force_between(run, fingers, {"box"}).tolist() == [3.0] * N
    assert force_between(run, {"box"}, fingers).tolist() == [3.0] * N
    assert force_between(run, {"box"}, {"Table", "left_finger"}).tolist() == [5.0] * N
    assert force_between(run, {"box"}, {"palm"}).tolist() == [0.0] * N
    touching = bodies_touching(run, "box")
    assert list(touching) == ["Table", "left_finger", "right_finger"]
    assert list(bodies_touching(run, "box", {"left_finger"})) == ["Table", "right_finger"]
    assert touching["Table"].tolist() == [4.0] * N


def test_a_contact_lasts_ten_milliseconds_longer_than_its_force():
    run = make_run(N)
    assert where(debounced(run, force(N, (10, 12)))) == [10, 11, 12]


def test_the_robot_touches_with_the_sum_of_its_links_and_holds_what_is_welded():
    forces = {
        ("left_finger", "box"): force(N, (10, 12)),
        ("arm_link", "box"): force(N, (11, 20), value=0.5),
        ("Table", "box"): np.full(N, 4.0),
    }
    record = attachment("stand_in", 30, 35, represents="box")
    run = make_run(N, contact_forces=forces, attachments=(record,))
    pressing, hold = robot_contact(run, "box")
    assert pressing[[9, 10, 11, 12, 15, 22]].tolist() == [0, 1, 1.5, 1.5, 0.5, 0]
    assert where(hold) == where(attached(run, "stand_in")) == list(range(30, 35))
    assert not was_in_robot(run, "box", slice(10))
    assert was_in_robot(run, "box", slice(11))
    free = changed(run, contact_forces={})
    assert not was_in_robot(free, "box", slice(N)), "the planning scene alone holds it"
    welded = replace(free, attachments=(replace(record, welded=(0.3, 0.35)),))
    assert not was_in_robot(welded, "box", slice(30))
    assert was_in_robot(welded, "box", slice(31))
    faint = changed(run, contact_forces={("arm_link", "box"): np.full(N, 0.001)})
    assert not was_in_robot(faint, "box", slice(30))


def test_the_gap_of_the_pads_is_interpolated_from_the_grippers_widths():
    run = make_run(N)
    assert finger_gap(run) == pytest.approx(0.04)
    unsorted = np.array([(0.03, 0.06), (0.0, 0.0), (0.01, 0.04)])
    hand = replace(ROBOT.gripper, widths=unsorted)
    assert finger_gap(replace(run, robot=replace(ROBOT, gripper=hand))) == pytest.approx(0.05)
    for odd in (replace(hand, widths=np.zeros((0, 2))), replace(hand, joint="thumb")):
        with pytest.raises(NotObservable, match="widths are not known"):
            finger_gap(replace(run, robot=replace(ROBOT, gripper=odd)))
    with pytest.raises(NotObservable, match="no gripper"):
        gripper_of(replace(run, robot=replace(ROBOT, gripper=None)))


def test_the_words_of_between_mean_sets_of_bodies():
    belief = thing("belief", physics=False)
    run = make_run(N, objects=(TABLE, BOX, belief), contact_forces={("floor", "box"): np.ones(N)})
    links = set(ROBOT.link_names)
    assert bodies(run, "robot") == links
    assert bodies(run, "gripper") == {"left_finger", "right_finger", "palm"}
    assert bodies(run, "any") == links | {"Table", "box", "belief", "floor"}
    assert bodies(run, "palm") == {"palm"}
    assert bodies(run, "box") == {"box"}
    with pytest.raises(NotObservable, match="belief is not in the physics"):
        bodies(run, "belief")
    for word in ("floor", "cup"):
        with pytest.raises(NotObservable, match=f"no body '{word}'"):
            bodies(run, word)
    bare = replace(run, robot=replace(ROBOT, gripper=None))
    with pytest.raises(NotObservable, match="no body 'gripper'"):
        bodies(bare, "gripper")
    handless = replace(ROBOT, gripper=replace(ROBOT.gripper, palm_link=""))
    assert bodies(replace(run, robot=handless), "gripper") == {"left_finger", "right_finger"}


def test_two_bodies_can_touch_while_both_are_in_the_physics():
    spans = {"a": (0.0, 0.1), "b": (0.05, 0.2), "c": (0.3, 0.35)}
    objects = [replace(thing(name), present=(span,)) for name, span in spans.items()]
    objects.append(thing("belief", physics=False))
    run = make_run(N, objects=objects, object_poses={name: at(N) for name in spans})
    assert where(could_touch(run, [("a", "b")])) == list(range(5, 11))
    assert where(could_touch(run, [("a", "b"), ("c", "palm")])) == [*range(5, 11), *range(30, 36)]
    assert where(could_touch(run, [("palm", "arm_link"), ("a", "c")])) == list(range(N))
    assert where(could_touch(run, [("a", "c")])) == where(could_touch(run, [])) == []
    assert not is_there(run, "belief").any()
    assert is_there(run, "palm").all()
    assert pairs_of({"a", "b"}, {"b", "a", "c"}) == {("a", "b"), ("a", "c"), ("b", "c")}


@pytest.mark.parametrize(
    ("other", "distance", "is_missed"),
    [
        (thing("other"), 0.0799, False),
        (thing("other"), 0.0801, True),
        ("palm", 0.0401, True),
        ("palm", 0.0399, False),
    ],
)
def test_what_moves_by_more_than_both_are_thick_may_have_passed_through(other, distance, is_missed):
    """The box is 40 mm thick, and so is the other body; of a link no width is known."""
    name = other if isinstance(other, str) else other.name
    objects = (TABLE, BOX) if isinstance(other, str) else (BOX, other)
    poses = at(N)
    poses[20:, 1] = distance
    run = make_run(N, objects=objects, object_poses={"box": poses, name: at(N)})
    for pair in (("box", name), (name, "box")):
        warnings = unseen_contacts(run, [pair])
        assert bool(warnings) == is_missed
        if warnings:
            [warning] = warnings
            assert f"box moves by {1000 * distance:.0f} mm" in warning.message
            assert "t=0.200 s and is 40 mm thick" in warning.message
    assert not unseen_contacts(run, [(name, "Table")])


def test_a_step_that_puts_objects_somewhere_makes_no_jump_of_theirs_a_missed_contact():
    poses = at(N)
    poses[20:, 1] = 0.5
    for spans, is_missed in (
        (((0.0, 1e9),), True),
        (((0.0, 0.19), (0.19, 1e9)), False),
        (((0.0, 0.18), (0.18, 1e9)), True),
        (((0.0, 0.2), (0.2, 1e9)), True),
        (((0.0, 0.1), (0.1, 0.19), (0.19, 1e9)), False),
    ):
        box = replace(BOX, present=spans)
        run = make_run(N, objects=(TABLE, box), object_poses={"box": poses})
        assert bool(unseen_contacts(run, [("box", "palm")])) == is_missed, spans
    poses[5] = np.nan
    assert unseen_contacts(make_run(N, object_poses={"box": poses}), [("box", "palm")])


def test_an_object_of_unknown_width_is_never_said_to_have_been_missed():
    poses = at(N)
    poses[20:, 1] = 0.5
    mesh = thing("box", Mesh("a.stl", np.ones(3)))
    run = make_run(N, objects=(mesh,), object_poses={"box": poses})
    assert unseen_contacts(run, [("box", "palm")]) == ()
    assert unseen_contacts(make_run(1), [("box", "palm")]) == ()
    both = make_run(N, objects=(BOX, CYLINDER), object_poses={"box": poses, "cylinder": poses})
    assert len(unseen_contacts(both, [("box", "cylinder")])) == 2


def test_the_sample_time_is_the_usual_one():
    assert sample_time(make_run(N)) == pytest.approx(0.01)
    assert sample_time(make_run(1)) == 0.0
    holes = replace(make_run(4).signals, times=np.array([0.0, 0.1, 0.2, 5.0]))
    assert sample_time(replace(make_run(4), signals=holes)) == pytest.approx(0.1)
    assert sample_time(make_run(2)) == pytest.approx(0.01)


def overlapped(depth, link, *, touches=()):
    """Warnings of a run in which a link is inside the box at sample 20 [m]."""
    distance, links = np.full(N, 0.1), np.full(N, -1)
    distance[20], links[20] = -depth, ROBOT.link_names.index(link)
    run = make_run(
        N,
        contact_forces={("palm", "box"): force(N, touches)} if touches else {},
        clearances={("robot", "box"): distance},
        clearance_links={("robot", "box"): links},
    )
    return run, unseen_contacts(run, [("box", "palm"), ("Table", "palm")])


def test_a_link_that_overlaps_an_object_without_contact_may_have_passed_through_it():
    run, (warning,) = overlapped(0.004, "palm")
    assert warning.name == "contact may be missed"
    assert "palm is 4.0 mm inside box between two samples at t=0.200 s" in warning.message
    assert unseen_contacts(replace(run, unrecorded=("clearances",)), [("box", "palm")]) == ()
    assert overlapped(0.0005, "palm")[1] == (), "shapes are off by as much"
    assert overlapped(0.004, "arm_link")[1] == (), "another link than the one that is named"
    for touches, is_missed in (((19, 20), True), ((20, 21), False), ((21, 22), False),
                               ((22, 23), True)):  # fmt: skip
        assert bool(overlapped(0.004, "palm", touches=touches)[1]) == is_missed, touches


@pytest.mark.parametrize(("turn", "is_missed"), [(0.21, True), (0.15, False)])
def test_the_ends_of_a_bar_that_turns_in_its_place_may_pass_through_something(turn, is_missed):
    """They move by 52 and by 37 mm at once; bar and box are 1 and 4 cm thick."""
    bar = thing("bar", Box((0.5, 0.01, 0.01)))
    poses = at(N)
    for row in range(N):
        poses[row, 3:] = SE3.from_xyz_rpy(rpy=(0, 0, turn * row)).quat_wxyz
    run = make_run(N, objects=(BOX, bar), object_poses={"bar": poses})
    assert bool(unseen_contacts(run, [("bar", "box")])) == is_missed
