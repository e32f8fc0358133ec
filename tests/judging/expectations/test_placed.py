"""placed: the object rests on a support, released and still, at a pose if one is shared."""

import numpy as np
import pytest

from harness.core.geometry import Box, Cylinder
from harness.core.spatial import SE3
from harness.judging.expectations.placed import Placed
from harness.language.poses import Pose, PoseTolerance
from harness.plugins.objects.expectations.static import Static
from tests.judging import evidence_runs as shared
from tests.judging.evidence import AT_ONCE, Evidence, Free, Three
from tests.judging.synthetic_run import (
    BOX,
    DT,
    TABLE,
    at,
    attachment,
    force,
    heights,
    lift_run,
    make_run,
    step,
    thing,
    verdict,
)

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
    ids=["hovering", "elsewhere", "touched", "attached", "next to it", "leaning", "turned"],
)
def test_what_is_not_quite_placed_is_reported_why(changes, spec, said):
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


def test_what_the_robot_holds_is_no_support_whether_it_is_named_or_not():
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
    assert verdict(held, Placed(object="box", on="tray")).status == "failed"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Placed(object="box", pose=Pose(xyz=(0, 0, 0.02))),
            shared.on_table(1.0),
            shared.on_table(1.0, object_poses={"box": at(shared.N, (0.0101, 0, 0.02))}),
            -1e-4,
            "m",
            shared.NO_BOX,
        ),
    ),
    mutation_cases=(
        (Placed(object="box", on="Table", pose=Pose(xyz=(0, 0, 0.02))), shared.standing(), "late"),
    ),
    picture=(("pick", "red_box"), ("pick", "{object: red_box, during: hold}")),
    free_shifts=(
        Free(
            "no force of the fingers is released",
            "placed",
            "contact_forces left_finger, contact_forces right_finger",
            "-",
        ),
        Free("to stand more heavily is to stand", "placed", "contact_forces Table", "+"),
        Free("to stand more heavily is to stand", "placed", "support_forces", "+"),
        Free(
            "`placed` requires how upright it stands, and that it rests; about the vertical it"
            " may be turned",
            "placed",
            "object_poses box",
            "+-yaw",
            (AT_ONCE,),
        ),
    ),
)


def test_a_step_that_failed_at_once_is_the_reason_why_nothing_is_placed():
    failed = step("place", 0, 3, status="failed", error_code="INVALID_OBJECT_NAME")
    run = make_run(3, ended_early="a step failed", steps=(failed,))
    answer = verdict(run, Placed(object="box"))
    assert (answer.status, answer.reason) == (
        "not reached",
        "step 'place' failed before then: INVALID_OBJECT_NAME",
    )
