"""Every predicate: a run that satisfies it, one that barely does not, one it says nothing about."""

import re
from dataclasses import replace

import numpy as np
import pytest

from harness.core.geometry import Box, Cylinder, Plane, Shape
from harness.core.spatial import SE3
from harness.recording.run import LinkPlacement
from harness.reporting.margins import allowance_used, margin_share
from harness.session.agreement import held_finding as finding_of_hold
from harness.spec.checks import (
    Always,
    Clearance,
    Displaced,
    DurationCheck,
    Effort,
    Eventually,
    Formula,
    FractionCheck,
    Grasped,
    GripperState,
    In,
    InContact,
    Joints,
    Lifted,
    NamedTarget,
    Never,
    On,
    PathLength,
    Placed,
    Released,
    Slip,
    Static,
    TcpPath,
    TcpPose,
    TrackingError,
    Until,
    Upright,
    WithinLimits,
)
from harness.spec.poses import Pose, PoseTolerance
from tests.assertions.synthetic_run import (
    BOX,
    CYLINDER,
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
    step,
    thing,
    verdict,
)

ABSENT = np.full((200, 7), np.nan)


def held_finding(run):
    """What became of the run's one attachment."""
    (record,) = run.attachments
    found = finding_of_hold(run, record)
    assert found is not None
    return found


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


# lifted


def test_a_box_raised_by_the_fingers_is_lifted_with_its_margin():
    answer = verdict(lift_run(), Lifted(object="box", above=0.05))
    assert (answer.status, answer.unit) == ("passed", "m")
    assert answer.margin == pytest.approx(0.05)


def test_a_box_raised_a_millimetre_too_little_is_not_lifted():
    answer = verdict(lift_run(height=0.049), Lifted(object="box", above=0.05))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-0.001)
    assert answer.reason.startswith("lifted 49.0 mm of 50.0 mm")


@pytest.mark.parametrize(
    ("forces", "said"),
    [
        ({}, "nothing holds box"),
        ({("left_finger", "box"): force(200, (0, 200))}, "right finger 0.0 N; nothing holds box"),
        (
            {
                ("left_finger", "box"): force(200, (0, 200)),
                ("right_finger", "box"): force(200, (0, 200)),
                ("Table", "box"): force(200, (0, 200)),
            },
            "box touches Table",
        ),
        (
            {
                ("left_finger", "box"): force(200, (0, 200)),
                ("right_finger", "box"): force(200, (0, 200)),
                ("arm_link", "box"): force(200, (0, 200)),
            },
            "box touches arm_link",
        ),
    ],
    ids=["thrown", "one finger", "carried by something", "carried by the arm"],
)
def test_height_without_the_fingers_alone_is_not_lifting(forces, said):
    run = lift_run(contact_forces=forces)
    answer = verdict(run, Lifted(object="box", above=0.05))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-0.05)
    assert answer.measures[0].value == pytest.approx(0.1), "the highest sample is the one shown"
    assert said in answer.reason


def test_an_object_put_on_a_shelf_by_a_step_starts_there():
    z = np.full(200, 0.02)
    z[50:] = 0.52
    run = lift_run(object_poses={"box": heights(z)})
    teleported = make_run(
        object_poses={"box": heights(z)},
        contact_forces=run.signals.contact_forces,
        steps=(step("up", 49, 51, "move_object"),),
    )
    assert verdict(teleported, Lifted(object="box", above=0.05)).status == "failed"
    assert verdict(run, Lifted(object="box", above=0.05)).status == "passed", "no step moved it"


def test_steps_that_put_it_up_bit_by_bit_lift_nothing():
    z = 0.02 + 0.004 * np.clip((np.arange(200) - 100) // 10, 0, 9)
    steps = [
        step(f"up{k}", k, k, "move_object", result={"moved": ["box"]}) for k in range(110, 200, 10)
    ]
    run = lift_run(object_poses={"box": heights(z)}, tcp_pose=heights(z), leave=0, steps=steps)
    assert verdict(run, Lifted(object="box", above=0.01)).status == "failed"
    assert verdict(run, Displaced(object="box", at_least=0.01)).status == "failed"
    unmoved = replace(run, steps=())
    assert verdict(unmoved, Lifted(object="box", above=0.01)).status == "passed"


def test_what_rests_on_a_lifted_object_and_the_palm_hold_nothing_up():
    run = lift_run()
    top = thing("top", mass=0.01)
    z = run.signals.object_poses["box"][:, 2] + 0.04
    loads = {**run.signals.contact_forces, ("box", "top"): force(200, (0, 200), value=0.1)}
    poses = {**run.signals.object_poses, "top": heights(z)}
    loaded = changed(
        replace(run, objects=(TABLE, BOX, top)), contact_forces=loads, object_poses=poses
    )
    spec = Lifted(object="box", above=0.05)
    assert verdict(loaded, spec).status == "passed"
    hung = {**loads, ("shelf", "top"): force(200, (0, 200), value=0.1)}
    assert verdict(changed(loaded, contact_forces=hung), spec).status == "failed"
    assert verdict(loaded, Lifted(object="top", above=0.05)).status == "failed"
    palm = {**run.signals.contact_forces, ("palm", "box"): force(200, (90, 200))}
    assert verdict(changed(run, contact_forces=palm), spec).status == "passed"


def test_an_absent_object_was_never_up_for_lifting():
    assert verdict(absent_box(), Lifted(object="box")).status == "not reached"


def test_contact_that_flickers_for_less_than_the_debounce_is_one_contact():
    run = lift_run(n=1000, leave=500, grip=(250, 1000))
    fine = np.arange(1000) * 0.002
    flicker = force(1000, (250, 1000))
    flicker[::4] = 0.0  # every eighth millisecond nothing
    longer = force(1000, (250, 1000))
    longer[800:808] = 0.0
    table = run.signals.contact_forces["Table", "box"]
    for left, status in ((flicker, "passed"), (longer, "failed")):
        forces = {("left_finger", "box"): left, ("right_finger", "box"): left}
        flickering = changed(run, times=fine, contact_forces={**forces, ("Table", "box"): table})
        spec = Lifted(object="box", above=0.05, **{"for": 0.9})
        assert verdict(flickering, spec).status == status


# grasped, released, slip


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


def test_too_little_force_on_one_side_is_no_grasp_and_both_are_told():
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
    assert "left finger 0.0 N, right finger 0.0 N" in answer.reason
    assert "the planning scene has it attached" in answer.reason
    assert verdict(run, Lifted(object="box")).status == "failed"


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


def test_a_box_let_go_is_released_and_one_still_touched_or_attached_is_not():
    assert verdict(lift_run(grip=(50, 150)), Released(object="box")).status == "passed"
    answer = verdict(lift_run(grip=(50, 200), value=0.01), Released(object="box"))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-0.019)
    attached = lift_run(grip=(50, 150), attachments=[attachment("box", 60, 200)])
    assert verdict(attached, Released(object="box")).reason.startswith("the robot touches box")
    assert verdict(attached, Released(object="box")).status == "failed"


