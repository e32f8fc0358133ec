"""What decides at the edge of a rule: the sample next to a limit, the second of two, the absent."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.geometry import Box
from harness.core.spatial import SE3
from harness.judging.excused_force import load_of
from harness.judging.expectations.always import Always
from harness.judging.expectations.collision import Collision
from harness.judging.expectations.duration import DurationCheck
from harness.judging.expectations.eventually import Eventually
from harness.judging.expectations.grasped import Grasped
from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.never import Never
from harness.judging.expectations.placed import Placed
from harness.judging.expectations.upright import Upright
from harness.judging.expectations.within_limits import WithinLimits
from harness.judging.hold import HOLD_TIME, why_not_between
from harness.judging.temporal import eventually
from harness.judging.window import window_of
from harness.plugins.arms.expectations.clearance import Clearance, unknown_distances
from harness.plugins.arms.expectations.named_target import NamedTarget
from harness.plugins.formulas.expectations.until import Until
from harness.plugins.objects.expectations.displaced import Displaced
from harness.plugins.objects.expectations.in_ import In
from harness.plugins.objects.expectations.in_contact import InContact
from harness.plugins.objects.expectations.static import Static
from harness.recording.run import Finding
from harness.robot.description import NamedState, PlanningGroup
from tests.judging.synthetic_run import (
    BOX,
    ROBOT,
    TABLE,
    at,
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

N = 200
WALLS = tuple(thing(f"wall{n}", static=True, pose=(n, 0, 0, 1, 0, 0, 0)) for n in range(6))


# -- windows ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("samples", "is_warned"), [(1, True), (2, False), (3, False)])
def test_what_always_holds_for_one_sample_was_hardly_observed(samples, is_warned):
    run = make_run(steps=(step("short", 50, 50 + samples),))
    answer = verdict(run, Always(predicate=Upright(object="box")), "short")
    assert answer.status == "passed"
    assert [each.name for each in answer.warnings] == ["hardly observed"] * is_warned


@pytest.mark.parametrize("shown", [1, 2, 3])
def test_what_is_there_for_a_hundredth_of_a_window_was_hardly_observed(shown):
    poses = at(N, (0, 0, 0.02))
    poses[: N - shown] = np.nan
    late = replace(BOX, present=(((N - shown) / 100, 1e9),))
    run = make_run(objects=(TABLE, late), object_poses={"box": poses})
    answer = verdict(run, Never(predicate=InContact(between=("palm", "box"))))
    assert answer.observed.samples == shown
    assert bool(answer.warnings) == (shown <= 2)


def test_samples_that_are_not_known_hold_for_no_time():
    poses = at(N, (0, 0, 0.02))
    poses[50:80] = np.nan
    tilted = SE3.from_xyz_rpy(rpy=(1, 0, 0)).quat_wxyz
    poses[100:, 3:] = tilted
    poses[:20, 3:] = tilted
    run = make_run(object_poses={"box": poses})
    answer = verdict(run, Eventually(predicate=Upright(object="box"), **{"for": 2.5}))
    assert answer.status == "failed"
    spec = Eventually(predicate=Upright(object="box"), **{"for": 0.9})
    answer = verdict(run, spec)
    assert answer.status == "failed", "0.8 s with its hole"
    assert answer.reason.endswith("true for 0.29 s at a time at most, and `for` requires 0.9 s")


@pytest.mark.parametrize(
    ("code", "is_cut"),
    [
        ("TIMED_OUT", False),
        ("UNABLE_TO_AQUIRE_SENSOR_DATA", True),
        ("UNRECOGNIZED_GOAL_TYPE", True),
        ("CONTROL_FAILED", True),
    ],
)
def test_a_step_is_cut_short_by_any_failure_but_its_timeout(code, is_cut):
    run = make_run(steps=(step("go", 0, 50, status="failed", error_code=code),))
    assert bool(window_of(run, "go").cut_short) == is_cut


def test_among_equal_margins_the_one_that_came_furthest_decides_and_unknown_progress_is_least():
    progress = np.array([np.nan, -5.0, -2.0, -9.0])
    assert eventually(np.zeros(4), np.arange(4.0), progress=progress).index == 2


def test_an_until_that_comes_at_the_second_sample_did_not_come_at_once():
    contact = {("palm", "box"): force(N, (1, N))}
    spec = Until(predicate=Upright(object="box"), until=InContact(between=("palm", "box")))
    assert verdict(make_run(contact_forces=contact), spec).warnings == ()
    contact = {("palm", "box"): force(N, (0, 1))}
    (warning,) = verdict(make_run(contact_forces=contact), spec).warnings
    assert "held at t=0.000 s, the first sample, so that `upright` was judged at none" in str(
        warning
    )


@pytest.mark.parametrize(("held", "is_warned"), [(0.3, True), (0.29, True), (0.31, False)])
def test_an_until_came_at_once_where_its_whole_hold_did(held, is_warned):
    contact = {("palm", "box"): force(N, (0, 31), (60, 150))}
    inner = InContact(between=("palm", "box"), **{"for": held})
    answer = verdict(
        make_run(contact_forces=contact), Until(predicate=Upright(object="box"), until=inner)
    )
    assert (answer.status, bool(answer.warnings)) == ("passed", is_warned)


def test_the_duration_of_a_run_without_steps_is_that_of_its_samples():
    run = make_run()
    assert verdict(run, DurationCheck(at_most=1.99)).margin == pytest.approx(0.0)
    assert verdict(run, DurationCheck(at_most=1.985)).status == "failed"
    late = changed(run, times=run.signals.times + 3.0)
    assert verdict(late, DurationCheck(at_most=1.99)).margin == pytest.approx(0.0)


# -- collisions ------------------------------------------------------------------------------------


def hitting():
    """The arm touches six walls, the later ones later and harder."""
    forces = {("arm_link", wall.name): force(N, (10 * n + 10, 10 * n + 12), value=n + 1.0)
              for n, wall in enumerate(WALLS)}  # fmt: skip
    return make_run(objects=(TABLE, BOX, *WALLS), contact_forces=forces)


def test_of_six_collisions_the_first_two_are_described_and_four_are_measured():
    answer = verdict(hitting(), Never(predicate=Collision()))
    assert (answer.status, answer.margin, answer.time) == ("failed", -6.0, pytest.approx(0.1))
    assert answer.reason == (
        "arm_link and wall0 collide from t=0.100 s for 0.02 s, with up to 1.0 N; arm_link and wall1"
        " collide from t=0.200 s for 0.02 s, with up to 2.0 N; and 4 more pairs"
    )
    assert [each.value for each in answer.measures] == [1.0, 2.0, 3.0, 4.0]
    assert [each.time for each in answer.measures] == pytest.approx([0.1, 0.2, 0.3, 0.4])


def overlapping(count, stop=60):
    """The arm is inside walls for some samples from the start, and the run has its findings."""
    forces = {("arm_link", wall.name): force(N, (0, stop), value=1e3) for wall in WALLS[:count]}
    findings = tuple(
        Finding(
            "overlap", "", 0.0, values={"pair": [wall.name, "arm_link"], "depth": 0.01 * n + 0.01}
        )
        for n, wall in enumerate(WALLS[:count])
    )
    run = make_run(objects=(TABLE, BOX, *WALLS), contact_forces=forces)
    return replace(run, findings=findings)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_overlaps_at_the_start_are_measured_by_their_depths(count):
    answer = verdict(overlapping(count), Never(predicate=Collision()))
    assert (answer.status, answer.unit) == ("failed", "m")
    assert answer.margin == pytest.approx(-0.01 * count)
    assert len(answer.measures) == min(count, 4)
    assert [each.value for each in answer.measures] == pytest.approx(
        [-0.01 * n - 0.01 for n in range(min(count, 4))]
    )
    assert {each.limit for each in answer.measures} == {0.0}
    more = f"; and {count - 2} more pairs" if count > 2 else ""
    assert answer.reason.endswith(more)
    assert answer.reason.count("overlap by") == min(count, 2)
    always = verdict(overlapping(count), Always(predicate=Collision()))
    assert (always.status, always.time) == ("failed", pytest.approx(0.6))


@pytest.mark.parametrize("newton", [1e-3, 0.5, 1.0])
def test_an_overlap_counts_however_softly_the_physics_pushes_it_apart(newton):
    run = overlapping(1)
    soft = {pair: rows * 1e-3 * newton for pair, rows in run.signals.contact_forces.items()}
    answer = verdict(changed(run, contact_forces=soft), Never(predicate=Collision()))
    assert (answer.status, answer.unit) == ("failed", "m")


def test_contacts_that_are_not_known_are_no_collisions_and_exclude_none():
    forces = force(N)
    forces[100:120] = np.nan
    run = make_run(contact_forces={("arm_link", "box"): forces})
    spec = Collision(between=("arm_link", "box"))
    assert verdict(run, Never(predicate=spec)).status == "not observable"
    assert verdict(run, Never(predicate=spec), "").observed is None
    before = replace(run, steps=(step("before", 0, 90), step("around", 90, 150)))
    assert verdict(before, Never(predicate=spec), "before").status == "passed"
    assert verdict(before, Always(predicate=spec), "around").status == "failed"


def test_what_overlapped_without_a_force_at_the_start_does_not_collide_there():
    run = overlapping(2)
    later = {pair: np.roll(rows, 100) for pair, rows in run.signals.contact_forces.items()}
    answer = verdict(changed(run, contact_forces=later), Never(predicate=Collision()))
    assert (answer.status, answer.unit, answer.time) == ("failed", "N", pytest.approx(1.0))


def test_links_inside_each_other_are_measured_from_the_first_sample_to_the_deepest():
    depth = np.zeros(N)
    depth[40:80] = np.linspace(0.001, 0.008, 40)
    run = make_run(link_overlaps={("base_link", "palm"): depth, ("arm_link", "palm"): depth / 4})
    counted = Collision(count_allowed=True)
    answer = verdict(run, Never(predicate=counted))
    assert (answer.status, answer.margin, answer.unit) == ("failed", pytest.approx(-0.008), "m")
    (measure,) = answer.measures
    assert (measure.value, measure.limit, measure.time) == (-0.008, 0.0, pytest.approx(0.4))
    assert "base_link and palm are up to 8.0 mm inside each other from t=0.400 s" in answer.reason
    for spec in (Always(predicate=counted), Always(predicate=counted, during="apart")):
        steps = (step("apart", 80, N),)
        assert verdict(replace(run, steps=steps), spec).status == "failed"
    assert verdict(run, Never(predicate=Collision())).status == "passed"


# -- hands -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("samples", "status"), [(9, "failed"), (10, "passed"), (11, "passed")])
def test_a_box_is_lifted_where_it_is_held_for_a_tenth_of_a_second(samples, status):
    """Samples are 10 ms apart, and a contact counts for one more."""
    run = lift_run(grip=(110, 110 + samples), leave=100)
    frictions = {pair: 4 * rows for pair, rows in run.signals.frictions.items()}
    answer = verdict(changed(run, frictions=frictions), Lifted(object="box", above=0.01))
    assert answer.status == status


@pytest.mark.parametrize(("samples", "said"), [(5, "0.04 s"), (10, "0.09 s")])
def test_a_hold_that_is_too_short_is_shown_with_its_time(samples, said):
    run = replace(lift_run(grip=(N - samples, N)), steps=(step("end", N - 1, N),))
    answer = verdict(run, Always(predicate=Lifted(object="box", above=0.01)), "end")
    assert f"pressed for {said} so far, a grasp takes 0.1 s" in answer.reason
    (held,) = [each for each in answer.measures if each.name == "time held"]
    assert (held.value, held.limit) == (pytest.approx((samples - 1) * 0.01), HOLD_TIME)


@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0.6, 0.8, 0), (0, 0.8, 0.6)])
def test_fingers_may_press_in_any_direction(direction):
    """The contact wanders along the pad while the force changes: its mean is weighted by force."""
    run, direction = lift_run(), np.array(direction)
    presses = {
        (finger, "box"): pressed(
            force(N, (50, N), value=2.0), -0.02 * sign * direction, sign * direction
        )
        for finger, sign in (("left_finger", 1.0), ("right_finger", -1.0))
    }
    assert verdict(changed(run, presses=presses), Grasped(object="box")).status == "passed"
    wandering = {pair: rows.copy() for pair, rows in presses.items()}
    for rows in wandering.values():
        rows[60::2, :3] += 0.5
        rows[60::2, 3:] *= 1e-9
    assert verdict(changed(run, presses=wandering), Grasped(object="box")).status == "passed"


def test_three_sides_are_between_where_any_two_of_them_are():
    sides = {"left": ("left_finger",), "right": ("right_finger",), "thumb": ("palm",)}
    hand = replace(ROBOT.gripper, sides=sides)
    run = lift_run(robot=replace(ROBOT, gripper=hand))
    forces = {**run.signals.contact_forces, ("palm", "box"): force(N, (50, N))}
    down = pressed(force(N, (50, N)), (0, 0, 0.02), (0, 0, -1))
    run = changed(
        run, contact_forces=forces, presses={**run.signals.presses, ("palm", "box"): down}
    )
    assert verdict(run, Grasped(object="box")).status == "passed"
    same = dict.fromkeys(run.signals.presses, down)
    loose = changed(run, presses=same)
    assert verdict(loose, Grasped(object="box")).status == "failed"
    assert why_not_between(loose, "box", 100) == "", "no two sides say why"


@pytest.mark.parametrize("open_position", [0.03, 0.011])
def test_a_gripper_presses_where_it_is_commanded_by_a_hundredth_of_its_range_past_where_it_stands(
    open_position,
):
    """Normal forces carry the box, as those of a trough do."""
    hand = replace(ROBOT.gripper, open_position=open_position, closed_position=0.01)
    reach = open_position - 0.01
    for past, status in ((1.1, "passed"), (0.9, "failed")):
        run = lift_run(robot=replace(ROBOT, gripper=hand))
        commands = run.signals.joint_commands.copy()
        commands[:, 1] -= past * 0.01 * reach
        up = {
            pair: rows + np.array([0, 0, 0, 0, 0, 0.5])
            for pair, rows in run.signals.presses.items()
        }
        efforts = np.full_like(commands, 2.0)
        run = changed(run, joint_commands=commands, joint_efforts=efforts, presses=up)
        assert verdict(run, Grasped(object="box")).status == status


def test_what_floats_above_what_is_carried_is_no_load():
    above = thing("above", mass=0.3)
    run = make_run(objects=(TABLE, BOX, above), object_poses={"above": at(N, (0, 0, 0.06))})
    assert load_of(run, "box") == pytest.approx(0.1 * 9.8, rel=0.01)
    touching = changed(run, contact_forces={("above", "box"): force(N, (0, N))})
    assert load_of(touching, "box") == pytest.approx(0.4 * 9.8, rel=0.01)


def test_a_planning_object_names_what_it_stands_for_now():
    stand_in = thing("stand_in", physics=False, pose=(0, 0, 0.02, 1, 0, 0, 0))
    run = make_run(
        objects=(TABLE, BOX, thing("other"), stand_in),
        object_poses={"other": at(N, (1, 0, 0.02))},
        attachments=[
            attachment("stand_in", 10, 20, represents="box"),
            attachment("stand_in", 30, 40, represents="other"),
        ],
    )
    assert verdict(run, Grasped(object="stand_in")).reason.count("it stands for") == 1


# -- objects ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["Zebra", "zebra", "Apple"])
def test_a_distance_that_is_missing_while_both_are_there_is_unknown(name):
    there = replace(thing(name, static=True), present=((0.5, 1e9),))
    distances = np.full(N, 0.1)
    distances[:60] = np.nan
    run = make_run(
        objects=(TABLE, BOX, there),
        object_poses={name: at(N)},
        clearances={("robot", name): distances, ("robot", "robot"): distances},
    )
    assert np.flatnonzero(unknown_distances(run, ("robot", name))).tolist() == list(range(50, 60))
    assert unknown_distances(run, ("robot", "robot")).sum() == 60
    spec = Always(predicate=Clearance(between=("robot", name), at_least=0.05))
    assert verdict(run, spec).status == "not observable"


@pytest.mark.parametrize("given", ["box", None])
def test_everything_stands_still_though_something_is_not_there(given):
    poses = at(N, (0, 0, 0.02))
    poses[:100] = np.nan
    late = replace(BOX, present=((1.0, 1e9),))
    run = make_run(objects=(TABLE, late), object_poses={"box": poses})
    answer = verdict(run, Always(predicate=Static(object=given)))
    assert answer.status == "passed"
    assert answer.observed.samples == (N - 5 if given is None else 95)
    assert answer.observed.unknown == 0


@pytest.mark.parametrize("sample", [1, 2, 100])
def test_what_was_pushed_once_does_not_stand_where_it_stood(sample):
    poses = at(N, (0, 0, 0.02))
    poses[sample:, 0] = 0.1
    carried = {("Table", "box"): force(N, (0, N))}
    run = make_run(object_poses={"box": poses}, contact_forces=carried, support_forces=carried)
    assert verdict(run, Placed(object="box")).warnings == ()


def test_what_turned_in_its_place_stands_where_it_stood():
    poses = at(N, (0, 0, 0.02))
    poses[50:, 3:] = SE3.from_xyz_rpy(rpy=(0, 0, 1.5)).quat_wxyz
    carried = {("Table", "box"): force(N, (0, N))}
    run = make_run(object_poses={"box": poses}, contact_forces=carried, support_forces=carried)
    (warning,) = verdict(run, Placed(object="box")).warnings
    assert "it stands where it stood when the run began" in warning.message


def test_a_state_is_that_of_the_first_group_that_has_it():
    states = (
        *ROBOT.named_states,
        NamedState("park", "extra", {"shoulder": 0.5}),
        NamedState("home", "extra", {"shoulder": 0.9}),
    )
    groups = {**ROBOT.groups, "extra": PlanningGroup("extra", ("shoulder",))}
    run = make_run(robot=replace(ROBOT, groups=groups, named_states=states))
    assert verdict(run, NamedTarget(state="home")).status == "passed"
    assert verdict(run, NamedTarget(state="park")).margin == pytest.approx(0.01 - 0.5)
    assert verdict(run, NamedTarget(state="park", group="arm")).status == "not observable"
    bare = replace(run, robot=replace(run.robot, gripper=None))
    assert verdict(bare, NamedTarget(state="park")).status == "failed"


def test_a_joint_that_cannot_move_is_judged_by_its_tolerance():
    shoulder, finger = ROBOT.movable_joints
    fixed = replace(shoulder, lower=0.0, upper=0.0)
    run = make_run(robot=replace(ROBOT, joints=(fixed, finger)))
    for by, margin in ((0.0, 1e-3), (4e-4, 6e-4), (2e-3, -1e-3)):
        moved = changed(run, joint_positions=run.signals.joint_positions + np.array([by, 0]))
        assert verdict(moved, WithinLimits(velocity=False, effort=False)).margin == pytest.approx(
            margin
        )


def test_a_box_is_displaced_from_where_it_last_appeared():
    poses = at(N, (0, 0, 0.02))
    poses[50:60] = np.nan
    poses[60:, 0] = 0.3
    twice = replace(BOX, present=((0.0, 0.49), (0.6, 1e9)))
    run = make_run(objects=(TABLE, twice), object_poses={"box": poses})
    assert verdict(run, Displaced(object="box")).margin == pytest.approx(-0.01)


@pytest.mark.parametrize(("put", "begin"), [("", "the run began"), ("put", "a step put it there")])
@pytest.mark.parametrize("by", [0.0, 0.0049, 0.0051])
def test_what_a_step_put_somewhere_stands_where_it_was_put(put, begin, by):
    """A step moves the box by 30 cm; 0.5 s later it moves by a little on its own."""
    poses = at(N, (0, 0, 0.02))
    steps = ()
    if put:
        poses[50:, 0] = 0.3
        steps = (step("put", 49, 51, "move_object"), step("wait", 51, N))
    poses[100:, 1] = by
    carried = {("Table", "box"): force(N, (0, N))}
    signals = {"contact_forces": carried, "support_forces": carried}
    run = make_run(object_poses={"box": poses}, steps=steps, **signals)
    warnings = verdict(run, Placed(object="box")).warnings
    assert [each.message.endswith(f"when {begin}") for each in warnings] == [True] * (by < 0.005)
    gripped = {**carried, ("palm", "box"): force(N, (10, 20))}
    handled = changed(run, contact_forces=gripped)
    assert bool(verdict(handled, Placed(object="box")).warnings) == bool(put and by < 0.005)


@pytest.mark.parametrize(
    ("put", "since"),
    [
        (0, "the run began"),
        (60, "a step put one of them there"),
        (N - 1, "a step put one of them there"),
    ],
)
def test_what_a_step_put_into_a_container_is_in_it_since_then(put, since):
    box = thing("bin", Box((0.1, 0.1, 0.1)), static=True)
    poses = at(N, (0, 0, 0.02))
    poses[:put, 0] = 0.3
    steps = (step("put", max(put - 1, 0), put + 1, "move_object"),)
    run = make_run(
        objects=(TABLE, BOX, box), object_poses={"box": poses, "bin": at(N)}, steps=steps
    )
    (warning,) = verdict(run, In(object="box", container="bin")).warnings
    assert warning.message == f"box was in bin since {since}"
    later = poses.copy()
    later[:80, 0] = 0.3
    moved = changed(run, object_poses={**run.signals.object_poses, "box": later})
    came_by_itself = verdict(moved, In(object="box", container="bin")).warnings == ()
    assert came_by_itself == (put < 80), "it came in after the step, if the step was earlier"


@pytest.mark.parametrize("hole", [slice(50, 60), slice(20, 21)])
def test_an_until_whose_first_part_is_not_known_on_the_way_is_not_observable(hole):
    poses = at(N, (0, 0, 0.02))
    poses[hole] = np.nan
    contact = {("palm", "box"): force(N, (150, N))}
    run = make_run(object_poses={"box": poses}, contact_forces=contact)
    spec = Until(predicate=Upright(object="box"), until=InContact(between=("palm", "Table")))
    assert verdict(run, spec).status == "failed", "it never comes, whatever is not known"
    spec = Until(predicate=Upright(object="box"), until=InContact(between=("palm", "box")))
    answer = verdict(run, spec)
    count = hole.stop - hole.start
    assert answer.status == "not observable"
    assert answer.reason == f"{count} samples are not known, and would decide it"
