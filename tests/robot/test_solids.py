"""Shapes as Coal has them."""

import subprocess
import sys

import pytest

ALONG_AN_AXIS = """
import coal, numpy as np
box, here = coal.Box(1.0, 1.0, 1.0), coal.Transform3s(np.eye(3), np.zeros(3))
there = coal.Transform3s(np.eye(3), np.array([0.0, 0.0, 5.0]))
coal.distance(box, here, box, there, coal.DistanceRequest(), coal.DistanceResult())
"""
"""Makes Coal take boxes for larger than they are, for as long as the process lives."""

MEASURE = """
import coal, numpy as np
from harness.core.geometry import Box, Shape
from harness.robot.solids import coal_geometry

first, second = (coal_geometry(Shape(Box(size))) for size in ((0.1, 0.1, 0.08), (1.5, 0.8, 0.03)))
origin, above = (coal.Transform3s(np.eye(3), np.array([0, 0, z])) for z in (0.0, 0.15))
arguments = (first, above, second, origin) if {swapped} else (second, origin, first, above)
print(repr(coal.distance(*arguments, coal.DistanceRequest(), coal.DistanceResult())))
"""


@pytest.mark.nightly(but=["True-after other code"])
@pytest.mark.parametrize("before", ["", ALONG_AN_AXIS], ids=["first", "after other code"])
@pytest.mark.parametrize("swapped", [True, False])
def test_boxes_are_as_large_as_they_say_whatever_was_measured_first(swapped, before):
    code = before + MEASURE.format(swapped=swapped)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    # 1e-10 more where Coal inflates its boxes: 0.094999999996
    assert float(done.stdout) == pytest.approx(0.095, abs=1e-15)
