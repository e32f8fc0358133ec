"""Checks that a mesh file can be used, before a model is built from it."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco
import numpy as np

from harness.core.errors import RobotError
from harness.core.geometry import Mesh
from harness.simulation.geoms import add_mesh, hull_points

LEAST_SIZE = 1e-3  # The size below which a mesh is thought to have a wrong scale [m]


def check_mesh(geometry: Mesh) -> None:
    """Check that a mesh file contains a solid that can collide.

    Raises:
        RobotError: The format is not supported, or the mesh is damaged or flat.
    """
    spec = mujoco.MjSpec()
    try:
        name = add_mesh(spec, geometry)
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name)
        spec.compile()
    except ValueError as error:
        reason = str(error).splitlines()[0].removeprefix("Error: ")
        size = float(np.ptp(hull_points(geometry), axis=0).max())
        if size < LEAST_SIZE:
            reason = f"it is {size * 1e3:.2g} mm large; state a larger `scale`"
        raise RobotError(f"{geometry.path.name} cannot be used: {reason}") from error
