"""For every predicate a run that satisfies it, one that barely does not, one it never applied to.

One expectation is judged on three runs, so what differs is what happened. The barely failing one is
past the limit by less than a tenth of it, and the margin says by how much, in the unit that the
reference names.
"""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.expectations.clearance import Clearance
from harness.expectations.collision import Collision
from harness.expectations.displaced import Displaced
from harness.expectations.duration import DurationCheck
from harness.expectations.effort import Effort
from harness.expectations.fraction import FractionCheck
from harness.expectations.grasped import Grasped
from harness.expectations.gripper import GripperState
from harness.expectations.in_ import In
from harness.expectations.in_contact import InContact
from harness.expectations.joints import Joints
from harness.expectations.lifted import Lifted
from harness.expectations.named_target import NamedTarget
from harness.expectations.never import Never
from harness.expectations.on import On
from harness.expectations.path_length import PathLength
from harness.expectations.placed import Placed
from harness.expectations.released import Released
from harness.expectations.sees import Sees
from harness.expectations.slip import Slip
from harness.expectations.static import Static
from harness.expectations.tcp_path import TcpPath
from harness.expectations.tcp_pose import TcpPose
from harness.expectations.tracking_error import TrackingError
from harness.expectations.within_limits import WithinLimits
from harness.language.language import PREDICATES
from harness.language.poses import Pose
from tests.assertions.evidence import Three, collected
from tests.assertions.picture_mutants import SUBJECTS, seen_run
from tests.assertions.synthetic_run import (
    BOX,
    DT,
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
from tests.assertions.synthetic_run import followed as path_followed

N = 200


def quantity_of(word, measure):
    """The quantity that a verdict's measure is one of; None if the predicate has no such one."""
    for quantity in sorted(PREDICATES[word].quantities, key=lambda each: -len(each.name)):
        if quantity.name in measure.name and measure.unit in quantity.unit.split(" or "):
            return quantity
    return None


UNREACHED = make_run(steps=(step("later", N, N, status="not reached"),))
NO_BOX = make_run(objects=(TABLE, replace(BOX, present=())), object_poses={"box": at(N) * np.nan})


def tilted(roll):
    return SE3.from_xyz_rpy(rpy=(roll, 0, 0)).quat_wxyz


def on_table(newton, **more):
    return make_run(contact_forces={("Table", "box"): force(N, (0, N), value=newton)}, **more)


def with_joint(**rows):
    """The shoulder at one value all along."""
    return make_run(**{name: np.tile([value, 0.02], (N, 1)) for name, value in rows.items()})


def creeping(speed):
    poses = at(N, (0, 0, 0.02))
    poses[:, 0] = np.arange(N) * DT * speed
    return poses


def slid(run, by):
    poses = run.signals.object_poses["box"].copy()
    poses[150:, 2] -= by
    return changed(run, object_poses={"box": poses})


def touched(newton):
    return make_run(contact_forces={("arm_link", "box"): force(N, (50, 60), value=newton)})


def in_bin(x):
    record = thing("bin", static=True)
    return make_run(
        objects=(TABLE, BOX, record),
        object_poses={"bin": at(N, (0, 0, 0.02)), "box": at(N, (x, 0, 0.02))},
    )


def straying(by):
    tcp = heights(np.linspace(0.3, 0.5, N))
    tcp[100, 0] = by
    return make_run(tcp_pose=tcp)


def travelling(length):
    return make_run(tcp_pose=heights(np.linspace(0, length, N)))


def near(distance):
    return make_run(clearances={("robot", "box"): np.full(N, distance)})


def followed(share):
    return make_run(steps=(step("path", 0, 100, "cartesian_path", result=path_followed(share)),))


def lasting(samples):
    return make_run(steps=(step("move", 0, samples + 1),))


SEEN = {kind: seen_run(kind) for kind in SUBJECTS}
LINE = {"start": {"xyz": [0, 0, 0.3]}, "end": {"xyz": [0, 0, 0.5]}}
HELD = {"attachments": [attachment("box", 45, N)]}

THREE = [
    *(three for evidence in collected().values() for three in evidence.three_runs),
    Three(
        Lifted(object="box", above=0.05), lift_run(), lift_run(height=0.049), -0.001, "m", NO_BOX
    ),
    Three(Grasped(object="box"), lift_run(), slid(lift_run(), 0.0051), -1e-4, "m", NO_BOX),
    Three(Released(object="box"), touched(0.0), lift_run(value=0.00052), -4e-5, "N", NO_BOX),
    Three(
        Placed(object="box", pose=Pose(xyz=(0, 0, 0.02))),
        on_table(1.0),
        on_table(1.0, object_poses={"box": at(N, (0.0101, 0, 0.02))}),
        -1e-4,
        "m",
        NO_BOX,
    ),
    Three(On(object="box", support="Table"), on_table(0.98), on_table(0.48), -0.01, "N", NO_BOX),
    Three(In(object="box", container="bin"), in_bin(0.0), in_bin(0.0205), -0.0005, "m"),
    Three(
        Displaced(object="box", at_least=0.05),
        make_run(object_poses={"box": heights(np.linspace(0.02, 0.08, N))}),
        make_run(object_poses={"box": heights(np.linspace(0.02, 0.069, N))}),
        -0.001,
        "m",
        NO_BOX,
    ),
    Three(
        Static(object="box"),
        make_run(),
        make_run(object_poses={"box": creeping(0.0051)}),
        -1e-4,
        "m/s",
        NO_BOX,
    ),
    Three(
        InContact(between=("robot", "box"), min_force=1.0), touched(2.0), touched(0.99), -0.01, "N"
    ),
    Three(
        Never(predicate=Collision(between=("robot", "box"))),
        near(0.05),
        touched(0.05),
        -0.05,
        "N",
    ),
    Three(
        Clearance(between=("robot", "box"), at_least=0.01),
        near(0.05),
        near(0.0099),
        -1e-4,
        "m",
        replace(near(np.nan), objects=(TABLE, replace(BOX, present=()))),
    ),
    Three(
        TcpPose(pose=Pose(xyz=(0, 0, 0.3))),
        make_run(),
        make_run(tcp_pose=at(N, (0, 0.00105, 0.3))),
        -5e-5,
        "m",
    ),
    Three(TcpPath(line=LINE, max_deviation=0.002), straying(0), straying(0.0021), -1e-4, "m"),
    Three(
        Joints(positions={"shoulder": 0.0}),
        make_run(),
        with_joint(joint_positions=0.0101),
        -1e-4,
        "rad",
    ),
    Three(NamedTarget(state="home"), make_run(), with_joint(joint_positions=-0.0105), -5e-4, "rad"),
    Three(
        GripperState(position=0.0199, tolerance=0.001),
        make_run(),
        make_run(joint_positions=np.tile([0.0, 0.02095], (N, 1))),
        -5e-5,
        "m",
    ),
    Three(WithinLimits(), make_run(), with_joint(joint_velocities=2.012), -0.01, "rad/s"),
    Three(TrackingError(), make_run(), with_joint(joint_positions=0.051), -0.001, "rad"),
    Three(Effort(max_fraction=0.5), make_run(), with_joint(joint_efforts=5.05), -0.005, "1"),
    Three(DurationCheck(at_most=0.5), lasting(49), lasting(51), -0.01, "s", during="move"),
    Three(
        PathLength(at_most=0.4),
        travelling(0.4),
        travelling(0.41),
        -0.01,
        "m",
    ),
    Three(FractionCheck(at_least=0.8), followed(0.8), followed(0.79), -0.01, "1", make_run()),
    Three(
        Slip(object="box"), lift_run(**HELD), slid(lift_run(**HELD), 0.0031), -1e-4, "m", make_run()
    ),
]


def word(spec):
    return getattr(spec, "predicate", spec).word


def test_every_predicate_has_its_three_runs():
    assert {type(getattr(each.spec, "predicate", each.spec)) for each in THREE} | {Sees} == set(
        PREDICATES.values()
    )


@pytest.mark.parametrize("three", THREE, ids=lambda three: word(three.spec))
def test_it_passes_barely_fails_and_says_nothing_of_what_it_never_met(three):
    assert verdict(three.satisfied, three.spec, three.during).status == "passed"
    failed = verdict(three.barely, three.spec, three.during)
    assert (failed.status, failed.unit) == ("failed", three.unit)
    assert failed.margin == pytest.approx(three.by, rel=1e-3)
    assert failed.measures
    assert np.isfinite(failed.time)
    if three.never is not None:
        assert verdict(three.never, three.spec).status == "not reached"
    unreached = verdict(UNREACHED, three.spec, "later")
    assert unreached.status == "not reached"
    assert "before step 'later'" in unreached.reason


@pytest.mark.parametrize("three", THREE, ids=lambda three: word(three.spec))
def test_the_numbers_of_a_verdict_are_those_of_the_reference(three):
    for run in (three.satisfied, three.barely):
        answer = verdict(run, three.spec, three.during)
        named = [quantity_of(word(three.spec), m) for m in answer.measures]
        assert None not in named, answer.measures
        units = " or ".join(each.unit for each in PREDICATES[word(three.spec)].quantities)
        assert answer.unit in units.split(" or ")


@pytest.mark.parametrize("kind", SUBJECTS)
def test_what_a_camera_sees_is_measured_as_the_reference_says(kind):
    spec, run, _ = SEEN[kind]
    answer = verdict(run, spec)
    assert answer.status == "passed"
    assert all(quantity_of("sees", m) for m in answer.measures)
    assert verdict(UNREACHED, spec, "later").status == "not reached"


@pytest.mark.parametrize("model", PREDICATES.values(), ids=lambda model: model.__name__)
def test_a_predicate_is_defined_in_one_sentence(model):
    definition = " ".join(model.__doc__.split("\n\n")[0].split())
    assert definition.endswith(".")
    assert definition.count(". ") == 0
