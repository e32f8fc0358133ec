"""Colours of a picture: every hue has one name, up to its two ends."""

import cv2
import numpy as np
import pytest

from harness.plugins.cameras.expectations.sees import HUES, HueRange
from harness.plugins.cameras.pixels import blob_pixels

STATED = {
    "red": [*range(340, 360), *range(18)],
    "orange": range(18, 45),
    "yellow": range(45, 75),
    "green": range(75, 165),
    "cyan": range(165, 200),
    "blue": range(200, 255),
    "purple": range(255, 305),
    "pink": range(305, 340),
}
"""Whole degrees of each colour, as a colour wheel is divided."""


def picture_of(hue, saturation=1.0, value=1.0, size=(6, 8)):
    """A PNG of one colour, by the definition of hue, saturation and value."""
    sector, part = divmod(hue / 60.0, 1.0)
    low, falling, rising = (value * (1 - saturation * share) for share in (1.0, part, 1.0 - part))
    red, green, blue = [
        (value, rising, low), (falling, value, low), (low, value, rising),
        (low, falling, value), (rising, low, value), (value, low, falling),
    ][int(sector) % 6]  # fmt: skip
    pixels = np.round(255 * np.array([blue, green, red])).astype(np.uint8)
    return cv2.imencode(".png", np.broadcast_to(pixels, (*size, 3)).copy())[1].tobytes()


def test_the_colours_divide_the_circle_as_they_are_stated():
    found = {name: [] for name in HUES}
    for degree in range(360):
        file = picture_of(degree + 0.5)
        names = [name for name in HUES if blob_pixels(file, HueRange(named=name).degrees(), 0, 0)]
        assert len(names) == 1, (degree, names)
        found[names[0]].append(degree)
    assert {name: sorted(each) for name, each in found.items()} == {
        name: sorted(each) for name, each in STATED.items()
    }


@pytest.mark.parametrize(
    ("saturation", "value", "seen"),
    [(0.41, 0.9, 48), (0.39, 0.9, 0), (1.0, 0.16, 48), (1.0, 0.14, 0)],
)
def test_pale_and_dark_pixels_do_not_count(saturation, value, seen):
    colour = HueRange(named="blue")
    file = picture_of(220, saturation, value)
    assert blob_pixels(file, colour.degrees(), colour.min_saturation, colour.min_value) == seen


def test_only_the_largest_blob_counts_and_corners_connect():
    pixels = np.zeros((8, 8, 3), dtype=np.uint8)
    pixels[0:2, 0:2, 2] = pixels[2:4, 2:4, 2] = 255  # red, joined at a corner
    pixels[6, 6, 2] = 255
    file = cv2.imencode(".png", pixels)[1].tobytes()
    assert blob_pixels(file, (340.0, 18.0), 0.4, 0.15) == 8


@pytest.mark.parametrize(
    ("hues", "is_seen"),
    [((120, 130), True), ((110, 120), True), ((121, 130), False), ((110, 119), False)],
)
def test_the_ends_of_a_range_of_hues_belong_to_it(hues, is_seen):
    """Pure green has a hue of 120 degrees."""
    picture = np.zeros((4, 5, 3), np.uint8)
    picture[:, :, 1] = 255
    file = cv2.imencode(".png", picture)[1].tobytes()
    assert blob_pixels(file, hues, 0.5, 0.5) == 20 * is_seen
    assert blob_pixels(file, hues[::-1], 0.5, 0.5) == 20 * (not is_seen or 120 in hues)
