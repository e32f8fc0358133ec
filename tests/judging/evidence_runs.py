"""Runs that the tests of expectations state their evidence with, most of them in two halves."""

from dataclasses import replace

import numpy as np

from harness.core.spatial import SE3
from tests.judging.synthetic_run import (
    BOX,
    DT,
    TABLE,
    at,
    attachment,
    changed,
    followed,
    force,
    gripped,
    heights,
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


def path_run(share):
    return make_run(steps=(step("path", 0, 100, "cartesian_path", result=followed(share)),))


def lasting(samples):
    return make_run(steps=(step("move", 0, samples + 1),))


HELD = {"attachments": [attachment("box", 45, N)]}
