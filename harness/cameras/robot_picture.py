"""A picture of a robot alone."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from harness.cameras.picture_model import build_picture_model, undrawn
from harness.cameras.recorded_scene import floor_height
from harness.cameras.renderer import make_renderer
from harness.cameras.robot_poses import link_poses
from harness.cameras.viewpoint import fit_viewpoint
from harness.core.geometry import bounding_radius
from harness.core.types import FloatArray
from harness.robot.description import Link, RobotDescription

WIDTH, HEIGHT = 800, 800
SMALLEST, LARGEST = 0.03, 0.15
"""How far around a link's origin the picture reaches [m]."""


def save_robot_picture(
    description: RobotDescription, joint_positions: FloatArray, file: Path, backend: str = "auto"
) -> str:
    """Draw a robot at joint positions, in description order.

    Args:
        description: With its visuals.
        joint_positions: Shape (n,).
        file: PNG or JPEG.
        backend: `auto`, `egl`, `osmesa` or `rays`.

    Returns:
        One line on what is not drawn; empty when all is.

    Raises:
        OSError: The file cannot be written.
    """
    floor = floor_height(description, ())
    picture = build_picture_model(description, (), floor_height=floor, width=WIDTH, height=HEIGHT)
    poses = link_poses(description, joint_positions)
    links = [link for link in description.links if link.visuals or link.collisions]
    links = links or description.links[1:]
    centres = np.array([poses[link.name].translation for link in links])
    radii = np.array([_radius(link) for link in links])
    renderer = make_renderer(picture, WIDTH, HEIGHT, backend)
    try:
        picture.pose(poses)
        image = renderer.render(fit_viewpoint(centres, radii, WIDTH, HEIGHT).view)
    finally:
        renderer.close()
    done, encoded = cv2.imencode(file.suffix, np.ascontiguousarray(image[:, :, ::-1]))
    if not done:
        raise OSError(0, "cannot be encoded", str(file))
    file.write_bytes(encoded.tobytes())
    missing = undrawn(description, ())
    return f"not in the picture: {', '.join(missing)}" if missing else ""


def _radius(link: Link) -> float:
    shapes = link.collisions or link.visuals
    largest = max((bounding_radius(shape) for shape in shapes), default=SMALLEST)
    return float(np.clip(largest, SMALLEST, LARGEST))
