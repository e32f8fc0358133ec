"""The camera sensor: grey or colour channels, with noise."""

from __future__ import annotations

import hashlib

import numpy as np

from harness.core.camera import Camera
from harness.core.picture_files import grey


def as_delivered(picture: np.ndarray, camera: Camera, seed: int, sample: int) -> np.ndarray:
    """The picture with the camera's channels and noise.

    One value is drawn for each pixel and added to all of its channels, as Gazebo does. The
    generator is seeded by the run's seed, the camera's name and the recorded sample: the same
    picture whichever others were taken.

    Args:
        picture: The rendered picture, RGB, shape (height, width, 3), uint8.

    Returns:
        RGB, or one channel of a grey camera, uint8.
    """
    if camera.is_grey:
        picture = grey(picture)
    if not (camera.noise_mean or camera.noise_stddev):
        return picture
    rng = np.random.default_rng(_noise_seed(camera.name, seed, sample))
    noise = rng.standard_normal(picture.shape[:2], dtype=np.float32)
    added = 255.0 * (camera.noise_mean + camera.noise_stddev * noise)
    noisy = picture + (added if camera.is_grey else added[..., None])
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def _noise_seed(camera: str, seed: int, sample: int) -> int:
    digest = hashlib.sha256(f"{seed}:{camera}:{sample}".encode()).digest()
    return int.from_bytes(digest[:8], "big")
