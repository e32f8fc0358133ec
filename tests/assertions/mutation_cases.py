"""A passing run of each predicate, with a time before its window in which it did not hold."""

from dataclasses import replace

import numpy as np

from harness.core.spatial import SE3
from harness.expectations.clearance import Clearance
from harness.expectations.collision import Collision
from harness.expectations.displaced import Displaced
from harness.expectations.duration import DurationCheck
from harness.expectations.effort import Effort
from harness.expectations.formula import Formula
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
from harness.expectations.slip import Slip
from harness.expectations.static import Static
from harness.expectations.tcp_path import TcpPath
from harness.expectations.tcp_pose import TcpPose
from harness.expectations.tracking_error import TrackingError
from harness.expectations.until import Until
from harness.expectations.within_limits import WithinLimits
from harness.language.poses import Pose
from tests.assertions.evidence import collected
from tests.assertions.synthetic_run import (
    BOX,
    ROBOT,
    TABLE,
    at,
    attachment,
    followed,
    force,
    gripped,
    heights,
    lift_run,
    make_run,
    step,
    thing,
)

N = 200
LATE = (step("early", 0, 100), step("late", 100, N))


def columns(shoulder, finger=0.0):
    """Two joints, each a number before the window and one in it."""
    rows = np.zeros((N, 2))
    for column, value in enumerate((shoulder, finger)):
        before, inside = value if isinstance(value, tuple) else (value, value)
        rows[:100, column], rows[100:, column] = before, inside
    return rows


def late(**signals):
    return make_run(steps=LATE, **signals)


def halves(before, inside):
    """A pose before the window and one in it, each xyz and roll."""
    poses = [at(100, p[:3], SE3.from_xyz_rpy(rpy=(p[3], 0, 0)).quat_wxyz) for p in (before, inside)]
    return np.concatenate(poses)


def standing(**more):
    """The box in the hand, elsewhere and tilted, then put down on the table."""
    forces = {
        ("Table", "box"): force(N, (90, N)),
        ("left_finger", "box"): force(N, (20, 80)),
        ("right_finger", "box"): force(N, (20, 80)),
    }
    box = halves((0.3, 0, -0.3, 1.0), (0, 0, 0.02, 0))
    carried = {("Table", "box"): forces["Table", "box"]}
    return late(contact_forces=forces, support_forces=carried, object_poses={"box": box}, **more)


BIN = thing("bin", static=True)
IN_BIN = late(
    objects=(TABLE, BOX, BIN),
    object_poses={
        "box": halves((0.2, 0, 0.02, 0), (0, 0, 0.02, 0)),
        "bin": halves((0, 0.2, 0.02, 0), (0, 0, 0.02, 0)),
    },
)
LINE = {"start": {"xyz": [0, 0, 0.3]}, "end": {"xyz": [0, 0, 0.5]}}
ALONG = heights(np.concatenate([np.full(100, 0.3), np.linspace(0.3, 0.5, 100)]))
SWING = at(N, (0, 0, 0.02))
SWING[:100, 0] = np.linspace(-0.1, 0, 100)
DISTANT = np.where(np.arange(N) < 100, 0.001, 0.05)
MOVING = {
    "joint_positions": columns((0.9, 0.0), 0.02),
    "joint_velocities": columns((1.0, 0.0), (0.3, 0.0)),
    "joint_efforts": columns((11.0, 1.0), (21.0, 1.0)),
    "joint_commands": columns((0.0, 0.0), 0.02),
    "joint_command_velocities": np.where(np.arange(N)[:, None] < 100, np.arange(N)[:, None], 99.0)
    * np.array([1.0, 0.0]),
}
REPORTS = (
    step("path", 0, 100, "cartesian_path", result=followed(0.9)),
    step("late", 100, N, "gripper", result=gripped(stalled=True)),
)

