"""Targets at round values, where arithmetic breaks."""

import numpy as np
import pytest

from harness.plugins.iktest import IkTest, run_ik_test
from tests.plugins.iktest.arms import OM, correct

FIRST_AXIS = 0.012  # [m]
SHOULDER = 0.0595  # [m]


def slope(x, y, z, pitch):
    """A solver that divides by the distance from the first axis along x."""
    float(y) / (float(x) - FIRST_AXIS)
    return correct(x, y, z, pitch)


def level(x, y, z, pitch):
    """A solver that divides by the tangent of the pitch."""
    1.0 / float(np.sin(pitch))
    return correct(x, y, z, pitch)


def at_the_shoulder(x, y, z, pitch):
    """A solver that divides by the height above the shoulder."""
    1.0 / (float(z) - SHOULDER)
    return correct(x, y, z, pitch)


def sideways(x, y, z, pitch):
    """A solver that takes the quotient of x and y."""
    float(x) / float(y)
    return correct(x, y, z, pitch)


@pytest.mark.parametrize("ik", [slope, level, at_the_shoulder, sideways])
def test_a_division_by_zero_on_a_plane_of_the_arm_is_found(ik):
    report = run_ik_test(IkTest(ik, OM))
    kinds = {finding.kind for finding in report.findings}
    assert any(kind.startswith("raises ZeroDivisionError at test_round") for kind in kinds)
