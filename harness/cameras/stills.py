"""One picture of every executed step, drawn from the recorded state at its end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from harness.cameras.camera_scene import floor_height, scene_poses
from harness.cameras.caption import DARK, RED, captioned_jpeg
from harness.cameras.picture_model import build_picture_model, undrawn
from harness.cameras.renderer import make_renderer
from harness.cameras.viewpoint import OVERVIEW_STATES, Viewpoint, fit_viewpoint
from harness.core.activity import Activity, unobserved
from harness.core.geometry import bounding_radius
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.recording.run import Run
from harness.robot.description import RobotDescription

WIDTH, HEIGHT = 640, 480  # [pixels]
SHADOW_SIZE = 1024  # [pixels]
MOST_STEPS = 400  # that are drawn, at 20 to 100 ms each: the first and the last ones
FARTHEST_IN_VIEW = 1.3  # [m]; objects farther from the base may be outside the view
UNSEEN = 5e-4  # [m], a motion that a picture does not show, below half a pixel; directions too

INK = {"passed": (40, 130, 60), "expected error": (40, 130, 60), "failed": RED}
"""Colour of a caption's status, RGB."""


@dataclass(frozen=True)
class Stills:
    """The pictures of a run's steps.

    Attributes:
        backend: `egl`, `osmesa` or `rays`; empty when no step was executed.
        files: The content of the JPEG files by name, in order of the steps.
        note: A line on limitations of the pictures; empty without limitations.
    """

    backend: str = ""
    files: Mapping[str, bytes] = field(default_factory=dict[str, bytes])
    note: str = ""


class StepRenderer:
    """Draws the state at the end of every executed step; it is set up before the run is known."""

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
        """Draw a JPEG of every executed step, 640 x 480."""
        steps = [step for step in run.steps if step.status != "not reached"]
        if not steps or not len(run.signals.times):
            return Stills()
        view = overview(self._description, self._objects, run).view
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
    description: RobotDescription, world_objects: Sequence[WorldObject], run: Run
) -> Viewpoint:
    """A view that contains the robot in all its recorded states and the objects around it."""
    last = len(run.signals.times) - 1
    points: list[np.ndarray] = []
    radii: list[float] = []
    link_sizes = {
        link.name: max((bounding_radius(shape) for shape in link.collisions), default=0.03)
        for link in description.links
    }
    for sample in np.unique(np.linspace(0, last, OVERVIEW_STATES).astype(int)):
        poses = description.link_poses(run.signals.joint_positions[sample])
        for name, size in link_sizes.items():
            if name != "world":
                points.append(poses[name].translation)
                radii.append(min(size, 0.15))
    base = description.link_poses(run.signals.joint_positions[0])[description.base_link]
    for sample in (0, last):
        scene = scene_poses(description, world_objects, run, int(sample))
        for obj in world_objects:
            size = max((bounding_radius(shape) for shape in obj.shapes), default=0.0)
            pose = scene.get(obj.name)
            if pose is None or not size < 0.6:
                continue
            if np.linalg.norm(pose.translation - base.translation) < FARTHEST_IN_VIEW:
                points.append(pose.translation)
                radii.append(size)
    return fit_viewpoint(np.array(points), np.array(radii), WIDTH, HEIGHT)