def test_slip_is_drift_since_the_fingers_hold_and_not_the_first_offset():
    stand_in = thing("stand_in", physics=False)
    carried = attachment("stand_in", 40, 200, represents="box", pose=SE3.from_xyz_rpy((0.5, 0, 0)))
    run = lift_run(objects=(TABLE, BOX, stand_in), attachments=[carried])
    for name in ("box", "stand_in"):
        answer = verdict(run, Slip(object=name))
        assert answer.status == "passed"
        assert answer.margin == pytest.approx(0.003)
    dropped = run.signals.object_poses["box"].copy()
    dropped[180:, 2] -= 0.0031
    answer = verdict(changed(run, object_poses={"box": dropped}), Slip(object="box"))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-1e-4)
    assert answer.time == pytest.approx(1.8)


def test_turns_about_the_axis_of_a_round_object_are_no_slip_but_tilting_is():
    def spun(rpy, record):
        run = lift_run(objects=(TABLE, record), attachments=[attachment(record.name, 60, 200)])
        poses = run_poses.copy()
        poses[150:, 3:] = SE3.from_xyz_rpy(rpy=rpy).quat_wxyz
        forces = {
            tuple(record.name if body == "box" else body for body in pair): values
            for pair, values in run.signals.contact_forces.items()
        }
        return changed(run, object_poses={record.name: poses}, contact_forces=forces)

    run_poses = lift_run().signals.object_poses["box"]
    assert verdict(spun((0, 0, 0.5), CYLINDER), Slip(object="cylinder")).status == "passed"
    assert verdict(spun((0.06, 0, 0.5), CYLINDER), Slip(object="cylinder")).status == "failed"
    assert verdict(spun((0, 0, 0.06), BOX), Slip(object="box")).status == "failed"


def test_slip_of_what_was_never_held_is_not_reached():
    assert verdict(lift_run(), Slip(object="box")).status == "not reached"
    never_touched = make_run(attachments=[attachment("box", 20, 200)])
    assert verdict(never_touched, Slip(object="box")).status == "not reached"


# placed, on, displaced, upright, static


STANDING = {("Table", "box"): force(200, (0, 200))}
PLACED = Placed(object="box")


def test_a_box_at_rest_on_the_table_is_placed():
    run = make_run(contact_forces=STANDING)
    pose = Pose(xyz=(0.009, 0, 0.02))
    for spec in (
        Placed(object="box"),
        Placed(object="box", on="Table"),
        Placed(object="box", pose=pose),
    ):
        assert verdict(run, spec).status == "passed"
    assert verdict(run, Placed(object="box", pose=pose)).margin == pytest.approx(0.001)


@pytest.mark.parametrize(
    ("changes", "spec", "said"),
    [
        ({"contact_forces": {}}, Placed(object="box"), "box rests on nothing"),
        ({}, Placed(object="box", on="shelf"), "box does not rest on shelf"),
        (
            {"contact_forces": {**STANDING, ("left_finger", "box"): force(200, (199, 200))}},
            Placed(object="box"),
            "contact with the robot 1.0 N",
        ),
        (
            {"attachments": [attachment("box", 0, 300)]},
            Placed(object="box"),
            "attached in the planning scene",
        ),
        ({}, Placed(object="box", pose=Pose(xyz=(0.0101, 0, 0.02))), "position error 10.1 mm"),
        ({}, Placed(object="box", pose=Pose(xyz=(0, 0, 0.02), rpy=(0.11, 0, 2.0))), "lean 6.3 deg"),
        (
            {},
            Placed(
                object="box",
                pose=Pose(xyz=(0, 0, 0.02), rpy=(0, 0, 0.02)),
                tolerance=PoseTolerance(position=0.01, orientation=0.01),
            ),
            "orientation error 1.1 deg",
        ),
    ],
    ids=["hovering", "elsewhere", "touched", "attached", "beside", "leaning", "turned"],
)
def test_what_is_not_quite_placed_is_told_why(changes, spec, said):
    shelf = thing("shelf", Box((0.3, 0.3, 0.02)), static=True, pose=(2, 0, 0, 1, 0, 0, 0))
    run = make_run(**{"objects": (TABLE, BOX, shelf), "contact_forces": STANDING, **changes})
    answer = verdict(run, spec)
    assert answer.status == "failed"
    assert said in answer.reason


@pytest.mark.parametrize(
    ("shape", "yaw", "stated", "error"),
    [
        (Box((0.04, 0.05, 0.04)), 0.005, None, 0.005),
        (Box((0.04, 0.05, 0.04)), np.pi + 0.005, None, 0.005),
        (Box((0.04, 0.05, 0.04)), np.pi / 2, None, np.pi / 2),
        (Box((0.04, 0.04, 0.04)), 0.005 - np.pi / 2, None, 0.005),
        (Cylinder(0.02, 0.04), 1.0, None, 0.0),
        (Box((0.04, 0.04, 0.04)), 1.5, (0, 0, 0), 1.5),
        (Cylinder(0.02, 0.04), 1.0, (0, 0, 0), 1.0),
    ],
)
def test_what_looks_the_same_turned_is_placed_where_no_rotation_is_stated(
    shape, yaw, stated, error
):
    standing = at(200, (0, 0, 0.02))
    standing[:, 3:] = SE3.from_xyz_rpy(rpy=(0, 0, yaw)).quat_wxyz
    run = make_run(
        objects=(TABLE, thing("box", shape)),
        contact_forces=STANDING,
        object_poses={"box": standing},
    )
    pose = Pose(xyz=(0, 0, 0.02), rpy=stated)
    tolerance = PoseTolerance(position=0.01, orientation=0.01)
    answer = verdict(run, Placed(object="box", pose=pose, tolerance=tolerance))
    assert answer.status == ("passed" if error < 0.01 else "failed")
    measure = next(each for each in answer.measures if each.name == "orientation error")
    assert measure.value == pytest.approx(error, abs=1e-9)


def test_a_turning_point_of_a_swing_is_not_still():
    swing = at(200, (0, 0, 0.02))
    swing[:, 0] = 0.001 * np.cos(np.arange(200) * 2 * np.pi / 20)
    run = make_run(contact_forces=STANDING, object_poses={"box": swing})
    assert abs(swing[199, 0] - swing[180, 0]) < 1e-4
    assert verdict(run, Placed(object="box")).status == "failed"
    assert verdict(run, Static(object="box")).status == "failed"


