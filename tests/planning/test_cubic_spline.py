"""The cubic spline through the samples of a path, against SciPy's."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline as ReferenceSpline

from harness.planning.timing.cubic_spline import CubicSpline


@pytest.mark.parametrize("count", [2, 4, 5, 60])
@pytest.mark.parametrize("longest", [0.002, 0.05])
def test_the_spline_is_the_one_of_scipy_to_the_bit(count, longest):
    rng = np.random.default_rng(count)
    knots = np.concatenate([[0.0], np.cumsum(rng.uniform(0.001, longest, count - 1))])
    samples = np.cumsum(rng.normal(size=(count, 6)), axis=0)
    parameters = np.concatenate([rng.uniform(0, knots[-1], 200), knots])
    reference = ReferenceSpline(knots, samples)
    for order, values in enumerate(CubicSpline.through(knots, samples).evaluate(parameters)):
        assert np.array_equal(values, reference(parameters, order))


def test_three_samples_make_a_parabola():
    knots = np.array([0.0, 1.0, 3.0])
    values, slopes, bends = CubicSpline.through(knots, knots[:, None] ** 2).evaluate(
        np.array([0.5, 2.0])
    )
    assert values[:, 0] == pytest.approx([0.25, 4.0])
    assert slopes[:, 0] == pytest.approx([1.0, 4.0])
    assert bends[:, 0] == pytest.approx([2.0, 2.0])
