"""Cameras as files describe them, in the words of SDF's camera sensor."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from harness.language.base import Angle, Count, Name, Number, PositiveLength, Rate, SpecModel, Xyz
from harness.language.poses import Pose

if TYPE_CHECKING:
    from harness.core.camera import Camera
    from harness.core.spatial import SE3

Pixels = Annotated[Count, Field(ge=8, le=2048)]


class ImageSpec(SpecModel):
    """The size and channels of the picture."""

    width: Pixels = Field(default=640, description="The width of the picture in pixels.")
    height: Pixels = Field(default=480, description="The height of the picture in pixels.")
    format: Literal["R8G8B8", "L8"] = Field(
        default="R8G8B8", description="The channels: colour (`R8G8B8`) or grey (`L8`)."
    )


class ClipSpec(SpecModel):
    """The range of distances along the optical axis in which things are seen."""

    near: PositiveLength = Field(default=0.01, description="Nothing nearer than this is seen [m].")
    far: PositiveLength = Field(default=15.0, description="Nothing farther than this is seen [m].")

    @model_validator(mode="after")
    def _near_before_far(self) -> ClipSpec:
        if self.near >= self.far:
            raise ValueError(f"`near` ({self.near:g} m) is less than `far` ({self.far:g} m)")
        return self


class NoiseSpec(SpecModel):
    """The noise of every pixel, the same in all of its channels, from the run's seed."""

    type: Literal["gaussian", "none"] = Field(
        default="gaussian", description="The distribution of the noise."
    )
    mean: Annotated[Number, Field(ge=-1, le=1)] = Field(
        default=0.0, description="The mean as a share of full white."
    )
    stddev: Annotated[Number, Field(ge=0, le=1)] = Field(
        default=0.0, description="The standard deviation as a share of full white."
    )


class CameraFields(SpecModel):
    """Words of any camera."""

    horizontal_fov: Annotated[Angle, Field(ge=0.01, le=2.9)] = Field(
        default=1.0471975511965976,
        description="The angle between the left and right edge of the picture.",
    )
    image: ImageSpec = Field(default=ImageSpec(), description="The size and format of the picture.")
    clip: ClipSpec = Field(
        default=ClipSpec(), description="The nearest and farthest visible distance."
    )
    noise: NoiseSpec = Field(default=NoiseSpec(), description="The noise of every pixel.")
    update_rate: Annotated[Rate, Field(gt=0, le=120)] = Field(
        default=20.0, description="The number of pictures in a second of simulated time."
    )
    optical_frame_id: str = Field(
        default="",
        description="The frame in message headers; the default is `<camera>_optical_frame`.",
    )
    jpeg_quality: Annotated[Count, Field(ge=1, le=100)] = Field(
        default=80, description="The JPEG quality of compressed pictures."
    )

    def camera(self, name: str, frame: str, pose: SE3) -> Camera:
        """The camera on a frame, at T_frame_camera."""
        from harness.core.camera import Camera

        noise = self.noise if self.noise.type == "gaussian" else NoiseSpec()
        return Camera(
            name=name,
            frame=frame,
            pose=pose,
            horizontal_fov=self.horizontal_fov,
            width=self.image.width,
            height=self.image.height,
            is_grey=self.image.format == "L8",
            clip_near=self.clip.near,
            clip_far=self.clip.far,
            noise_mean=noise.mean,
            noise_stddev=noise.stddev,
            update_rate=self.update_rate,
            optical_frame_id=self.optical_frame_id or f"{name}_optical_frame",
            jpeg_quality=self.jpeg_quality,
        )


class CameraSpec(CameraFields):
    """A camera in the world, on an object or on a robot link; looks along +x of its pose."""

    name: Name = Field(description="The name of the camera, unique among the robot's cameras too.")
    pose: Pose = Field(
        default=Pose(),
        description="The pose of the camera; `frame` is `world`, a link or an object.",
    )
    look_at: Xyz | None = Field(
        default=None,
        description="The point of the same frame at which the camera looks, instead of a rotation.",
    )

    @model_validator(mode="after")
    def _one_direction(self) -> CameraSpec:
        if self.look_at is None:
            return self
        if self.pose.has_rotation:
            raise ValueError("a camera takes `look_at` or a rotation in `pose`, not both")
        if sum((a - b) ** 2 for a, b in zip(self.look_at, self.pose.xyz, strict=True)) < 1e-12:
            raise ValueError("`look_at` must not be where the camera is")
        return self

    def resolved(self) -> Camera:
        """The camera with every number known."""
        pose = self.pose.se3()
        if self.look_at is not None:
            pose = looking_at(self.pose.xyz, self.look_at)
        return self.camera(self.name, self.pose.frame, pose)


def looking_at(xyz: Xyz, target: Xyz) -> SE3:
    """A pose whose x axis points at a target, with z as far up as can be."""
    import numpy as np

    from harness.core.spatial import SE3

    forward = np.subtract(target, xyz)
    forward /= np.linalg.norm(forward)
    left = np.cross([0.0, 0.0, 1.0], forward)
    if np.linalg.norm(left) < 1e-6:  # straight up or down: the picture's right is the world's -y
        left = np.array([0.0, 1.0, 0.0])
    left /= np.linalg.norm(left)
    rotation = np.stack([forward, left, np.cross(forward, left)], axis=1)
    return SE3(rotation, np.array(xyz, dtype=float))
