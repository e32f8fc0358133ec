"""sees: from the pictures that a camera took to pixels that count."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from harness.assertions.looks import period
from harness.assertions.pixels import blob_pixels, label_pixels, marker_pixels
from harness.assertions.registry import MarginSignal, Part, all_of, signal
from harness.assertions.window import NotObservable, Window
from harness.core.types import FloatArray, IntArray
from harness.recording.run import CaptureRecord, Measure
from harness.spec.checks import Sees


@signal.handles(Sees)
def sees(spec: Sees, window: Window) -> MarginSignal:
    """Pixels against `min_area`; of an object its visible share against `min_visible` too.

    Between two pictures the earlier one speaks, for one period of watching.
    """
    pictures = _pictures(spec, window)
    spoken_by = _spoken_by(spec, window, pictures)
    files = window.run.files
    subject, name = _subject(spec)
    kind = "color" if spec.object is None else "segmentation"
    pixels = [_pixels(spec, picture, files[picture.files[kind]]) for picture in pictures]
    parts = [_part(f"pixels of {name}", pixels, spoken_by, spec.min_area, "px")]
    outlines = [0] * len(pictures)
    if spec.object is not None:
        outlines = [picture.outlines.get(spec.object, 0) for picture in pictures]
        shares = [
            seen / whole if whole else 0.0 for seen, whole in zip(pixels, outlines, strict=True)
        ]
        parts.append(
            _part(
                f"visible share of {name}",
                np.minimum(shares, 1.0),
                spoken_by,
                spec.min_visible,
                "1",
            )
        )

    def text(index: int, _: Measure) -> str:
        place = int(spoken_by[index])
        if place < 0:
            return f"{spec.camera} took no picture"
        if not pixels[place]:
            return f"{spec.camera} does not see {subject}"
        of = f" of the {outlines[place]} of its outline" if outlines[place] else ""
        return f"{spec.camera} sees {pixels[place]} pixels of {subject}{of}"

    return all_of(window, parts, text, applies=spoken_by >= 0)


def _pictures(spec: Sees, window: Window) -> list[CaptureRecord]:
    """The camera's pictures within the window that the expectation can be read from."""
    kind = "color" if spec.object is None else "segmentation"
    if all(camera.name != spec.camera for camera in window.run.cameras):
        raise NotObservable(f"the record has no camera '{spec.camera}'")
    pictures = [
        capture
        for capture in window.run.captures
        if capture.camera == spec.camera
        and kind in capture.files
        and window.start <= capture.sample < window.stop
    ]
    last = window.time(window.stop - window.start - 1)
    if not pictures:
        raise NotObservable(f"{spec.camera} took no {kind} picture in the time it is judged over")
    if pictures[-1].sample != window.stop - 1:
        raise NotObservable(
            f"the last {kind} picture of {spec.camera} is of t={pictures[-1].time:.3f} s, and none"
            f" of the end at t={last:.3f} s"
        )
    if spec.object is not None and all(spec.object not in each.labels for each in pictures):
        raise NotObservable(f"the pictures know no '{spec.object}'")
    return pictures


def _spoken_by(spec: Sees, window: Window, pictures: Sequence[CaptureRecord]) -> IntArray:
    """Index of the picture that speaks for each sample of the window; -1 where none does."""
    camera = next(camera for camera in window.run.cameras if camera.name == spec.camera)
    samples = np.arange(window.start, window.stop)
    latest = np.searchsorted([each.sample for each in pictures], samples, side="right") - 1
    taken = np.array([each.time for each in pictures])
    age = window.times - taken[latest]
    return np.where((latest >= 0) & (age <= 1.01 * period(camera, window)), latest, -1)


def _subject(spec: Sees) -> tuple[str, str]:
    """What is looked for, in a sentence and as a name."""
    if spec.object is not None:
        return spec.object, spec.object
    if spec.marker is not None:
        name = f"marker {spec.marker.id} of {spec.marker.dictionary}"
        return name, name
    colour = spec.color.named if spec.color is not None and spec.color.named else "that colour"
    return f"a blob of {colour}", f"the largest {colour} blob"


def _pixels(spec: Sees, picture: CaptureRecord, file: bytes) -> int:
    if spec.object is not None:
        label = picture.labels.get(spec.object)
        return 0 if label is None else label_pixels(file, label)
    if spec.marker is not None:
        return marker_pixels(file, spec.marker)
    assert spec.color is not None  # the model has exactly one of them
    return blob_pixels(file, spec.color)


def _part(
    name: str,
    by_picture: Sequence[float] | FloatArray,
    spoken_by: IntArray,
    limit: float,
    unit: str,
) -> Part:
    values = np.asarray(by_picture, dtype=float)[spoken_by]
    return Part(name, values, limit, ">=", unit, ceiling=1.0 if unit == "1" else math.inf)
