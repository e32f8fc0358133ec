"""A picture of an arm where it should be and where it is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.cameras.caption import write_captioned
from harness.cameras.marks import frame_mark, mark, way_mark
from harness.cameras.picture_model import build_picture_model
from harness.cameras.recorded_scene import floor_height
from harness.cameras.renderer import make_renderer
from harness.cameras.robot_poses import link_poses
from harness.cameras.stills import HEIGHT, WIDTH
from harness.cameras.viewpoint import fit_viewpoint
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.robot.description import RobotDescription

AXIS_LENGTH = 0.06  # [m] of the target's frame
BLUE_GHOST = (0.15, 0.35, 0.95)
LINK_SIZE = 0.06  # [m] a link's share of the view


def draw_asked_and_reached(
    description: RobotDescription,
    link: str,
    target: SE3,
    asked: FloatArray | None,
    reached: FloatArray | None,
    file: Path,
    caption: str,
    *,
    backend: str = "auto",
) -> None:
    """Write a JPEG: the arm as it stands, blue as it should stand, the target's frame.

    The frame is red, green, blue (x, y, z); an orange line leads to it from the link.

    Args:
        description: The robot.
        link: The one that is placed.
        target: T_world_link that was asked for.
        asked: Positions that reach it, description order; None where nobody knows any.
        reached: Positions that came back; None shows the arm at `asked` alone.
        file: To write; its folder exists.
        caption: Below the picture.
        backend: `auto`, `egl`, `osmesa` or `rays`.
    """
    solid = asked if reached is None else reached
    assert solid is not None
    shown = link_poses(description, solid)
    marks = [frame_mark(target, AXIS_LENGTH)]
    way = way_mark(shown[link].translation, target.translation)
    marks += [] if way is None else [way]
    ghosts: list[WorldObject] = []
    if asked is not None and reached is not None:
        ghosts = _ghosts(description, asked)
        caption = f"{caption}  (blue: as asked)"
    picture = build_picture_model(
        description,
        [*marks, *ghosts],
        floor_height=floor_height(description, []),
        width=WIDTH,
        height=HEIGHT,
    )
    for ghost in ghosts:
        picture.rgba[picture.geoms[ghost.name], :3] = BLUE_GHOST
    shown |= {each.name: each.pose for each in (*marks, *ghosts)}
    picture.pose(shown)
    sizes = {each.name: LINK_SIZE for each in description.links if each.visuals}
    sizes |= {ghost.name: LINK_SIZE for ghost in ghosts} | {marks[0].name: AXIS_LENGTH}
    points = np.array([shown[name].translation for name in sizes])
    radii = np.array(list(sizes.values()))
    renderer = make_renderer(picture, WIDTH, HEIGHT, backend)
    try:
        pixels = renderer.render(fit_viewpoint(points, radii, WIDTH, HEIGHT).view)
    finally:
        renderer.close()
    write_captioned(file, pixels, caption)


def _ghosts(description: RobotDescription, state: FloatArray) -> list[WorldObject]:
    """The robot's links as they stand at a state, translucent."""
    poses = link_poses(description, state)
    return [
        replace(mark(f"{link.name} as asked", poses[link.name], *link.visuals), in_simulation=False)
        for link in description.links
        if link.visuals
    ]