CASES = [
    *(case for evidence in collected().values() for case in evidence.mutation_cases),
    (Lifted(object="box", above=0.05), lift_run(), "lift"),
    (Grasped(object="box"), lift_run(), ""),
    (Released(object="box"), standing(), "late"),
    (Placed(object="box", on="Table", pose=Pose(xyz=(0, 0, 0.02))), standing(), "late"),
    (On(object="box", support="Table"), standing(), "late"),
    (In(object="box", container="bin"), IN_BIN, "late"),
    (
        Displaced(object="box", at_least=0.05),
        late(object_poses={"box": halves((0.3, 0, 0.02, 0), (0, 0, 0.02, 0))}),
        "late",
    ),
    (Static(object="box"), late(object_poses={"box": SWING}), "late"),
    (Static(), late(object_poses={"box": SWING}, joint_velocities=columns((1, 0), (1, 0))), "late"),
    (InContact(between=("left_finger", "box"), min_force=0.5), lift_run(), "lift"),
    (
        Never(predicate=Collision(between=("robot", "box"))),
        late(
            contact_forces={("arm_link", "box"): force(N, (20, 60))},
            clearances={("robot", "box"): DISTANT},
        ),
        "late",
    ),
    (
        Never(predicate=Collision(count_allowed=True)),
        late(link_overlaps={("arm_link", "palm"): force(N, (20, 60), value=0.04)}),
        "late",
    ),
    (Never(predicate=Collision()), late(clearances={("robot", "box"): DISTANT}), "late"),
    (
        Clearance(between=("robot", "box"), at_least=0.01),
        late(clearances={("robot", "box"): DISTANT}),
        "late",
    ),
    (
        Clearance(between=("robot", "box"), max_below_plan=0.01),
        late(
            clearances={("robot", "box"): DISTANT},
            planned_clearances={("robot", "box"): np.full(N, 0.055)},
        ),
        "late",
    ),
    (
        TcpPose(pose=Pose(xyz=(0, 0, 0.3), frame="box")),
        late(
            tcp_pose=halves((0, 0.1, 0.3, 0.5), (0, 0, 0.32, 0)),
            object_poses={"box": halves((0.1, 0, 0, 0), (0, 0, 0.02, 0))},
        ),
        "late",
    ),
    (
        TcpPose(link="arm_link", pose=Pose(xyz=(0, 0, 0.3))),
        late(frames={"arm_link": halves((0, 0.1, 0.3, 0.5), (0, 0, 0.3, 0))}),
        "late",
    ),
    (TcpPath(line=LINE), late(tcp_pose=ALONG), "late"),
    (PathLength(at_most=0.21, at_least=0.19), late(tcp_pose=ALONG), "late"),
    (Joints(positions={"shoulder": 0.0, "finger": 0.02}), late(**MOVING), "late"),
    (NamedTarget(state="home"), late(**MOVING), "late"),
    (GripperState(position=0.02), late(joint_positions=columns(0, (0, 0.02))), "late"),
    (GripperState(width=0.04), late(joint_positions=columns(0, (0, 0.02))), "late"),
    (GripperState(stalled=True), make_run(steps=REPORTS), "late"),
    (
        WithinLimits(acceleration=True),
        late(
            **{
                **MOVING,
                "joint_positions": columns((2.0, 0.0), (0.5, 0.02)),
                "joint_velocities": columns((3.0, 0.0), (2.0, 0.0)),
            }
        ),
        "late",
    ),
    (
        WithinLimits(velocity=False, effort=False),
        replace(
            late(joint_positions=columns((2.0, 0.0), -0.0005), joint_commands=columns(0.0)),
            robot=replace(ROBOT, gripper=None),
        ),
        "late",
    ),
    (TrackingError(), late(**MOVING), "late"),
    (Effort(max_fraction=0.5), late(**MOVING), "late"),
    (DurationCheck(at_most=1.0, at_least=0.9), late(), "late"),
    (FractionCheck(at_least=0.8), make_run(steps=REPORTS), ""),
    (
        Slip(object="box"),
        lift_run(attachments=[attachment("box", 45, N)]),
        "",
    ),
    (
        Formula(
            formula="always (z(box) < 0.1 and force(Table, box) > 0.5 and tilt(box) < 0.1"
            ") and eventually z(tcp) > 0.49"
        ),
        standing(tcp_pose=ALONG),
        "late",
    ),
    (
        Formula(formula="eventually (speed(box) > 0.05 and speed(box) < 1)"),
        late(object_poses={"box": SWING}),
        "",
    ),
    (
        Formula(
            formula="always (abs(position(shoulder) - command(shoulder)) < 0.05"
            " and velocity(shoulder) < 0.1 and effort(shoulder) < 2"
            " and distance(robot, box) > 0.01)"
        ),
        late(**MOVING, clearances={("robot", "box"): DISTANT}),
        "late",
    ),
    (
        Until(predicate=On(object="box", support="Table"), until=Lifted(object="box", above=0.05)),
        lift_run(
            leave=140,
            object_poses={"box": heights([0.02] * 140 + [0.12] * 60)},
            tcp_pose=heights([0.05] * 140 + [0.15] * 60),
        ),
        "",
    ),
]
