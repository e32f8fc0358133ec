"""upright: the object's z axis points up."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.judging.expectations.upright import Upright
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import BOX, TABLE, at, make_run, step, verdict

ABSENT = np.full((200, 7), np.nan)


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


def leaning(roll):
    return at(100, (0, 0, 0.02), SE3.from_xyz_rpy(rpy=(roll, 0, 0)).quat_wxyz)


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Upright(object="box", tolerance=0.1),
            make_run(),
            make_run(object_poses={"box": np.concatenate([leaning(0.101), leaning(0.101)])}),
            -0.001,
            "rad",
            absent_box(),
        ),
    ),
    mutation_cases=(
        (
            Upright(object="box"),
            make_run(
                steps=(step("early", 0, 100), step("late", 100, 200)),
                object_poses={"box": np.concatenate([leaning(1.0), leaning(0.0)])},
            ),
            "late",
        ),
    ),
    free_shifts=(
        Free(
            "a lean has no position and no heading",
            "upright",
            "object_poses",
            "+-x +-y +-z +-yaw",
        ),
    ),
    picture=(("pick", "red_box"), ("slab", "slab")),
)


def test_upright_is_the_lean_of_the_z_axis():
    tilted = at(200, (0, 0, 0.02), SE3.from_xyz_rpy(rpy=(0.1, 0, 1.0)).quat_wxyz)
    run = make_run(object_poses={"box": tilted})
    assert verdict(run, Upright(object="box", tolerance=0.11)).margin == pytest.approx(0.01)
    assert verdict(run, Upright(object="box", tolerance=0.09)).status == "failed"
    assert verdict(absent_box(), Upright(object="box")).status == "not reached"
