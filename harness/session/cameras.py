"""Cameras of robot, world and scenario put together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from harness.cell.scope import Problems
from harness.core.camera import Camera
from harness.language.cameras import CameraSpec


def all_cameras(
    robot: Mapping[str, Camera],
    world: Sequence[CameraSpec],
    scenario: Sequence[CameraSpec],
    problems: Problems,
) -> dict[str, Camera]:
    """Every camera by name, the robot's first; names that are there twice are reported."""
    cameras = dict(robot)
    for spec in world:
        if spec.name in cameras:
            problems.add(("world",), f"its camera '{spec.name}' is there twice", "rename it")
        cameras[spec.name] = spec.resolved()
    for index, spec in enumerate(scenario):
        if spec.name in cameras:
            problems.add(
                ("cameras", index, "name"),
                f"another camera is called '{spec.name}'",
                "every camera has a name of its own, those of the robot and the world included",
            )
        cameras[spec.name] = spec.resolved()
    return cameras
