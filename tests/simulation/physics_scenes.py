"""Objects and motions that the physics tests share."""

import numpy as np

from harness.core.geometry import Box, Cylinder, Shape
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.world import Friction, WorldObject

ABOVE = (-0.85839, -1.18712, 0.47442, -0.85809, -1.5708, -1.64329)
AT_CYLINDER = (-0.85839, -1.32349, 1.7639, -2.01121, -1.5708, -1.64329)


def a_box(name, size, xyz, *, mass=0.0, friction=1.0, **options):
    x, y, z = np.square(size)
    return WorldObject(
        name,
        (Shape(Box(tuple(size))),),
        SE3.from_xyz_rpy(xyz),
        mass == 0.0,
        mass,
        np.zeros(3),
        mass / 12 * np.diag([y + z, x + z, x + y]),
        Friction(friction),
        **options,
    )


def a_cylinder(name, radius, length, xyz, *, mass, friction=1.0):
    across = mass * (3 * radius**2 + length**2) / 12
    inertia = np.diag([across, across, mass * radius**2 / 2])
    shapes = (Shape(Cylinder(radius, length)),)
    pose = SE3.from_xyz_rpy(xyz)
    return WorldObject(name, shapes, pose, False, mass, np.zeros(3), inertia, Friction(friction))


def a_motion(description, start, goal, duration):
    """A quintic from rest to rest, for the arm."""
    times = np.linspace(0.0, duration, int(100 * duration) + 1)
    u = (times / duration)[:, None]
    change = np.asarray(goal) - np.asarray(start)
    return JointTrajectory(
        description.groups[description.arm_group].joint_names,
        times,
        start + change * (10 * u**3 - 15 * u**4 + 6 * u**5),
        change * (30 * u**2 - 60 * u**3 + 30 * u**4) / duration,
        change * (60 * u - 180 * u**2 + 120 * u**3) / duration**2,
    )


def move_arm(simulator, goal, duration=2.0):
    dof = len(simulator.description.groups[simulator.description.arm_group].joint_names)
    start = simulator.commanded_positions()[:dof]
    simulator.track(a_motion(simulator.description, start, goal, duration))
