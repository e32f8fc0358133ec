"""The picture of a robot alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.cameras.camera_recorder import Overview, camera_recorder
from harness.cameras.meshes import undrawn
from harness.core.files import write_whole
from harness.core.geometry import bounding_radius
from harness.core.picture_files import jpeg, png
from harness.core.types import FloatArray
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Link

SIZE = 800  # [pixels], width and height of the picture
SMALLEST, LARGEST = 0.03, 0.15  # [m], radius around a link's origin that is in view


def save_robot_picture(
    description: RobotDescription, joint_positions: FloatArray, file: Path
) -> str:
    """Draw a robot at joint positions, in description order.

    Args:
        joint_positions: Joint positions, shape (n,).
        file: A PNG or JPEG file.

    Returns:
        A line that names the meshes that are not drawn; empty when all are.

    Raises:
        OSError: The file cannot be written.
    """
    poses = description.link_poses(joint_positions)
    links = [link for link in description.links if link.visuals or link.collisions]
    links = links or description.links[1:]
    centres = np.array([poses[link.name].translation for link in links])
    radii = np.array([_radius(link) for link in links])
    picture = Overview(poses, centres, radii, (SIZE, SIZE))
    image = camera_recorder(description, ()).overview(picture)
    write_whole(file, png(image) if file.suffix.lower() == ".png" else jpeg(image))
    missing = undrawn(description, ())
    return f"not in the picture: {', '.join(missing)}" if missing else ""


def _radius(link: Link) -> float:
    shapes = link.collisions or link.visuals
    largest = max((bounding_radius(shape) for shape in shapes), default=SMALLEST)
    return float(np.clip(largest, SMALLEST, LARGEST))
