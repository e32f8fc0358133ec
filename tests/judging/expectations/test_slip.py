"""slip: a held object against where the planner believes it to be."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.plugins.objects.expectations.slip import Slip
from harness.session.observation.tracking import held_finding as finding_of_hold
from tests.judging import evidence_runs as shared
from tests.judging.evidence import AT_ONCE, DRIFT, Evidence, Free, Three
from tests.judging.synthetic_run import (
    BOX,
    CYLINDER,
    TABLE,
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


def held_finding(run):
    """What became of the run's one attachment."""
    (record,) = run.attachments
    found = finding_of_hold(run, record)
    assert found is not None
    return found


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


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Slip(object="box"),
            lift_run(**shared.HELD),
            shared.slid(lift_run(**shared.HELD), 0.0031),
            -1e-4,
            "m",
            make_run(),
        ),
    ),
    mutation_cases=(
        (
            Slip(object="box"),
            lift_run(attachments=[attachment("box", 45, shared.N)]),
            "",
        ),
    ),
    picture=(("pick", "red_box"), ("slippery", "red_box")),
    free_shifts=(
        Free(
            "a firmer grip is a grip",
            "slip",
            "contact_forces left_finger, contact_forces right_finger",
            "+",
        ),
        Free(
            "where a finger presses is free, only that they press against each other as far"
            " apart as the object is thick",
            "slip",
            "presses left_finger",
            "+-x +-z -y +force_y",
        ),
        Free("the same from the other side", "slip", "presses right_finger", "+-x +-z +y -force_y"),
        Free(
            "past the other finger: a ring that is held from inside",
            "slip",
            "presses left_finger",
            "+y",
            (DRIFT,),
        ),
        Free("the same from the other side", "slip", "presses right_finger", "-y", (DRIFT,)),
        Free(
            "an object that was held elsewhere all the time has not moved in the hand",
            "slip",
            "object_poses box, tcp_pose",
            "+-x +-y +-z +-roll +-pitch +-yaw",
            (AT_ONCE,),
        ),
    ),
)