def test_a_spinning_top_is_not_placed():
    spinning = at(200, (0, 0, 0.02))
    for k in range(200):
        spinning[k, 3:] = SE3.from_xyz_rpy(rpy=(0, 0, 0.06 * k * DT)).quat_wxyz
    answer = verdict(make_run(contact_forces=STANDING, object_poses={"box": spinning}), PLACED)
    assert (answer.status, answer.unit) == ("failed", "rad/s")
    assert answer.margin == pytest.approx(-0.01)


def test_what_the_robot_holds_is_no_support_unless_it_is_named():
    tray = thing("tray", Box((0.04, 0.04, 0.01)))
    run = lift_run()
    forces = {
        tuple("tray" if body == "box" else body for body in pair): values
        for pair, values in run.signals.contact_forces.items()
    }
    forces["box", "tray"] = force(200, (0, 200))
    z = run.signals.object_poses["box"][:, 2]
    z = np.where(np.arange(200) < 180, z, z[180])
    held = make_run(
        objects=(TABLE, BOX, tray),
        object_poses={"box": heights(z), "tray": heights(z - 0.025)},
        contact_forces=forces,
        steps=run.steps,
    )
    assert verdict(held, PLACED).status == "failed"
    assert verdict(held, Placed(object="box", on="tray")).status == "passed"


def test_leaning_on_a_wall_is_no_support_from_below():
    wall = thing("wall", Box((0.02, 1.0, 1.0)), static=True, pose=(0.03, 0, 0.5, 1, 0, 0, 0))
    run = make_run(objects=(wall, BOX), contact_forces={("box", "wall"): force(200, (0, 200))})
    assert verdict(run, Placed(object="box")).status == "failed"
    assert verdict(run, On(object="box", support="wall")).status == "failed"


def test_a_box_that_is_pressed_against_something_does_not_stand_on_it():
    contact = {("Table", "box"): force(200, (0, 200), value=30.0)}
    carried = {("Table", "box"): force(200, (0, 200), value=0.4)}
    run = make_run(contact_forces=contact, support_forces=carried)
    answer = verdict(run, On(object="box", support="Table"))
    assert (answer.status, answer.margin) == ("failed", pytest.approx(0.4 - 0.49))
    turned = make_run(
        objects=(TABLE, BOX, CYLINDER),
        contact_forces={("box", "cylinder"): contact["Table", "box"]},
        support_forces={("box", "cylinder"): -carried["Table", "box"] - 1},
        object_poses={"cylinder": at(200, (0, 0, -0.05))},
    )
    assert verdict(turned, On(object="box", support="cylinder")).status == "passed"
    assert verdict(turned, On(object="cylinder", support="box")).status == "failed"


def test_standing_on_something_means_that_it_carries_half_the_weight():
    weight = 0.1 * 9.8
    for value, status in ((weight, "passed"), (0.49 * weight, "failed"), (0.0, "failed")):
        run = make_run(contact_forces={("Table", "box"): force(200, (0, 200), value=value)})
        answer = verdict(run, On(object="box", support="Table"))
        assert answer.status == status
        assert answer.margin == pytest.approx(value - 0.5 * weight)
    assert verdict(absent_box(), On(object="box", support="Table")).status == "not reached"


def test_displaced_is_measured_from_the_start():
    moved = at(200, (0, 0, 0.02))
    moved[100:, 1] = 0.02
    run = make_run(object_poses={"box": moved})
    assert verdict(run, Displaced(object="box", at_least=0.019)).margin == pytest.approx(0.001)
    assert verdict(run, Displaced(object="box", at_least=0.021)).status == "failed"
    assert verdict(run, Never(predicate=Displaced(object="box", at_least=0.02))).status == "failed"
    assert verdict(absent_box(), Displaced(object="box")).status == "not reached"


def test_upright_is_the_lean_of_the_z_axis():
    leaning = at(200, (0, 0, 0.02), SE3.from_xyz_rpy(rpy=(0.1, 0, 1.0)).quat_wxyz)
    run = make_run(object_poses={"box": leaning})
    assert verdict(run, Upright(object="box", tolerance=0.11)).margin == pytest.approx(0.01)
    assert verdict(run, Upright(object="box", tolerance=0.09)).status == "failed"
    assert verdict(absent_box(), Upright(object="box")).status == "not reached"


def test_what_only_the_planner_believes_is_no_observation():
    belief = thing("belief", physics=False, pose=(0, 0, 1, 1, 0, 0, 0))
    run = make_run(objects=(TABLE, BOX, belief))
    for spec in (
        Upright(object="belief"),
        Static(object="belief"),
        Displaced(object="belief"),
        In(object="belief", container="box"),
        Formula(formula="always z(belief) > 0.5"),
    ):
        answer = verdict(run, spec)
        assert answer.status == "not observable", answer
        assert "belief is not in the physics" in answer.reason


def test_everything_stands_still_until_one_thing_moves():
    run = make_run()
    assert verdict(run, Always(predicate=Static())).status == "passed"
    creeping = at(200, (0, 0, 0.02))
    creeping[:, 0] = np.arange(200) * DT * 0.0051
    answer = verdict(changed(run, object_poses={"box": creeping}), Static(max_velocity=0.005))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-1e-4)
    assert answer.reason.startswith("box moves")
    turning = np.zeros((200, 2))
    turning[:, 0] = 0.06
    assert "shoulder" in verdict(changed(run, joint_velocities=turning), Static()).reason
    assert verdict(absent_box(), Static(object="box")).status == "not reached"


# in_contact, clearance


def test_contact_counts_from_the_asked_force_on():
    run = make_run(contact_forces={("left_finger", "box"): force(200, (30, 40), value=2.0)})
    spec = InContact(between=("box", "gripper"), min_force=2.0)
    answer = verdict(run, spec)
    assert (answer.status, answer.margin, answer.time) == ("passed", 0.0, pytest.approx(0.3))
    assert answer.reason.endswith("(first at t=0.300 s, 0.1 s in all, up to 2.0 N) at t=0.300 s")
    weaker = InContact(between=("box", "robot"), min_force=2.1)
    assert verdict(run, weaker).margin == pytest.approx(-0.1)
    assert verdict(run, Never(predicate=InContact(between=("box", "any")))).status == "failed"
    assert verdict(run, InContact(between=("box", "Table"))).status == "failed"
    assert verdict(run, InContact(between=("box", "ghost"))).status == "not observable"


def clearance_run(distance, cutoff=0.15, **changes):
    return make_run(
        clearances={("robot", "box"): np.asarray(distance), ("robot", "Table"): np.full(200, 0.1)},
        clearance_links={("robot", "box"): np.full(200, 2), ("robot", "Table"): np.full(200, -1)},
        clearance_cutoff=cutoff,
        **changes,
    )


