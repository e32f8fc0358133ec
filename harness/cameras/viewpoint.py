"""From where pictures are taken: overviews that hold everything that matters, and cameras."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.camera import Camera
from harness.core.spatial import SE3
from harness.core.types import FloatArray

AZIMUTH, ELEVATION = 146.0, -24.0
"""Where an overview looks to [deg]: from the front right of a robot that faces +x, from above."""

FIELD_OF_VIEW = 38.0
"""Vertical [deg]."""

FILLED = 0.86
"""Part of the picture that the fitted points may fill."""


@dataclass(frozen=True, eq=False)
class View:
    """What a renderer draws from: a pinhole with square pixels.

    Attributes:
        pose: T_world_camera in OpenGL's convention: x right, y up, looks along -z.
        field_of_view: Vertical [deg].
        near: Nothing nearer along the axis is seen [m].
        far: Nothing farther along the axis is seen [m].
    """

    pose: SE3
    field_of_view: float
    near: float = 0.01
    far: float = 60.0


FLIP = SE3(np.diag([1.0, -1.0, -1.0]), np.zeros(3))
"""T_optical_opengl: the picture's y and the axis turned round."""


def view_of(camera: Camera, carrier: SE3) -> View:
    """From where a camera looks.

    Args:
        camera: Which.
        carrier: T_world_frame of what carries it.
    """
    pose = carrier @ camera.optical_pose @ FLIP
    return View(pose, np.degrees(camera.vertical_fov), camera.clip_near, camera.clip_far)


@dataclass(frozen=True, eq=False)
class Viewpoint:
    """A perspective camera in MuJoCo's free-camera words.

    Attributes:
        lookat: Point in the middle of the picture [m], shape (3,).
        distance: From the camera to it [m].
        azimuth: Heading of the view about world z [deg].
        elevation: Of the view above the horizontal [deg].
        field_of_view: Vertical [deg].
    """

    lookat: FloatArray
    distance: float
    azimuth: float = AZIMUTH
    elevation: float = ELEVATION
    field_of_view: float = FIELD_OF_VIEW

    @property
    def view(self) -> View:
        """What renderers take."""
        rotation = _camera_rotation(self.azimuth, self.elevation)
        pose = SE3(rotation, self.lookat + self.distance * rotation[:, 2])
        return View(pose, self.field_of_view)


def fit_viewpoint(points: FloatArray, radii: FloatArray, width: int, height: int) -> Viewpoint:
    """The overview that holds every given sphere.

    Args:
        points: Centres, shape (N, 3) [m].
        radii: Shape (N,) [m].
        width: Of the picture.
        height: Of the picture.
    """
    rotation = _camera_rotation(AZIMUTH, ELEVATION)
    local = points @ rotation
    low = (local - radii[:, None]).min(axis=0)
    high = (local + radii[:, None]).max(axis=0)
    middle = 0.5 * (low + high)
    slope = FILLED * np.tan(np.radians(FIELD_OF_VIEW) / 2.0)
    slopes = np.array([slope * width / height, slope])
    offsets = np.abs(local - middle)[:, :2] + radii[:, None]
    needed = (offsets / slopes).max(axis=1) + (local[:, 2] - middle[2])
    return Viewpoint(rotation @ middle, max(0.4, float(needed.max())))


def _camera_rotation(azimuth: float, elevation: float) -> FloatArray:
    turn, rise = np.radians([azimuth, elevation])
    back = -np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
    right = np.array([np.sin(turn), -np.cos(turn), 0.0])
    return np.stack([right, np.cross(back, right), back], axis=1)
