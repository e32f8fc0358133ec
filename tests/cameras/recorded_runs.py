"""A recorded run without physics: a still arm, a simulated box, an imagined one."""

from dataclasses import replace

import numpy as np

from harness.core.geometry import Box, Plane, Shape
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.recording.run import AttachmentRecord, ObjectRecord, Run
from harness.recording.signals import Signals
from harness.recording.step_record import StepRecord

RED, BLUE = (0.9, 0.05, 0.05, 1.0), (0.05, 0.05, 0.9, 1.0)


def an_object(name, size, xyz, rgba, *, simulated=True):
    return WorldObject(
        name,
        (Shape(Box(size), rgba=rgba),),
        SE3.from_xyz_rpy(xyz),
        True,
        0.0,
        np.zeros(3),
        np.zeros((3, 3)),
        in_simulation=simulated,
    )


GROUND = WorldObject(
    "ground", (Shape(Plane()),), SE3.identity(), True, 0.0, np.zeros(3), np.zeros((3, 3))
)
RED_BOX = an_object("red_box", (0.1, 0.1, 0.1), (0.35, -0.35, 0.05), RED)
IMAGINED = an_object("imagined", (0.1, 0.1, 0.1), (0.35, 0.35, 0.05), BLUE, simulated=False)
OBJECTS = (GROUND, RED_BOX, IMAGINED)


def a_run(description):
    """Four steps of one sample each: before, the box moved, it gone, the imagined one attached."""
    count = 4
    positions = np.tile(description.start_positions(), (count, 1))
    red = np.tile(RED_BOX.pose.as_vector(), (count, 1))
    red[1, 2] += 0.2
    red[2:] = np.nan
    believed = np.tile(IMAGINED.pose.as_vector(), (count, 1))
    believed[2] = np.nan
    believed[3, 2] += 0.5
    ground = np.tile(GROUND.pose.as_vector(), (count, 1))
    nothing = np.zeros((count, len(description.joint_names)))
    signals = Signals(
        times=np.arange(count, dtype=float),
        joint_positions=positions,
        joint_velocities=nothing,
        joint_efforts=nothing,
        joint_commands=positions,
        joint_command_velocities=nothing,
        tcp_pose=np.zeros((count, 7)),
        object_poses={"red_box": red, "ground": ground, "imagined": believed},
    )
    steps = tuple(
        StepRecord(f"step {i}", f"steps[{i}]", "wait", f"wait {i}", i, "passed", i, i, i, i + 1)
        for i in range(count)
    )
    robot = replace(description, joints=(), groups={}, links=())
    imagined = ObjectRecord(
        "imagined",
        is_static=True,
        in_planning=True,
        in_simulation=False,
        shapes=IMAGINED.shapes,
        present=((0.0, 2.0),),
        pose=tuple(IMAGINED.pose.as_vector()),
    )
    held = AttachmentRecord(
        "imagined", description.tcp_link, 3.0, 3.0, (0.0, 0, 0.1, 1, 0, 0, 0), "imagined"
    )
    skipped = StepRecord("late", "steps[4]", "wait", "wait", 9, "not reached")
    return Run("a run", "a.yaml", "", 1, robot, (imagined,), (held,), (*steps, skipped), signals)