def test_clearance_names_the_nearest_link_and_the_moment():
    distance = np.full(200, 0.15)
    distance[70] = 0.012
    spec = Clearance(between=("robot", "box"), at_least=0.01)
    answer = verdict(clearance_run(distance), spec)
    assert answer.status == "passed"
    assert answer.margin == pytest.approx(0.002)
    assert answer.reason == "12.0 mm between arm_link and box, 10.0 mm required at t=0.700 s"
    nearer = Clearance(between=("box", "robot"), at_least=0.0121)
    assert verdict(clearance_run(distance), nearer).status == "failed"


def test_a_distance_may_be_little_less_than_with_the_arm_at_its_commands():
    planned, actual = np.full(200, 0.02), np.full(200, 0.02)
    actual[90] = 0.0175
    run = clearance_run(actual)
    spec = Clearance(between=("robot", "box"), max_below_plan=0.003)
    assert verdict(run, spec).status == "not observable", "nobody recorded what was planned"
    run = changed(run, planned_clearances={("robot", "box"): planned})
    assert verdict(run, spec).margin == pytest.approx(0.0005)
    answer = verdict(run, Clearance(between=("robot", "box"), max_below_plan=0.002))
    assert (answer.status, answer.margin) == ("failed", pytest.approx(-0.0005))
    assert answer.reason == (
        "17.5 mm between robot and box, planned 20.0 mm: 2.5 mm less, 2.0 mm allowed at t=0.900 s"
    )
    both = Clearance(between=("robot", "box"), at_least=0.018, max_below_plan=0.003)
    assert verdict(run, both).reason.startswith("17.5 mm between arm_link and box, 18.0 mm req")
    gone = changed(run, clearances={("robot", "box"): np.full(200, np.nan)})
    assert verdict(gone, spec).status == "not reached"
    unknown = changed(run, planned_clearances={("robot", "box"): np.full(200, np.nan)})
    assert verdict(unknown, spec).status == "failed"


def test_clearance_is_judged_while_the_object_is_there():
    distance = np.full(200, np.nan)
    spec = Clearance(between=("robot", "box"), at_least=0.01)
    assert verdict(clearance_run(distance), spec).status == "not reached"
    distance[50:60] = 0.02
    assert verdict(clearance_run(distance), spec).status == "passed"
    assert verdict(clearance_run(distance), Never(predicate=spec)).status == "failed"


def test_clearance_beyond_the_cutoff_cannot_be_seen():
    spec = Clearance(between=("robot", "box"), at_least=0.2)
    assert verdict(clearance_run(np.full(200, 0.15)), spec).status == "not observable"
    assert verdict(clearance_run(np.full(200, 0.14)), spec).status == "failed"
    assert verdict(make_run(), spec).status == "not observable"
    same = Clearance(between=("robot", "box"), at_least=0.15)
    answer = verdict(clearance_run(np.full(200, 0.15)), same)
    assert answer.status == "passed"
    assert "at least 150 mm" in answer.reason


def test_any_object_is_the_nearest_but_for_what_the_robot_holds():
    distance = np.where(np.arange(200) < 50, 0.08, 0.0)
    spec = Clearance(at_least=0.05)
    run = clearance_run(distance, attachments=[attachment("box", 50, 250)])
    answer = verdict(run, spec)
    assert answer.status == "passed"
    assert answer.margin == pytest.approx(0.03)
    assert verdict(clearance_run(distance), spec).status == "failed"


def test_a_held_object_is_found_under_both_of_its_names():
    stand_in = thing("stand_in", physics=False)
    held = attachment("stand_in", 50, 200, represents="box")
    key = ("stand_in", "Table")
    run = make_run(
        objects=(TABLE, BOX, stand_in),
        attachments=[held],
        clearances={key: np.where(np.arange(200) < 50, np.nan, 0.006)},
    )
    spec = Clearance(between=("box", "Table"), at_least=0.005)
    assert verdict(run, spec).margin == pytest.approx(0.001)
    unheld = make_run(objects=(TABLE, BOX, stand_in))
    assert verdict(unheld, spec).status == "not reached"


# tcp_pose, path_length


def test_the_tcp_is_where_it_should_be_within_both_tolerances():
    tilted = at(200, (0, 0, 0.3), SE3.from_xyz_rpy(rpy=(0.009, 0.009, 0)).quat_wxyz)
    run = make_run(tcp_pose=tilted)
    answer = verdict(run, TcpPose(pose=Pose(xyz=(0, 0.0002, 0.3))))
    assert answer.status == "passed", "each axis by itself is within 0.01 rad"
    assert answer.unit == "rad", "the tighter of the two is the margin"
    assert {measure.unit for measure in answer.measures} == {"m", "rad"}
    assert verdict(run, TcpPose(pose=Pose(xyz=(0, 0.0011, 0.3)))).margin == pytest.approx(-1e-4)
    turned = Pose(xyz=(0, 0, 0.3), rpy=(0.02, 0, 0))
    assert verdict(run, TcpPose(pose=turned)).status == "failed"
    assert verdict(run, TcpPose(pose=turned, position_only=True)).status == "passed"


def test_a_position_error_says_where_it_was_to_be_and_where_it_was():
    run = make_run(tcp_pose=heights(np.full(200, 0.3)))
    answer = verdict(run, TcpPose(pose=Pose(xyz=(0, 0.5, 0.3)), position_only=True))
    [measure] = answer.measures
    assert measure.expected == pytest.approx((0, 0.5, 0.3))
    assert measure.actual == pytest.approx((0, 0, 0.3))


def test_a_pose_in_the_frame_of_a_fixed_link_or_of_an_object():
    run = make_run()
    assert verdict(run, TcpPose(pose=Pose(xyz=(0, 0, -0.2), frame="base_link"))).status == "passed"
    assert verdict(run, TcpPose(pose=Pose(xyz=(0, 0, 0.28), frame="box"))).status == "passed"
    assert verdict(run, TcpPose(pose=Pose(xyz=(0, 0, -0.2), frame="world"))).status == "failed"


def test_a_link_that_was_not_recorded_cannot_be_judged():
    spec = TcpPose(link="arm_link", pose=Pose(xyz=(0, 0, 0.3)))
    assert verdict(make_run(), spec).status == "not observable"
    recorded = make_run(frames={"arm_link": at(200, (0, 0, 0.3))})
    assert verdict(recorded, spec).status == "passed"
    in_frame = TcpPose(pose=Pose(frame="box", xyz=(0, 0, 0.28)))
    assert verdict(absent_box(), in_frame).status == "not reached"


def test_the_path_of_the_tcp_has_a_length():
    run = make_run(tcp_pose=heights(np.linspace(0, 0.4, 200)))
    assert verdict(run, PathLength(at_most=0.41)).margin == pytest.approx(0.01)
    assert verdict(run, PathLength(at_most=0.39)).status == "failed"
    assert verdict(run, PathLength(at_most=0.41, during="gone")).status == "not reached"


# tcp_path, fraction, in


