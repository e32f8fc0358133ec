"""One picture of every executed step, drawn from the recorded state at its end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from harness.cameras.camera_recorder import Stills
from harness.cameras.meshes import undrawn
from harness.core.activity import Activity, unobserved
from harness.core.geometry import bounding_radius
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.plugins.cameras.camera_scene import floor_height, scene_poses
from harness.plugins.cameras.caption import DARK, RED, captioned_jpeg, strip_height
from harness.plugins.cameras.picture_model import build_picture_model
from harness.plugins.cameras.renderer import make_renderer
from harness.plugins.cameras.viewpoint import Viewpoint, fit_viewpoint
from harness.recording.run import Run
from harness.recording.touched import touched_objects
from harness.robot.description import RobotDescription

WIDTH, HEIGHT = 640, 480 - strip_height()  # [pixels], without the caption
SHADOW_SIZE = 1024  # [pixels]
MOST_STEPS = 400  # that are drawn, at 20 to 100 ms each: the first and the last ones
LINK_RADIUS = 0.07  # [m] around a link's frame, which a view contains: the arms' joints
LARGE_OBJECT = 0.6  # [m]: a table widens no view
UNSEEN = 5e-4  # [m], a motion that a picture does not show, below half a pixel; directions too

INK = {"passed": (40, 130, 60), "expected error": (40, 130, 60), "failed": RED}
"""Colour of a caption's status, RGB."""


class StepRenderer:
    """Draws the state at the end of every executed step."""

    def __init__(
        self,
        description: RobotDescription,
        world_objects: Sequence[WorldObject],
        backend: str = "auto",
    ) -> None:
        """Load the shapes and the graphics library.

        Args:
            description: The robot, with its visuals.
            world_objects: All objects; those that only the planning scene has are translucent.
            backend: `auto`, `egl`, `osmesa` or `rays`.
        """
        self._description, self._objects = description, world_objects
        self._picture = build_picture_model(
            description,
            world_objects,
            floor_height=floor_height(description, world_objects),
            width=WIDTH,
            height=HEIGHT,
        )
        quality = self._picture.model.vis.quality
        quality.shadowsize, quality.offsamples = SHADOW_SIZE, 0  # half of the time on a processor
        self._renderer = make_renderer(self._picture, WIDTH, HEIGHT, backend)
        if self._renderer.backend != "rays":  # the first picture takes twice as long as others
            self._renderer.render(fit_viewpoint(np.zeros((1, 3)), np.ones(1), WIDTH, HEIGHT).view)
        self._notes: list[str] = []
        if self._renderer.backend == "rays" and backend == "auto":
            self._notes.append(
                "pictures by the ray camera: this machine has neither EGL nor OSMesa"
            )
        missing = undrawn(description, world_objects)
        if missing:
            self._notes.append(
                f"not in the pictures: {', '.join(missing)}; save them as OBJ or STL"
            )

    def draw(self, run: Run, activity: Activity = unobserved) -> Stills:
        """Draw a JPEG of every executed step, 640 x 480 with its caption."""
        steps = [step for step in run.steps if step.status != "not reached"]
        if not steps or not len(run.signals.times):
            return Stills()
        files: dict[str, bytes] = {}
        shown: dict[str, SE3] = {}
        picture = np.empty(0)
        for number, step in enumerate(steps, start=1):
            if MOST_STEPS // 2 < number <= len(steps) - MOST_STEPS // 2:
                continue
            activity("drawing a picture of each step", number - 1, len(steps))
            sample = min(max(step.end_index - 1, 0), len(run.signals.times) - 1)
            poses = scene_poses(self._description, self._objects, run, sample, step)
            if not looks_alike(poses, shown):
                self._picture.pose(poses)
                view = overview(self._description, self._objects, run, [sample]).view
                picture, shown = self._renderer.render(view), poses
            files[f"{number:02d}-{step.slug}.jpg"] = captioned_jpeg(
                picture,
                f"{number}/{len(steps)}  {step.summary or step.verb}",
                ink=DARK,
                status=f"{step.end_time:.2f} s  {step.status.replace('_', ' ')}",
                status_ink=INK.get(step.status, (60, 60, 60)),
            )
        notes = list(self._notes)
        if len(steps) > MOST_STEPS:
            half = MOST_STEPS // 2
            notes.append(f"pictures of the first {half} and the last {half} of {len(steps)} steps")
        return Stills(self._renderer.backend, files, "; ".join(notes))

    def close(self) -> None:
        """Free the resources of the graphics library."""
        self._renderer.close()


def looks_alike(poses: Mapping[str, SE3], others: Mapping[str, SE3]) -> bool:
    """Whether the same bodies are shown, none of them moved so far that a picture shows it."""
    return poses.keys() == others.keys() and all(
        np.allclose(pose.matrix(), others[name].matrix(), rtol=0.0, atol=UNSEEN)
        for name, pose in poses.items()
    )


def overview(
    description: RobotDescription,
    world_objects: Sequence[WorldObject],
    run: Run,
    samples: Sequence[int],
    size: tuple[int, int] = (WIDTH, HEIGHT),
) -> Viewpoint:
    """A view that is filled by the robot and what it touched, in all of the given samples.

    Args:
        size: Width and height of the picture [pixels].
    """
    points: list[np.ndarray] = []
    radii: list[float] = []
    touched = touched_objects(run)
    sizes = {
        obj.name: max((bounding_radius(shape) for shape in obj.shapes), default=0.0)
        for obj in world_objects
        if obj.name in touched
    }
    for sample in samples:
        scene = scene_poses(description, world_objects, run, sample)
        arm = [scene[link.name].translation for link in description.links if link.name != "world"]
        points += arm
        radii += [LINK_RADIUS] * len(arm)
        reach = np.ptp(arm, axis=0).max() if arm else 0.0
        for name, radius in sizes.items():
            if name not in scene or radius >= LARGE_OBJECT:
                continue
            place = scene[name].translation
            if np.linalg.norm(np.array(arm) - place, axis=1).min() < max(reach, LARGE_OBJECT):
                points.append(place)
                radii.append(radius)
    return fit_viewpoint(np.array(points), np.array(radii), *size)
