"""sees: a camera's picture shows a blob of a colour, an ArUco marker, or an object."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, field_validator

from harness.cell.scope import At
from harness.core.extras import absent_package
from harness.core.types import FloatArray, IntArray
from harness.judging.expectation import Predicate
from harness.judging.limits import refuse_decided
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.observations import Observations, PictureKind, PictureRequest
from harness.judging.window import NotObservable, Window
from harness.judging.words import HARDLY_OBSERVED
from harness.language.base import Angle, Count, Fraction, Name, Share, SpecModel
from harness.language.expectation import Quantity
from harness.plugins.cameras.keys.marker import MarkerName
from harness.plugins.cameras.known import check_camera
from harness.plugins.cameras.pixels import blob_pixels, label_pixels, marker_pixels
from harness.plugins.cameras.watched import WATCH_RATE, period
from harness.recording.signals import CaptureRecord
from harness.recording.verdict import Measure, VerdictWarning

ColorName = Literal["red", "orange", "yellow", "green", "cyan", "blue", "purple", "pink"]
HUES: dict[ColorName, tuple[float, float]] = {
    "red": (340.0, 18.0),
    "orange": (18.0, 45.0),
    "yellow": (45.0, 75.0),
    "green": (75.0, 165.0),
    "cyan": (165.0, 200.0),
    "blue": (200.0, 255.0),
    "purple": (255.0, 305.0),
    "pink": (305.0, 340.0),
}
"""From, to on the colour circle [deg]."""

Hue = Annotated[Angle, Field(ge=-2 * math.pi, le=2 * math.pi)]

PIXELS = Quantity("pixels", "px", "at least `min_area`")
LEAST_OPACITY = 0.1  # of an object that a picture can show
LEAST_PICTURES = 3  # of a window; the verdict of fewer has a warning
VISIBLE = Quantity("visible share", "1", "of an object: at least `min_visible`")


class HueRange(SpecModel):
    """Pixels of a colour: a named one, or a range of hues."""

    short = "named"
    one_of = ("named", "hue")

    named: ColorName | None = Field(
        default=None,
        description="The name of a colour. Their hues, from and to in degrees, are "
        + ", ".join(f"{name} {low:g} {high:g}" for name, (low, high) in HUES.items())
        + ". They contain the colours that objects have by these names, but for `pink`, which is a"
        " pale red there (hue 350, saturation 0.25).",
    )
    hue: tuple[Hue, Hue] | None = Field(
        default=None,
        description="The first and the last hue on the colour circle, where 0 is red, 120 deg green"
        " and 240 deg blue; `[340 deg, 20 deg]` goes through 0, `[0 deg, 360 deg]` is every hue.",
    )
    min_saturation: Annotated[Share, Field(ge=0, le=1)] = Field(
        default=0.4, description="The smallest saturation; 0 is grey, 1 the pure colour."
    )
    min_value: Annotated[Share, Field(ge=0, le=1)] = Field(
        default=0.15, description="The smallest brightness; 0 is black, 1 the brightest."
    )

    @field_validator("hue")
    @classmethod
    def _is_range(cls, value: tuple[Hue, Hue] | None) -> tuple[Hue, Hue] | None:
        if value is not None and value[0] == value[1]:
            raise ValueError("a range of hues that ends where it begins has no pixel")
        return value

    def degrees(self) -> tuple[float, float]:
        """The first and the last hue [deg], in [0, 360]."""
        if self.named is not None:
            return HUES[self.named]
        assert self.hue is not None  # the model has exactly one of them
        low, high = np.degrees(self.hue)
        return (
            (0.0, 360.0) if high - low > 360.0 - 1e-9 else (float(low % 360.0), float(high % 360.0))
        )


class Sees(Predicate):
    """A camera's picture shows a blob of a colour, an ArUco marker, or an object.

    Judged from the picture at the window's end; next to a temporal word, `for` or `within` from
    pictures all along, at the camera's `update_rate`, at most 5 a second. What happens between two
    pictures is not seen. An object whose opacity is below 0.1 is not seen: its colours differ from
    the background by less than a tenth of their range. Colours and markers need the extra
    `cameras`.
    """

    subject = "object"
    one_of = ("object", "color", "marker")
    goes_with: ClassVar[Mapping[str, tuple[str, ...]]] = {"min_visible": ("object",)}
    sentence = "camera {camera} sees[ {object}][ {color}][ {marker}]"
    quantities = (PIXELS, VISIBLE)

    camera: Name = Field(description="The name of the camera.")
    object: Name | None = Field(
        default=None,
        description="The name of an object that is looked for, by segmentation; either this,"
        " `color` or `marker` is given.",
    )
    color: HueRange | None = Field(
        default=None,
        description="The colour whose largest blob is looked for; either this, `object` or `marker`"
        " is given.",
    )
    marker: MarkerName | None = Field(
        default=None,
        description="The ArUco marker that is looked for; either this, `object` or `color` is"
        " given.",
    )
    min_area: Annotated[Count, Field(ge=1)] = Field(
        default=100, description="The least number of pixels of the object, the blob or the marker."
    )
    min_visible: Fraction = Field(
        default=0.5,
        description="The smallest share of the object's outline that nothing hides and that is in"
        " the picture.",
    )

    def check(self, at: At) -> None:
        check_camera(self.camera, at.scope, at.key("camera"))
        if camera := at.scope.cameras.get(self.camera):
            ends, of = (0.0, camera.width * camera.height), "the number of pixels"
            refuse_decided(at, "min_area", ">=", self.min_area, ends, of, "give a smaller one")
        if self.object is not None:
            at.scope.check_object(self.object, at.key("object"), simulated=True)
        elif missing := absent_package("cv2"):
            key = "color" if self.marker is None else "marker"
            at.scope.problems.add(at.key(key), f"pictures cannot be searched for it: {missing}")

    def names(self) -> frozenset[str]:
        return frozenset() if self.object is None else frozenset({self.object})

    def observations(self) -> Observations:
        return Observations(pictures=frozenset({PictureRequest(self.camera, self._kind)}))

    @property
    def _kind(self) -> PictureKind:
        return "color" if self.object is None else "segmentation"

    def signal(self, window: Window) -> MarginSignal:
        """Pixels against `min_area`; of an object its visible share against `min_visible` too.

        Between two pictures the earlier one counts, for one period of watching.
        """
        pictures = self._pictures(window)
        spoken_by = self._spoken_by(window, pictures)
        files = window.run.files
        subject, name = self._subject()
        pixels = [self._pixels(picture, files[picture.files[self._kind]]) for picture in pictures]
        opacity = self._opacity(window)
        if opacity < LEAST_OPACITY:
            pixels = [0] * len(pictures)
        parts = [_part(PIXELS, name, pixels, spoken_by, self.min_area)]
        outlines = [0] * len(pictures)
        if self.object is not None:
            outlines = [picture.outlines.get(self.object, 0) for picture in pictures]
            shares = [
                seen / whole if whole else 0.0 for seen, whole in zip(pixels, outlines, strict=True)
            ]
            visible = np.minimum(shares, 1.0)
            parts.append(_part(VISIBLE, name, visible, spoken_by, self.min_visible))
        warnings = self._few(pictures, window) + self._partly(pictures, pixels, outlines)

        def text(index: int, _: Measure) -> str:
            place = int(spoken_by[index])
            if place < 0:
                return f"{self.camera} took no picture"
            if opacity < LEAST_OPACITY:
                return f"{self.camera} sees nothing of {subject}, whose opacity is {opacity:g}"
            if not pixels[place]:
                return f"{self.camera} does not see {subject}"
            of = f" of the {outlines[place]} of its outline" if outlines[place] else ""
            return f"{self.camera} sees {pixels[place]} pixels of {subject}{of}"

        return replace(all_of(window, parts, text, applies=spoken_by >= 0), warnings=warnings)

    def _opacity(self, window: Window) -> float:
        """The largest opacity of the object's shapes; 1 of what is no object."""
        shown = [record.looks for record in window.run.objects if record.name == self.object]
        return max((shape.rgba[3] for shapes in shown for shape in shapes), default=1.0)

    def _few(self, pictures: Sequence[CaptureRecord], window: Window) -> tuple[VerdictWarning, ...]:
        """A warning where fewer than three pictures show more than a fifth of a second."""
        span = float(window.times[-1] - window.times[0])
        if len(pictures) >= LEAST_PICTURES or span <= 1.0 / WATCH_RATE:
            return ()
        count = f"{len(pictures)} picture" + "s" * (len(pictures) > 1)
        return (VerdictWarning(HARDLY_OBSERVED, f"{self.camera} took {count} in {span:.3g} s"),)

    def _partly(
        self, pictures: Sequence[CaptureRecord], pixels: Sequence[int], outlines: Sequence[int]
    ) -> tuple[VerdictWarning, ...]:
        """A warning for `never`, where a picture shows too little of an object, but something."""
        for picture, seen, whole in zip(pictures, pixels, outlines, strict=True):
            if seen >= self.min_area and whole and seen < self.min_visible * whole:
                message = (
                    f"{self.camera} sees {seen} pixels of {self.object} at t={picture.time:.3f} s,"
                    f" {100 * seen / whole:.0f} % of its outline"
                )
                return (VerdictWarning("partly seen", message),)
        return ()

    def _pictures(self, window: Window) -> list[CaptureRecord]:
        """The camera's pictures within the window that the expectation can be read from."""
        kind = self._kind
        if all(camera.name != self.camera for camera in window.run.cameras):
            raise NotObservable(f"the record has no camera '{self.camera}'")
        pictures = [
            capture
            for capture in window.run.captures
            if capture.camera == self.camera
            and kind in capture.files
            and window.start <= capture.sample < window.stop
        ]
        last = window.time(window.stop - window.start - 1)
        if not pictures:
            raise NotObservable(
                f"{self.camera} took no {kind} picture in the time it is judged over"
            )
        if pictures[-1].sample != window.stop - 1:
            raise NotObservable(
                f"the last {kind} picture of {self.camera} is of t={pictures[-1].time:.3f} s, and"
                f" none of the end at t={last:.3f} s"
            )
        if self.object is not None and all(self.object not in each.labels for each in pictures):
            raise NotObservable(f"the pictures know no '{self.object}'")
        return pictures

    def _spoken_by(self, window: Window, pictures: Sequence[CaptureRecord]) -> IntArray:
        """Index of the picture that represents each sample of the window; -1 where none does."""
        camera = next(camera for camera in window.run.cameras if camera.name == self.camera)
        samples = np.arange(window.start, window.stop)
        latest = np.searchsorted([each.sample for each in pictures], samples, side="right") - 1
        taken = np.array([each.time for each in pictures])
        age = window.times - taken[latest]
        return np.where(age <= 1.01 * period(camera, window), latest, -1)

    def _subject(self) -> tuple[str, str]:
        """What is looked for, in a sentence and as a name."""
        if self.object is not None:
            return self.object, self.object
        if self.marker is not None:
            name = f"marker {self.marker.id} of {self.marker.dictionary}"
            return name, name
        colour = self.color.named if self.color is not None and self.color.named else "that colour"
        return f"a blob of {colour}", f"the largest {colour} blob"

    def _pixels(self, picture: CaptureRecord, file: bytes) -> int:
        if self.object is not None:
            label = picture.labels.get(self.object)
            return 0 if label is None else label_pixels(file, label)
        if self.marker is not None:
            return marker_pixels(file, self.marker)
        assert self.color is not None  # the model has exactly one of them
        colour = self.color
        return blob_pixels(file, colour.degrees(), colour.min_saturation, colour.min_value)


def _part(
    quantity: Quantity,
    subject: str,
    by_picture: Sequence[float] | FloatArray,
    spoken_by: IntArray,
    limit: float,
) -> Part:
    values = np.asarray(by_picture, dtype=float)[spoken_by]
    ceiling = 1.0 if quantity is VISIBLE else math.inf
    name = f"{quantity.name} of {subject}"
    return Part(quantity, values, limit, ">=", ceiling=ceiling, measured_name=name)