LINE = {"start": {"xyz": [0, 0, 0.3]}, "end": {"xyz": [0, 0, 0.5]}}
ARC = {
    "start": {"xyz": [0.2, 0, 0]},
    "interim": {"xyz": [0, 0.2, 0]},
    "end": {"xyz": [-0.2, 0, 0]},
}


def along_z(offset=0.0, start=0.3, end=0.5):
    tcp = heights(np.linspace(start, end, 200))
    tcp[100, 0] = offset
    return make_run(tcp_pose=tcp)


def around(radius, first=0.0, last=np.pi):
    angle = np.linspace(first, last, 200)
    path = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)
    return make_run(tcp_pose=at(200, path))


def test_a_line_is_followed_near_enough_and_from_end_to_end():
    spec = TcpPath(line=LINE, max_deviation=0.002)
    answer = verdict(along_z(0.0015), spec)
    assert (answer.status, answer.unit) == ("passed", "m"), "all of the line was travelled"
    assert answer.margin == pytest.approx(5e-4)
    short = verdict(along_z(0.0015, end=0.492), spec)
    assert (short.status, short.unit) == ("passed", "1"), "the share is the tighter of the two"
    assert short.margin == pytest.approx(0.01, abs=1e-6)
    strayed = verdict(along_z(0.0021), spec)
    assert (strayed.status, strayed.unit) == ("failed", "m")
    assert strayed.margin == pytest.approx(-1e-4)
    assert strayed.time == pytest.approx(1.0)
    assert verdict(along_z(end=0.5019), spec).status == "passed", "2 mm beyond the end"
    assert verdict(along_z(end=0.5021), spec).status == "failed"


def test_a_tcp_that_stands_on_the_line_has_not_followed_it():
    spec = TcpPath(line=LINE)
    standing = verdict(make_run(), spec)
    assert (standing.status, standing.unit) == ("failed", "1")
    assert standing.margin == pytest.approx(-0.95)
    assert "travelled 0.0 % of the line forwards" in standing.reason
    assert verdict(along_z(end=0.489), spec).status == "failed"
    assert verdict(along_z(end=0.489), TcpPath(line=LINE, min_fraction=0.9)).status == "passed"
    assert verdict(along_z(), TcpPath(line=LINE, during="later")).status == "not reached"


def test_a_line_or_an_arc_travelled_backwards_has_not_been_followed():
    for run, spec in (
        (along_z(start=0.5, end=0.3), TcpPath(line=LINE)),
        (around(0.2, np.pi, 0), TcpPath(arc=ARC)),
    ):
        backwards = verdict(run, spec)
        assert (backwards.status, backwards.unit) == ("failed", "1")
        assert backwards.margin == pytest.approx(-0.95)
    turned = {"start": LINE["end"], "end": LINE["start"]}
    assert verdict(along_z(start=0.5, end=0.3), TcpPath(line=turned)).status == "passed"


def test_a_line_travelled_to_and_fro_has_been_followed_once():
    there = np.linspace(0.3, 0.5, 100)
    for z in (np.concatenate([there, there[::-1]]), np.concatenate([there[::-1], there])):
        assert verdict(make_run(tcp_pose=heights(z)), TcpPath(line=LINE)).status == "passed"
    half = np.concatenate([np.linspace(0.4, 0.3, 100), np.linspace(0.3, 0.4, 100)])
    answer = verdict(make_run(tcp_pose=heights(half)), TcpPath(line=LINE))
    assert answer.margin == pytest.approx(0.5 - 0.95)


def test_an_arc_is_followed_on_its_own_side_only():
    spec = TcpPath(arc=ARC, max_deviation=0.002)
    assert verdict(around(0.2), spec).status == "passed"
    outside = verdict(around(0.2021), spec)
    assert (outside.status, outside.margin) == ("failed", pytest.approx(-1e-4))
    other_way = verdict(around(0.2, 0, -np.pi), spec)
    assert other_way.margin == pytest.approx(0.002 - np.hypot(0.2, 0.2), abs=2e-3)
    half = verdict(around(0.2, 0, np.pi / 2), spec)
    assert (half.status, half.margin) == ("failed", pytest.approx(0.5 - 0.95))


def test_an_arc_through_points_on_a_line_cannot_be_judged():
    flat = {**ARC, "interim": {"xyz": [0.1, 0, 0]}}
    assert verdict(make_run(), TcpPath(arc=flat)).status == "not observable"
    point = {"start": LINE["start"], "end": LINE["start"]}
    assert verdict(make_run(), TcpPath(line=point)).status == "not observable"
    with pytest.raises(ValueError, match="`line`, or `arc`, or neither"):
        TcpPath(line=LINE, arc=ARC)


def test_a_line_in_the_frame_of_an_object_moves_with_it():
    run = along_z()
    carried = changed(run, object_poses={"box": run.signals.tcp_pose})
    in_box = {"start": {"frame": "box"}, "end": {"frame": "box", "xyz": [0, 0, 0.1]}}
    answer = verdict(carried, TcpPath(line=in_box))
    assert (answer.status, answer.unit) == ("failed", "1"), "it stands at the line's start"


def test_the_least_share_of_the_cartesian_paths_of_a_window_counts():
    run = make_run(
        steps=(
            step("weld", 0, 50, "cartesian_path", result={"fraction": 1.0}),
            step("back", 50, 100, "cartesian_path", result={"fraction": 0.74}),
            step("wait", 100, 200, "wait"),
        )
    )
    assert verdict(run, FractionCheck(), "weld").margin == pytest.approx(0.0)
    answer = verdict(run, FractionCheck(at_least=0.75))
    assert (answer.status, answer.unit, answer.margin) == ("failed", "1", pytest.approx(-0.01))
    assert answer.reason.startswith("74.0 % of the path of back followed, 75.0 % required")
    assert verdict(run, FractionCheck(at_least=0.7)).status == "passed"
    assert verdict(run, FractionCheck(), "wait").status == "not reached"
    broken = make_run(steps=(step("weld", 0, 50, "cartesian_path", result={"fraction": None}),))
    assert verdict(broken, FractionCheck(at_least=0)).status == "not reached"


def a_bin(name="bin", lean=0.0, x=0.0):
    """A tray of 20 x 20 x 10 cm made of a floor and two walls; its origin is in its middle."""
    parts = [
        Shape(Box((0.2, 0.2, 0.01)), SE3.from_xyz_rpy((0, 0, -0.045))),
        Shape(Box((0.01, 0.2, 0.1)), SE3.from_xyz_rpy((-0.095, 0, 0))),
        Shape(Cylinder(0.05, 0.2), SE3.from_xyz_rpy((0.05, 0, 0), (np.pi / 2, 0, 0))),
    ]
    record = replace(thing(name, static=True), shapes=tuple(parts))
    return record, at(200, (x, 0, 0.05), SE3.from_xyz_rpy(rpy=(lean, 0, 0)).quat_wxyz)


