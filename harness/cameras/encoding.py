"""Pictures as files: PNG, JPEG, depth arrays, and previews that people can look at."""

from __future__ import annotations

import io

import cv2
import numpy as np

from harness.core.camera import Camera
from harness.recording.arrays import write_npz


def png(picture: np.ndarray) -> bytes:
    """A picture, RGB or of one channel, as a PNG file."""
    return _encoded(".png", picture, [cv2.IMWRITE_PNG_COMPRESSION, 3])


def jpeg(picture: np.ndarray, camera: Camera) -> bytes:
    """A picture, RGB or of one channel, as a JPEG file of the camera's quality."""
    return _encoded(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, camera.jpeg_quality])


def _encoded(suffix: str, picture: np.ndarray, options: list[int]) -> bytes:
    channels_of_opencv = picture[:, :, ::-1] if picture.ndim == 3 else picture
    done, content = cv2.imencode(suffix, np.ascontiguousarray(channels_of_opencv), options)
    if not done:
        raise RuntimeError(f"OpenCV cannot write {suffix} files here")
    return content.tobytes()


def npz(depth: np.ndarray) -> bytes:
    """An .npz file of the array `depth`, float32, with equal bytes for equal depths."""
    stream = io.BytesIO()
    write_npz(stream, {"depth": depth.astype(np.float32)})
    return stream.getvalue()


def depth_colours(depth: np.ndarray) -> np.ndarray:
    """Near is bright, far dark, nothing black; in steps of equal ratio; RGB."""
    seen = np.isfinite(depth)
    ratio = np.log(np.where(seen, np.maximum(depth, 1e-3), 1.0))
    low, high = (ratio[seen].min(), ratio[seen].max()) if seen.any() else (0.0, 1.0)
    share = np.clip((high - ratio) / max(high - low, 1e-9), 0, 1)
    grey = np.where(seen, 30 + 225 * share, 0).astype(np.uint8)
    colours = cv2.applyColorMap(grey, cv2.COLORMAP_VIRIDIS)[:, :, ::-1]
    return np.where(seen[:, :, None], colours, 0).astype(np.uint8)


def label_colours(labels: np.ndarray) -> np.ndarray:
    """A colour for each label, far from its neighbours'; nothing is black; RGB."""
    hues = (np.arange(int(labels.max()) + 1) * 0.618034) % 1.0
    hsv = np.stack([hues * 179, np.full_like(hues, 170), np.full_like(hues, 235)], axis=1)
    palette = cv2.cvtColor(hsv.astype(np.uint8)[None], cv2.COLOR_HSV2RGB)[0]
    palette[0] = 0
    return palette[labels]
