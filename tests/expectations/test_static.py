"""static: the object, or everything, moves slower than a limit."""

from dataclasses import replace

import numpy as np
import pytest

from harness.expectations.always import Always
from harness.expectations.static import Static
from tests.assertions.synthetic_run import BOX, DT, TABLE, at, changed, make_run, verdict

ABSENT = np.full((200, 7), np.nan)


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


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