def in_bin(lean=0.0, x=0.0, box=(0, 0, 0.03)):
    record, poses = a_bin(lean=lean, x=x)
    return make_run(objects=(BOX, record), object_poses={"bin": poses, "box": at(200, box)})


def test_what_is_inside_the_outline_of_a_container_is_in_it():
    spec = In(object="box", container="bin")
    answer = verdict(in_bin(), spec)
    assert (answer.status, answer.unit) == ("passed", "rad"), "the lean is the tighter of the two"
    beside = verdict(in_bin(x=0.101), spec)
    assert (beside.status, beside.unit, beside.margin) == ("failed", "m", pytest.approx(-0.001))
    assert verdict(in_bin(box=(0, 0, 0.099)), spec).margin == pytest.approx(0.001)
    assert verdict(in_bin(box=(0, 0, 0.101)), spec).status == "failed", "above its rim"


def test_nothing_is_in_a_container_that_has_tipped_over():
    spec = In(object="box", container="bin")
    assert verdict(in_bin(lean=np.radians(44), box=(0, 0, 0.05)), spec).status == "passed"
    answer = verdict(in_bin(lean=np.radians(46), box=(0, 0, 0.05)), spec)
    assert (answer.status, answer.unit) == ("failed", "rad")
    assert answer.margin == pytest.approx(-np.radians(1))


def test_being_in_needs_both_and_a_container_with_a_known_extent():
    record, poses = a_bin()
    gone = make_run(objects=(BOX, record), object_poses={"bin": poses, "box": ABSENT})
    assert verdict(gone, In(object="box", container="bin")).status == "not reached"
    floor = replace(record, shapes=(Shape(Plane()),))
    run = make_run(objects=(BOX, floor), object_poses={"bin": poses})
    assert verdict(run, In(object="box", container="bin")).status == "not observable"


# joints, named_target, gripper


def positions(shoulder, finger=0.0):
    return np.tile([shoulder, finger], (200, 1))


def test_joints_and_named_targets_tell_the_worst_joint():
    run = make_run(joint_positions=positions(0.009))
    assert verdict(run, NamedTarget(state="home")).margin == pytest.approx(0.001)
    assert verdict(run, NamedTarget(state="home", tolerance=0.008)).status == "failed"
    answer = verdict(run, Joints(positions={"shoulder": 0.02, "finger": 0.0}))
    assert answer.status == "failed"
    assert answer.reason.startswith("shoulder is off")
    assert verdict(run, NamedTarget(state="up")).status == "not observable"
    assert verdict(run, NamedTarget(state="home", during="later")).status == "not reached"
    assert verdict(run, Joints(positions={"elbow": 0.0})).status == "not observable"


def test_an_angle_s_default_tolerance_is_not_taken_for_a_sliding_joint():
    run = make_run(joint_positions=positions(0.0, 0.005))
    assert verdict(run, GripperState(named_target="closed")).status == "failed"
    assert verdict(run, GripperState(named_target="closed", tolerance=0.006)).status == "passed"
    assert verdict(run, NamedTarget(state="closed", group="gripper")).status == "failed"


def test_the_gripper_by_state_position_width_and_report():
    run = make_run(
        joint_positions=positions(0.0, 0.029),
        steps=(
            step("open", 0, 50, "gripper", result={"stalled": False}),
            step("squeeze", 50, 100, "gripper", result={"stalled": True}),
            step("never", 200, 200, "gripper", "not_reached"),
        ),
    )
    assert verdict(run, GripperState(named_target="open")).margin == pytest.approx(0.001)
    assert verdict(run, GripperState(position=0.0265)).status == "failed"
    assert verdict(run, GripperState(width=0.059)).margin == pytest.approx(0.001)
    assert verdict(run, GripperState(width=0.0601)).status == "failed"
    assert verdict(run, GripperState(stalled=True)).status == "passed"
    assert verdict(run, GripperState(stalled=True), "open").status == "failed"
    assert verdict(run, GripperState(stalled=False), "open").status == "passed"
    assert verdict(run, GripperState(stalled=False), "never").status == "not reached"
    assert verdict(make_run(), GripperState(stalled=False)).status == "not reached"


# within_limits, tracking_error, effort, duration


def test_limits_are_inclusive_and_the_worst_joint_is_told():
    at_limit = make_run(
        joint_positions=positions(1.0), joint_efforts=positions(10.0), joint_velocities=positions(2)
    )
    assert verdict(at_limit, WithinLimits()).status == "passed"
    for change, said in (
        ({"joint_positions": positions(-1.0011)}, "position of shoulder"),
        ({"joint_velocities": positions(-2.0021)}, "velocity of shoulder"),
        ({"joint_efforts": positions(0.0, 20.1)}, "effort of finger"),
    ):
        answer = verdict(make_run(**change), WithinLimits())
        assert answer.status == "failed"
        assert answer.reason.startswith(said)
    beyond = make_run(joint_velocities=positions(2.1))
    assert verdict(beyond, WithinLimits(velocity=False)).status == "passed"
    assert verdict(beyond, WithinLimits(during="later")).status == "not reached"


def test_a_gripper_may_rest_on_its_stop_and_an_arm_may_not():
    assert (
        verdict(make_run(joint_positions=positions(0, -0.0005)), WithinLimits()).status == "passed"
    )
    assert (
        verdict(make_run(joint_positions=positions(0, -0.0007)), WithinLimits()).status == "failed"
    )
    assert verdict(make_run(joint_positions=positions(1.0011)), WithinLimits()).status == "failed"


def test_an_idle_joint_off_the_arm_may_rest_on_its_stop_too():
    run = make_run(joint_positions=positions(0, -0.0005))
    bare = replace(run, robot=replace(run.robot, gripper=None))
    assert verdict(bare, WithinLimits()).status == "passed"
    commands = positions(0.0)
    commands[100:, 1] = 0.01
    driven = changed(bare, joint_commands=commands)
    assert verdict(driven, WithinLimits()).status == "failed"


def test_acceleration_is_that_of_the_commands():
    velocities = positions(0.0)
    velocities[100:, 0] = 0.051  # in one sample: 5.1 rad/s^2
    run = make_run(joint_command_velocities=velocities)
    assert verdict(run, WithinLimits()).status == "passed"
    answer = verdict(run, WithinLimits(acceleration=True))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-0.1)
    assert answer.time == pytest.approx(1.0)


def test_tracking_is_of_the_arm_s_joints_where_they_have_commands():
    commands = positions(0.0, 0.03)
    commands[:10] = np.nan
    run = make_run(joint_commands=commands, joint_positions=positions(0.049))
    assert verdict(run, TrackingError()).margin == pytest.approx(0.001)
    assert verdict(run, TrackingError(max=0.048)).status == "failed"
    uncommanded = changed(run, joint_commands=np.full((200, 2), np.nan))
    assert verdict(uncommanded, TrackingError()).status == "not observable"


