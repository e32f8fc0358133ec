"""Captions below pictures."""

import numpy as np
import pytest
from PIL import ImageFont

from harness.plugins.cameras.caption import ELLIPSIS, SIZE, _wrapped, captioned, strip_height

FONT = ImageFont.load_default(SIZE)
LONG = "green_cylinder is not between the fingers, though the planning scene has it attached"


@pytest.mark.parametrize("lines", [1, 2, 3])
@pytest.mark.parametrize("text", ["", "pick", LONG, LONG.replace(" ", "_"), 5 * LONG])
def test_a_line_is_as_long_as_its_room_and_a_cut_is_shown(text, lines):
    rooms = [200.0] * lines
    wrapped = _wrapped(text, rooms, FONT)
    assert len(wrapped) == lines
    assert all(FONT.getlength(line) <= room for line, room in zip(wrapped, rooms, strict=True))
    whole = "".join(wrapped).replace(" ", "") == text.replace(" ", "")
    assert whole != wrapped[-1].endswith(ELLIPSIS)


def test_lines_break_between_words():
    assert _wrapped("green_cylinder is grasped", [130.0, 130.0], FONT) == [
        "green_cylinder is",
        "grasped",
    ]


def test_the_strip_hides_nothing_of_the_picture():
    rng = np.random.default_rng(3)
    pixels = rng.integers(0, 255, (120, 160, 3), np.uint8)
    for size, lines in ((13, 1), (18, 2)):
        whole = captioned(pixels, LONG, status="1.00 s  failed", size=size, lines=lines)
        assert whole.shape == (120 + strip_height(size, lines), 160, 3)
        assert (whole[:120] == pixels).all()
        assert whole[120:].std() > 10, "no letters"
