"""Cameras of robot, world and scenario put together, and what is recorded with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from harness.cell.scope import Problems, Scope
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


def check_cameras(
    world: Sequence[CameraSpec], scenario: Sequence[CameraSpec], scope: Scope
) -> None:
    """Report frames that nothing has; objects of every step are known by now."""
    frames = ("world", *scope.description.link_names, *scope.objects)
    for spec in world:
        if spec.pose.frame not in frames:
            scope.problems.add(
                ("world",),
                f"its camera '{spec.name}' is on '{spec.pose.frame}', which is no link of"
                f" {scope.description.name} and no object",
                "take another robot or world",
            )
        _check_simulated(spec, ("world",), scope)
    for index, spec in enumerate(scenario):
        loc = ("cameras", index, "pose", "frame")
        scope.check_frame(spec.pose.frame, loc)
        _check_simulated(spec, loc, scope)


def _check_simulated(spec: CameraSpec, loc: tuple[str | int, ...], scope: Scope) -> None:
    obj = scope.objects.get(spec.pose.frame)
    if obj is not None and not obj.in_simulation:
        scope.problems.add(
            loc,
            f"'{obj.name}' is known to the planner alone: no camera can be on it",
            "name an object that is `in: both` or `in: simulation`",
        )
