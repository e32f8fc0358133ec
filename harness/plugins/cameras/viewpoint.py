"""Views of pictures: overviews that contain given spheres, and views of cameras."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.camera import Camera
from harness.core.spatial import SE3
from harness.core.types import FloatArray

AZIMUTH, ELEVATION = 146.0, -24.0  # [deg]: from the front right of a robot that faces +x
FIELD_OF_VIEW = 38.0  # [deg], vertical
FILLED = 0.86  # share of the picture that the fitted spheres may fill
CLOSEST = 0.4  # [m] from what is seen


@dataclass(frozen=True, eq=False)
class View:
    """The camera of a renderer: a pinhole with square pixels.

    Attributes:
        pose: T_world_camera in OpenGL's convention: x right, y up, looks along -z.
        field_of_view: Vertical field of view [deg].
        near: Distance of the near clipping plane [m].
        far: Distance of the far clipping plane [m].
    """

    pose: SE3
    field_of_view: float
    near: float = 0.01
    far: float = 60.0


FLIP = SE3(np.diag([1.0, -1.0, -1.0]), np.zeros(3))  # T_optical_opengl: y and z are reversed


def view_of(camera: Camera, carrier: SE3) -> View:
    """The view of a camera.

    Args:
        carrier: T_world_frame of the camera's frame.
    """
    pose = carrier @ camera.optical_pose @ FLIP
    return View(pose, np.degrees(camera.vertical_fov), camera.clip_near, camera.clip_far)


@dataclass(frozen=True, eq=False)
class Viewpoint:
    """A perspective camera in the parameters of MuJoCo's free camera.

    Attributes:
        lookat: Point in the middle of the picture [m], shape (3,).
        distance: Distance from the camera to `lookat` [m].
        azimuth: Heading of the view about world z [deg].
        elevation: Elevation of the view above the horizontal [deg].
        field_of_view: Vertical field of view [deg].
    """

    lookat: FloatArray
    distance: float
    azimuth: float = AZIMUTH
    elevation: float = ELEVATION
    field_of_view: float = FIELD_OF_VIEW

    @property
    def view(self) -> View:
        """The same camera for renderers."""
        rotation = _camera_rotation(self.azimuth, self.elevation)
        pose = SE3(rotation, self.lookat + self.distance * rotation[:, 2])
        return View(pose, self.field_of_view)


def fit_viewpoint(points: FloatArray, radii: FloatArray, width: int, height: int) -> Viewpoint:
    """The overview that contains all given spheres.

    Args:
        points: Centres of the spheres, shape (N, 3) [m].
        radii: Radii of the spheres, shape (N,) [m].
        width: Width of the picture [pixels].
        height: Height of the picture [pixels].
    """
    rotation = _camera_rotation(AZIMUTH, ELEVATION)
    local = points @ rotation
    slope = FILLED * np.tan(np.radians(FIELD_OF_VIEW) / 2.0)
    slopes = np.array([slope * width / height, slope])
    reach = radii[:, None] + slopes * local[:, 2:]
    high, low = (reach + local[:, :2]).max(axis=0), (reach - local[:, :2]).max(axis=0)
    centre = 0.5 * (high - low)  # where the farthest spheres of both sides touch the edges
    depth = 0.5 * (local[:, 2].min() + local[:, 2].max())
    distance = float((0.5 * (high + low) / slopes).max()) - depth
    return Viewpoint(rotation @ np.array([*centre, depth]), max(CLOSEST, distance))


def _camera_rotation(azimuth: float, elevation: float) -> FloatArray:
    turn, rise = np.radians([azimuth, elevation])
    back = -np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
    right = np.array([np.sin(turn), -np.cos(turn), 0.0])
    return np.stack([right, np.cross(back, right), back], axis=1)
