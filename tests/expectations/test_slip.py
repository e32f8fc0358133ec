"""slip: where the planner believes a held object to be, against where it is."""

import pytest

from harness.core.spatial import SE3
from harness.expectations.slip import Slip
from tests.assertions.synthetic_run import (
    BOX,
    CYLINDER,
    TABLE,
    attachment,
    changed,
    lift_run,
    make_run,
    thing,
    verdict,
)


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
