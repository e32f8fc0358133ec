"""joint: a door, drawer or lid stands between two positions."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.core.world import ObjectJoint
from harness.plugins.fixtures.expectations.joint import Joint
from tests.judging.evidence import Evidence, Three
from tests.judging.synthetic_run import BOX, TABLE, make_run, step, thing, verdict

BASE = SE3.from_xyz_rpy((0.5, -0.2, 0.3), (0.1, 0.2, 0.7))
DOOR = ObjectJoint(
    fixture="cabinet",
    name="door",
    kind="hinge",
    fixture_pose=tuple(BASE.as_vector()),
    axis=(0.0, 0.0, 1.0),
    point=(0.2, 0.1, 0.0),
    lower=0.0,
    upper=2.0,
)
DRAWER = replace(DOOR, name="drawer", kind="slide", axis=(1.0, 0.0, 0.0), upper=0.3)
CABINET = thing("cabinet", static=True)


def moved(joint, *positions, n=200):
    """A run in which the part of a joint stands at positions, each for an equal time."""
    part = replace(thing(f"cabinet/{joint.name}"), joint=joint)
    rows = np.repeat(np.array(positions, dtype=float), n // len(positions))
    return make_run(
        objects=(TABLE, BOX, CABINET, part),
        object_poses={
            "cabinet": np.tile(np.array(joint.fixture_pose), (n, 1)),
            part.name: joint.poses(rows),
        },
        steps=(step("early", 0, 100), step("late", 100, n)),
    )


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Joint(object="cabinet", joint="door", at_least=1.0),
            moved(DOOR, 1.2),
            moved(DOOR, 0.99),
            -0.01,
            "rad",
        ),
        Three(
            Joint(object="cabinet", joint="drawer", at_most=0.05),
            moved(DRAWER, 0.0),
            moved(DRAWER, 0.051),
            -0.001,
            "m",
        ),
    ),
    mutation_cases=(
        (
            Joint(object="cabinet", joint="door", at_least=1.0, at_most=1.4),
            moved(DOOR, 0.2, 1.2),
            "late",
        ),
        (
            Joint(object="cabinet", joint="drawer", at_least=0.1, at_most=0.15),
            moved(DRAWER, 0.0, 0.12),
            "late",
        ),
    ),
    picture=(
        ("chest", "{object: chest, joint: lid, at_most: 2 deg}"),
        ("chest", "{object: chest, joint: lid, at_least: 60 deg}"),
    ),
)


@pytest.mark.parametrize("joint", [DOOR, DRAWER], ids=["hinge", "slide"])
def test_positions_and_poses_are_each_others_inverse(joint):
    positions = np.linspace(-0.3, 2.9, 33)
    fixture = np.array(joint.fixture_pose)
    assert joint.positions(fixture, joint.poses(positions)) == pytest.approx(positions, abs=1e-9)


def test_a_point_on_the_axis_of_a_hinge_stays_where_it_is():
    on_axis = np.array([*DOOR.point[:2], 0.4])
    where = [DOOR.pose(angle).apply(on_axis) for angle in (0.0, 0.7, 1.9)]
    assert np.ptp(where, axis=0) == pytest.approx(0.0, abs=1e-12)
    turned = BASE.inverse() @ DOOR.pose(0.5)
    assert turned.rotation[0, 0] == pytest.approx(np.cos(0.5))
    assert turned.rotation[1, 0] == pytest.approx(np.sin(0.5))


def test_a_part_that_left_its_hinge_has_no_position():
    run = moved(DOOR, 1.2)
    torn = run.signals.object_poses["cabinet/door"].copy()
    torn[100:, 0] += 0.02
    poses = {**run.signals.object_poses, "cabinet/door": torn}
    run = replace(run, signals=replace(run.signals, object_poses=poses))
    answer = verdict(run, Joint(object="cabinet", joint="door", at_least=1.0))
    assert answer.status == "not observable"


def test_the_name_for_people_names_the_joint_where_no_other_key_does():
    run = moved(DOOR, 1.2)
    assert verdict(run, Joint(object="cabinet", name="door", at_least=1.0)).status == "passed"
    assert verdict(run, Joint(object="cabinet", at_least=1.0)).status == "passed"
    other = verdict(run, Joint(object="cabinet", joint="lid", at_least=1.0))
    assert other.status == "not observable"