def test_effort_is_a_share_of_the_limit():
    run = make_run(joint_efforts=positions(-5.0))
    assert verdict(run, Effort(max_fraction=0.6)).margin == pytest.approx(0.1)
    assert verdict(run, Effort(max_fraction=0.4)).status == "failed"
    assert verdict(run, Effort(during="gone")).status == "not reached"


def test_durations_of_steps_and_runs():
    run = make_run(steps=(step("move", 0, 101), step("broken", 100, 150, status="failed")))
    assert verdict(run, DurationCheck(at_most=1.0), "move").margin == pytest.approx(0.0)
    assert verdict(run, DurationCheck(at_most=0.99), "move").status == "failed"
    assert verdict(run, DurationCheck(at_least=1.5)).margin == pytest.approx(0.49)
    assert verdict(run, DurationCheck(at_most=5), "broken").status == "not reached"
    early = make_run(ended_early="GOAL_IN_COLLISION")
    assert verdict(early, DurationCheck(at_most=5)).status == "not reached"


# windows


def test_a_step_that_was_not_reached_or_has_no_samples_never_passes():
    run = make_run(
        steps=(
            step("empty", 50, 50),
            step("unreached", 200, 200, status="not_reached"),
            step("move", 20, 40),
        )
    )
    for name in ("empty", "unreached", "unknown"):
        for spec in (Static(), Never(predicate=Static()), Eventually(predicate=Static())):
            assert verdict(run, spec, name).status == "not reached"
    assert verdict(run, Static(during="move")).time == pytest.approx(0.39)
    assert verdict(run, Static(during="unreached"), "move").status == "not reached"


def test_a_hold_longer_than_the_window_fails_and_says_so():
    run = make_run(steps=(step("move", 20, 40),))
    answer = verdict(run, Eventually(predicate=Static(), **{"for": 0.5}), "move")
    assert answer.status == "failed"
    assert (answer.unit, answer.margin) == ("s", pytest.approx(0.19 - 0.5))
    assert verdict(run, Never(predicate=Static(), **{"for": 0.5}), "move").status == "not reached"


def test_what_never_held_shows_where_it_came_nearest():
    spec = Lifted(object="box", above=0.2, **{"for": 0.5})
    answer = verdict(lift_run(), spec)
    assert answer.status == "failed"
    assert answer.reason.startswith("lifted 100 mm of 200 mm")
    assert answer.reason.endswith("held for 0.0 s at most, 0.5 s required")


def test_a_deadline_counts_from_the_window_s_start():
    run = lift_run()
    assert verdict(run, Lifted(object="box", above=0.05, within=1.3)).status == "passed"
    assert verdict(run, Lifted(object="box", above=0.05, within=1.2)).status == "failed"
    assert verdict(run, Lifted(object="box", above=0.05, within=0.5), "lift").status == "passed"


def test_one_thing_holds_until_another_comes():
    run = lift_run()  # gripped at 0.5 s, off the table at 1 s, at 50 mm from 1.25 s on
    still = Static(object="box", max_velocity=0.01)
    on_table = On(object="box", support="Table")
    touched = InContact(between=("gripper", "box"))
    answer = verdict(run, Until(predicate=still, until=touched))
    assert (answer.status, answer.unit) == ("passed", "m/s")
    came = verdict(run, Until(predicate=on_table, until=Lifted(object="box", above=0.05)))
    assert came.status == "failed", "it was off the table before it was at 50 mm"
    assert (came.unit, came.time) == ("N", pytest.approx(1.01))
    assert came.reason.startswith("`on` did not hold until then")
    never = verdict(run, Until(predicate=still, until=InContact(between=("box", "arm_link"))))
    assert (never.status, never.unit) == ("failed", "N")
    assert "`in_contact` never came" in never.reason
    late = Until(predicate=still, until=touched, within=0.4)
    assert verdict(run, late).status == "failed"
    assert verdict(run, Until(predicate=still, until=touched, within=0.5)).status == "passed"
    held = Until(predicate=still, until=touched, **{"for": 1.5})
    assert verdict(run, held).status == "failed"
    assert verdict(run, Until(predicate=still, until=touched), "gone").status == "not reached"
    assert verdict(absent_box(), Until(predicate=still, until=touched)).status == "not reached"
    with pytest.raises(ValueError, match="no `for` and no `within`"):
        Until(predicate=Static(**{"for": 1.0}), until=touched)


def test_words_inside_and_outside_a_temporal_word_both_count():
    run = lift_run()  # at 50 mm from 1.25 s on: 0.74 s
    inner = Lifted(object="box", above=0.05, **{"for": 0.8})
    assert verdict(run, Eventually(predicate=inner, **{"for": 0.1})).status == "failed"
    assert verdict(run, Eventually(predicate=inner, during="lift", points=2)).points == 2
    twice = Eventually(predicate=Lifted(object="box", during="close"), during="lift")
    assert verdict(run, twice).status == "not observable"


def test_what_is_unknown_counts_against_every_word():
    commands = positions(0.0)
    velocities = np.zeros((200, 2))
    velocities[120] = np.nan
    run = make_run(joint_velocities=velocities, joint_commands=commands)
    assert verdict(run, Always(predicate=WithinLimits())).status == "failed"
    assert verdict(run, Never(predicate=WithinLimits(position=False))).status == "failed"
    gone = at(200, (0, 0, 0.02))
    gone[150:] = np.nan
    removed = make_run(object_poses={"box": gone}, contact_forces=STANDING)
    assert verdict(removed, Placed(object="box")).status == "failed"
    assert verdict(removed, Eventually(predicate=Placed(object="box"))).status == "passed"


def test_a_robot_without_a_gripper_grasps_nothing():
    run = replace(make_run(), robot=replace(ROBOT, gripper=None))
    for spec in (Grasped(object="box"), Lifted(object="box"), GripperState(position=0.0)):
        assert verdict(run, spec).status == "not observable"
    assert verdict(run, Grasped(object="nothing")).status == "not observable"


# quantities that saturate


def test_a_share_that_is_complete_uses_none_of_its_allowance():
    spec = TcpPath(line=LINE, max_deviation=0.002)
    answer = verdict(along_z(), spec)
    used = {measure.name: allowance_used(measure) for measure in answer.measures}
    assert used["share travelled forwards"] == pytest.approx(0.0, abs=1e-9)
    assert margin_share(answer) == pytest.approx(1.0)
    half = verdict(along_z(end=0.495), TcpPath(line=LINE, max_deviation=1.0))
    assert allowance_used(half.measures[0]) == pytest.approx(0.5, abs=1e-6)
    assert margin_share(half) == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize("at_least", [0.95, 1.0])
