"""Which camera pictures expectations need, and what a picture shows, in pixels."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from harness.core.camera import Camera
from harness.judging.expectation import Expectation, Predicate
from harness.judging.placed import PlacedExpectation
from harness.judging.window import NotReached, Window, window_of
from harness.language.markers import MarkerName
from harness.recording.looks import Look
from harness.recording.run import Run

WATCH_RATE = 5.0  # [Hz], pictures of a watched camera at most: each costs 0.2 s
MOST_PICTURES = 200  # that one expectation looks at; over a longer time they are taken less often


def period(camera: Camera, window: Window) -> float:
    """Time between the pictures that watch a window [s]."""
    span = float(window.times[-1] - window.times[0])
    return max(1.0 / min(camera.update_rate, WATCH_RATE), span / MOST_PICTURES)


def looks_of_expectations(run: Run, expectations: Sequence[PlacedExpectation]) -> tuple[Look, ...]:
    """What to draw so that every expectation can be judged that reads pictures.

    The last sample of its window; with a temporal word, `for` or `within` the first one too and
    samples between them, one period apart.
    """
    cameras = {camera.name: camera for camera in run.cameras}
    found: list[Look] = []
    for placed in expectations:
        for predicate, is_watched in _predicates_in(placed.spec):
            requests = predicate.observations().pictures
            try:
                step = placed.spec.during or predicate.during or placed.step
                window = window_of(run, step) if requests else None
            except NotReached:
                continue
            for camera_name, kind in sorted(requests):
                camera = cameras.get(camera_name)
                if camera is None or window is None:
                    continue
                samples = [window.stop - 1]
                if is_watched:
                    samples = _watched(window, period(camera, window))
                found += [Look(camera_name, sample, (kind,)) for sample in samples]
    return tuple(found)


def _predicates_in(spec: Expectation) -> Iterator[tuple[Predicate, bool]]:
    """Every predicate of an expectation, and whether it is about more than the window's end."""
    if isinstance(spec, Predicate):
        yield spec, spec.for_ is not None or spec.within is not None
    for inner in spec.predicates().values():
        yield inner, True


def _watched(window: Window, every: float) -> list[int]:
    times = window.times
    due = np.arange(float(times[0]), float(times[-1]), every)
    inside = np.searchsorted(times, due - 1e-9)
    return sorted({*(window.start + inside).tolist(), window.stop - 1})


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
    import cv2

    return int(np.count_nonzero(_decoded(file, cv2.IMREAD_UNCHANGED) == label))


def _decoded(file: bytes, flags: int) -> Any:
    import cv2

    picture = cv2.imdecode(np.frombuffer(file, dtype=np.uint8), flags)
    if picture is None:
        raise ValueError("no picture that OpenCV can read")
    return picture
