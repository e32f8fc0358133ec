from typing import get_args, get_origin

import numpy as np
import pytest

from harness.core.types import BoolArray, FloatArray, IntArray
from harness.recording.plain import from_plain


@pytest.mark.parametrize(
    ("kind", "element"), [(FloatArray, np.float64), (IntArray, np.int64), (BoolArray, np.bool_)]
)
def test_readers_of_records_know_an_array_by_its_class_in_every_numpy(kind, element):
    assert get_origin(kind) is np.ndarray
    _shape, numbers = get_args(kind)
    assert get_args(numbers) == (element,)
    assert from_plain([[1.0, 2.0]], kind).shape == (1, 2)