def test_a_path_that_was_followed_to_its_end_has_the_largest_margin(at_least):
    path = step("path", 0, 200, "cartesian_path", result={"fraction": 1.0})
    answer = verdict(make_run(steps=(path,)), FractionCheck(at_least=at_least))
    assert (answer.status, margin_share(answer)) == ("passed", 1.0)
    assert allowance_used(answer.measures[0]) == 0.0


@pytest.mark.parametrize("at_least", [0.14, 0.05])
def test_a_distance_that_was_recorded_as_at_least_that_far_has_the_largest_margin(at_least):
    far = make_run(clearances={("robot", "box"): np.full(200, 0.15)})
    answer = verdict(far, Clearance(between=("robot", "box"), at_least=at_least))
    assert (answer.status, margin_share(answer)) == ("passed", 1.0)
    near = make_run(clearances={("robot", "box"): np.full(200, 0.10)})
    answer = verdict(near, Clearance(between=("robot", "box"), at_least=0.05))
    assert margin_share(answer) == pytest.approx(0.5)


# what is released


RELEASES = {
    "release": (step("release", 149, 180, "release"),),
    "gripper and detach_object": (
        step("open", 149, 170, "gripper"),
        step("detach", 169, 180, "detach_object"),
    ),
    "place": (
        step("put", 100, 200, "place", path="put"),
        step("put.release", 149, 180, "release", path="put.release"),
    ),
}


@pytest.mark.parametrize("steps", RELEASES.values(), ids=RELEASES)
def test_an_object_that_drops_as_the_gripper_releases_it_was_not_lost(steps):
    z = np.where(np.arange(200) < 155, 0.3, 0.29)
    grips = {(f"{side}_finger", "box"): force(200, (50, 155)) for side in ("left", "right")}
    run = make_run(
        object_poses={"box": heights(z)}, contact_forces=grips, tcp_pose=heights(np.full(200, 0.3)),
        attachments=(attachment("box", 60, 178),), steps=steps,
    )  # fmt: skip
    assert verdict(run, Slip(object="box")).margin == pytest.approx(0.003)
    assert "lost" not in held_finding(run).message
    carried = replace(run, steps=(step("go", 0, 200),))
    assert verdict(carried, Slip(object="box")).status == "failed"
    assert "the physics lost it at 1.55 s" in held_finding(carried).message


def test_an_object_that_falls_before_the_arm_moves_on_was_lost():
    z = np.where(np.arange(200) < 100, 0.3, 0.29)
    grips = {(f"{side}_finger", "box"): force(200, (50, 100)) for side in ("left", "right")}
    run = make_run(
        object_poses={"box": heights(z)}, contact_forces=grips, tcp_pose=heights(np.full(200, 0.3)),
        attachments=(attachment("box", 60, 178),),
        steps=(
            step("open", 90, 110, "gripper"),
            step("go", 109, 150),
            step("release", 149, 180, "release"),
        ),
    )  # fmt: skip
    assert "the physics lost it at 1.00 s" in held_finding(run).message


# the path of a step from its start to its goal


def sliding(z, planned, verb="lin"):
    """A robot whose TCP slides along z by its joint `shoulder`; planned positions of a step."""
    along = (0.0, 0.0, 1.0)
    places = (
        LinkPlacement("base_link", "world", (0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0)),
        LinkPlacement("palm", "base_link", (0, 0, 0, 1, 0, 0, 0), "shoulder", True, along),
    )
    tcp = at(200, (0.1, 0.2, 0.3))
    tcp[:, 2] += z
    trajectory = {
        "joint_names": ["shoulder"],
        "times": np.linspace(0, 1.99, len(planned)),
        "positions": np.asarray(planned, dtype=float)[:, None],
    }
    moving = step("go", 0, 200, verb, trajectory=trajectory)
    return make_run(tcp_pose=tcp, robot=replace(ROBOT, placements=places), steps=(moving,))


def test_a_step_s_own_path_is_the_line_from_its_start_to_its_goal():
    whole = np.linspace(0.0, 0.2, 200)
    answer = verdict(sliding(whole, [0.0, 0.05, 0.2]), TcpPath(), "go")
    assert (answer.status, answer.unit) == ("passed", "m")
    assert answer.margin == pytest.approx(0.001)
    half = verdict(sliding(whole / 2, [0.0, 0.2]), TcpPath(), "go")
    assert (half.status, half.margin) == ("failed", pytest.approx(0.5 - 0.95))
    aside = sliding(whole, [0.0, 0.2])
    aside.signals.tcp_pose[100, 0] += 0.002
    assert verdict(aside, TcpPath(), "go").margin == pytest.approx(-0.001)
    beyond = verdict(sliding(1.02 * whole, [0.0, 0.2]), TcpPath(during="go"))
    assert beyond.margin == pytest.approx(0.001 - 0.004)


def test_a_step_without_a_path_of_its_own_is_not_observable():
    run = sliding(np.linspace(0.0, 0.2, 200), [0.0, 0.2])
    assert verdict(run, TcpPath()).status == "not observable"
    waiting = make_run(steps=(step("wait", 0, 200, "wait"),))
    assert verdict(waiting, TcpPath(), "wait").status == "not observable"
    still = sliding(np.zeros(200), [0.1, 0.1])
    assert verdict(still, TcpPath(), "go").status == "not observable", "it has no length"
    failed = make_run(
        steps=(step("go", 0, 200, "lin", status="failed", error_code="PLANNING_FAILED"),),
        ended_early="PLANNING_FAILED: no line",
    )
    assert verdict(failed, TcpPath(), "go").status == "not reached"


@pytest.mark.parametrize(
    ("beyond", "status"), [(0.0, "passed"), (1e-7, "passed"), (9e-4, "passed"), (1.1e-3, "failed")]
)
def test_a_measured_position_may_exceed_its_limit_by_the_stated_tolerance(beyond, status):
    for position in (1.0 + beyond, -1.0 - beyond):
        run = make_run(joint_positions=positions(position))
        assert verdict(run, WithinLimits()).status == status


@pytest.mark.parametrize("beyond", [1e-7, 5e-4, 0.1])
def test_a_commanded_position_has_no_tolerance(beyond):
    at_limit = changed(make_run(), joint_commands=positions(1.0))
    assert verdict(at_limit, WithinLimits()).status == "passed"
    for position in (1.0 + beyond, -1.0 - beyond):
        run = changed(make_run(), joint_commands=positions(position))
        answer = verdict(run, WithinLimits())
        assert answer.status == "failed"
        assert answer.reason.startswith("commanded position of shoulder is ")
        value, limit = re.findall(r"-?[0-9.]+ deg", answer.reason)
        assert value != limit


def test_a_measured_velocity_may_exceed_its_limit_by_a_thousandth():
    run = make_run(joint_velocities=positions(2.0019))
    assert verdict(run, WithinLimits()).status == "passed"
