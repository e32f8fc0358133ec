"""Films are the same bytes for the same pictures."""

import numpy as np
import pytest

from harness.recording.film import encoded_film

SIZES = [(130, 98), (132, 98), (146, 98), (150, 102), (160, 98), (34, 18)]


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_pictures_of_any_size_are_encoded_to_the_same_bytes_each_time(width, height):
    rng = np.random.default_rng(1)
    frames = [rng.integers(0, 255, (height, width, 3), dtype=np.uint8) for _ in range(8)]
    assert len({encoded_film(frames, 15, (width, height)) for _ in range(12)}) == 1
