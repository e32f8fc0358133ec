"""What a picture shows, in pixels."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false

from __future__ import annotations

import math
from typing import Any

import numpy as np

from harness.core.picture_files import decoded
from harness.plugins.cameras.keys.marker import MarkerName


def blob_pixels(
    file: bytes, hues: tuple[float, float], min_saturation: float, min_value: float
) -> int:
    """Pixels of the largest connected blob of a colour.

    Args:
        hues: From, to on the colour circle [deg].
        min_saturation: The smallest saturation, from 0 to 1.
        min_value: The smallest brightness, from 0 to 1.
    """
    import cv2

    picture = _decoded(file, cv2.IMREAD_COLOR)
    hue, saturation, value = cv2.split(
        cv2.cvtColor(picture.astype(np.float32) / 255.0, cv2.COLOR_BGR2HSV)
    )
    low, high = hues
    is_hue = (hue >= low) & (hue <= high) if low <= high else (hue >= low) | (hue <= high)
    mask = is_hue & (saturation >= min_saturation) & (value >= min_value)
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    return int(stats[1:, cv2.CC_STAT_AREA].max(initial=0))


def marker_pixels(file: bytes, marker: MarkerName) -> int:
    """Area of a detected ArUco marker [pixels]; 0 when it is not detected."""
    import cv2

    aruco = cv2.aruco
    dictionary = aruco.getPredefinedDictionary(getattr(aruco, marker.dictionary))
    detector = aruco.ArucoDetector(dictionary, aruco.DetectorParameters())
    corners, ids, _ = detector.detectMarkers(_decoded(file, cv2.IMREAD_GRAYSCALE))
    found = [] if ids is None else np.asarray(ids).ravel().tolist()
    areas = [
        cv2.contourArea(corner)
        for corner, number in zip(corners, found, strict=True)
        if number == marker.id
    ]
    return math.floor(max(areas, default=0.0))


def label_pixels(file: bytes, label: int) -> int:
    """Pixels of a label in a segmentation."""
    labels = decoded(file)
    if labels is None:
        raise ValueError("no picture that Pillow can read")
    return int(np.count_nonzero(labels == label))


def _decoded(file: bytes, flags: int) -> Any:
    import cv2

    picture = cv2.imdecode(np.frombuffer(file, dtype=np.uint8), flags)
    if picture is None:
        raise ValueError("no picture that OpenCV can read")
    return picture
