"""upright: the object's z axis points up."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.expectations.upright import Upright
from tests.assertions.synthetic_run import BOX, TABLE, at, make_run, verdict

ABSENT = np.full((200, 7), np.nan)


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


def test_upright_is_the_lean_of_the_z_axis():
    leaning = at(200, (0, 0, 0.02), SE3.from_xyz_rpy(rpy=(0.1, 0, 1.0)).quat_wxyz)
    run = make_run(object_poses={"box": leaning})
    assert verdict(run, Upright(object="box", tolerance=0.11)).margin == pytest.approx(0.01)
    assert verdict(run, Upright(object="box", tolerance=0.09)).status == "failed"
    assert verdict(absent_box(), Upright(object="box")).status == "not reached"
