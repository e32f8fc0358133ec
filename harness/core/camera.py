"""A camera with all parameters resolved: a pinhole with square pixels, as SDF's camera sensor."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray

OPTICAL = SE3(np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]), np.zeros(3))
"""T_camera_optical: from x forward, z up to z forward, x right, y down (ROS REP 103)."""


MOST_FRAMES = 1500  # of one video up to HD: a minute at 25 Hz; fewer of larger pictures
HD = 1280 * 720  # pixels up to which limits on the number of pictures hold as they are


@dataclass(frozen=True, eq=False)
class Camera:
    """A camera that is fixed to a frame, looks along its +x axis and has +z up in the picture.

    Attributes:
        name: The name, unique in a run.
        frame: The robot link or object that carries the camera, or `world`.
        pose: The pose T_frame_camera of the camera.
        horizontal_fov: Angle between the picture's left and right edge [rad].
        width: Width of the picture [pixels].
        height: Height of the picture [pixels].
        is_grey: Whether pictures have one channel (SDF's `L8`) instead of three (`R8G8B8`).
        clip_near: Distance of the near clipping plane along the optical axis [m].
        clip_far: Distance of the far clipping plane along the optical axis [m].
        noise_mean: Mean of the Gaussian noise on every channel, as a share of full white.
        noise_stddev: Standard deviation of that noise, as a share of full white.
        update_rate: Pictures per second of simulated time; the first is taken at time 0.
        optical_frame_id: Name of the optical frame in message headers.
        jpeg_quality: Quality of compressed pictures, 1 to 100.
    """

    name: str
    frame: str
    pose: SE3 = field(default_factory=SE3.identity)
    horizontal_fov: float = 1.0471975511965976
    width: int = 640
    height: int = 480
    is_grey: bool = False
    clip_near: float = 0.01
    clip_far: float = 15.0
    noise_mean: float = 0.0
    noise_stddev: float = 0.0
    update_rate: float = 20.0
    optical_frame_id: str = ""
    jpeg_quality: int = 80

    @property
    def pictures_counted(self) -> float:
        """What one picture counts towards limits on the number of pictures: 1, more beyond HD."""
        return max(1.0, self.width * self.height / HD)

    @property
    def most_frames(self) -> int:
        """The most frames of one video; a longer run gets a lower rate."""
        return int(MOST_FRAMES / self.pictures_counted)

    @property
    def focal_length(self) -> float:
        """Focal length [pixels], the same along both axes of the picture."""
        return 0.5 * self.width / math.tan(0.5 * self.horizontal_fov)

    @property
    def vertical_fov(self) -> float:
        """Angle between the picture's upper and lower edge [rad]."""
        return 2.0 * math.atan(0.5 * self.height / self.focal_length)

    @property
    def matrix(self) -> FloatArray:
        """K of sensor_msgs/CameraInfo, shape (3, 3); the principal point is the centre.

        A pixel's index is the floor of the projected point: pixel (i, j) covers [i, i+1) x [j, j+1)
        and its ray passes through its centre.
        """
        f = self.focal_length
        return np.array([[f, 0, 0.5 * self.width], [0, f, 0.5 * self.height], [0, 0, 1.0]])

    @property
    def optical_pose(self) -> SE3:
        """T_frame_optical: z forward, x right, y down."""
        return self.pose @ OPTICAL

    def project(self, points: FloatArray) -> FloatArray:
        """Project points of the optical frame into the picture.

        Args:
            points: Points in the optical frame [m], shape (N, 3).

        Returns:
            (u, v) in pixels from the upper left corner, shape (N, 2); NaN where z <= 0.
        """
        projected = points @ self.matrix.T
        with np.errstate(divide="ignore", invalid="ignore"):
            pixels = projected[:, :2] / projected[:, 2:]
        return np.where(points[:, 2:] > 0, pixels, np.nan)
