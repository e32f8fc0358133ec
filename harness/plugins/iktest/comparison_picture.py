"""The picture of a robot where an inverse kinematics answer puts it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.cameras.camera_recorder import Overview, camera_recorder
from harness.cameras.marks import frame_mark, line_mark, mark
from harness.core.files import write_whole
from harness.core.picture_files import jpeg
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.robot.description import RobotDescription

AXIS_LENGTH = 0.06  # of the target's frame [m]
BLUE_GHOST = (0.15, 0.35, 0.95)
LINK_SIZE = 0.06  # radius around a link's origin that the view contains [m]


def draw_ik_comparison(
    description: RobotDescription,
    link: str,
    target: SE3,
    expected: FloatArray | None,
    reached: FloatArray | None,
    file: Path,
    caption: str,
) -> None:
    """Write a JPEG of the arm, the expected arm in translucent blue, and the target's frame.

    The frame's axes x, y, z are red, green, blue; an orange line connects the link with it.

    Args:
        link: The link whose pose the target fixes.
        target: The target pose T_world_link.
        expected: Joint positions that reach the target, description order; None when unknown.
        reached: The answer's joint positions; None draws the arm at `expected` alone.
        file: The file to write; its folder exists.
    """
    solid = expected if reached is None else reached
    assert solid is not None
    shown = description.link_poses(solid)
    marks = [frame_mark(target, AXIS_LENGTH)]
    line = line_mark(shown[link].translation, target.translation)
    marks += [] if line is None else [line]
    ghosts: list[WorldObject] = []
    if expected is not None and reached is not None:
        ghosts = _ghosts(description, expected)
        caption = f"{caption}  (blue: expected)"
    bodies = [*marks, *ghosts]
    shown |= {each.name: each.pose for each in bodies}
    sizes = {each.name: LINK_SIZE for each in description.links if each.visuals}
    sizes |= {ghost.name: LINK_SIZE for ghost in ghosts} | {marks[0].name: AXIS_LENGTH}
    points = np.array([shown[name].translation for name in sizes])
    radii = np.array(list(sizes.values()))
    tints = {ghost.name: BLUE_GHOST for ghost in ghosts}
    picture = Overview(shown, points, radii, tints=tints, caption=caption)
    write_whole(file, jpeg(camera_recorder(description, bodies).overview(picture)))


def _ghosts(description: RobotDescription, state: FloatArray) -> list[WorldObject]:
    """The robot's links at a state, translucent."""
    poses = description.link_poses(state)
    return [
        replace(mark(f"{link.name} expected", poses[link.name], *link.visuals), in_simulation=False)
        for link in description.links
        if link.visuals
    ]
