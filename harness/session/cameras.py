"""Cameras of robot, world and scenario put together, and what is recorded with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.util import find_spec

from harness.cell.scope import Problems, Scope
from harness.core.camera import Camera
from harness.core.extras import install_command
from harness.core.registry import absent_plugins, registry
from harness.language.cameras import CameraSpec, VideoSpec


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


def check_videos(videos: Sequence[VideoSpec], scope: Scope) -> dict[str, float]:
    """Frames a second of every camera that is recorded, by its name."""
    rates: dict[str, float] = {}
    if videos and "rendered" not in registry("camera_recorder"):
        hint = "; ".join(absent_plugins())
        scope.problems.add(("videos",), "no plug-in records cameras here", hint)
    elif videos and find_spec("av") is None:
        hint = f"install it by: {install_command('video')}"
        scope.problems.add(
            ("videos",), "the Python package av, which films, is not installed", hint
        )
    for index, spec in enumerate(videos):
        loc = ("videos", index, "camera")
        if spec.camera in rates:
            scope.problems.add(loc, f"'{spec.camera}' is recorded already", "name it once")
        scope.check_camera(spec.camera, loc)
        camera = scope.cameras.get(spec.camera)
        if camera is None:
            continue
        rates[spec.camera] = spec.rate or camera.update_rate
        if rates[spec.camera] > camera.update_rate:
            scope.problems.add(
                ("videos", index, "rate"),
                f"'{spec.camera}' takes {camera.update_rate:g} pictures a second, not"
                f" {rates[spec.camera]:g}",
                "lower `rate`, or raise the camera's `update_rate`",
            )
    return rates
