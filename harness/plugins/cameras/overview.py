"""A picture of a robot in a view that contains all of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.cameras.camera_recorder import Overview
from harness.core.world import WorldObject
from harness.plugins.cameras.camera_scene import floor_height
from harness.plugins.cameras.caption import captioned, strip_height
from harness.plugins.cameras.picture_model import build_picture_model
from harness.plugins.cameras.renderer import render_overview
from harness.robot.description import RobotDescription


def draw_overview(
    description: RobotDescription, objects: Sequence[WorldObject], request: Overview
) -> np.ndarray:
    """The picture, RGB."""
    width, height = request.size
    height -= strip_height() if request.caption else 0
    floor = floor_height(description, objects)
    picture = build_picture_model(
        description, objects, floor_height=floor, width=width, height=height
    )
    for name in request.tints.keys() & picture.geoms.keys():
        picture.rgba[picture.geoms[name], :3] = request.tints[name]
    picture.pose(request.poses)
    pixels = render_overview(picture, request.points, request.radii, width, height)
    return captioned(pixels, request.caption) if request.caption else pixels
