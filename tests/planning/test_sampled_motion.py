"""States along a polyline."""

import numpy as np
import pytest

from harness.planning.collision.sampled_motion import COUNTED_RESOLUTION, SampledMotion

METRIC = np.array([1.0, 3.0])
PATH = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.0], [0.1, 0.05], [0.4, 0.45]])


@pytest.mark.parametrize("resolution", [0.013, 0.05, 10.0])
def test_states_are_at_most_as_far_apart_as_requested_and_at_every_corner(resolution):
    motion = SampledMotion.of(PATH, METRIC, resolution)
    states = np.array([motion.state(number) for number in range(motion.last + 1)])
    steps = np.linalg.norm(np.diff([PATH[0], *states], axis=0) * METRIC, axis=1)
    assert steps.max() <= min(resolution, motion.spacing) * (1 + 1e-9)
    assert (
        len(states) < np.linalg.norm(np.diff(PATH, axis=0) * METRIC, axis=1).sum() / resolution + 5
    )
    for number, corner in zip(motion.places[1:], PATH[1:], strict=True):
        assert states[int(number)] == pytest.approx(corner, abs=1e-12)
    rows = [motion.row(number) for number in range(motion.last + 1)]
    assert np.all(np.diff(rows) > 0)
    assert rows[-1] == len(PATH) - 1
    for row, state in zip(rows, states, strict=True):
        columns = [np.interp(row, np.arange(len(PATH)), column) for column in PATH.T]
        assert state == pytest.approx(columns, abs=1e-12)


def test_a_motion_without_length_is_one_state():
    motion = SampledMotion.of(PATH[[1, 1]], METRIC, 0.01)
    assert (motion.last, motion.counted, motion.spacing) == (0, 1, 0.0)
    assert motion.state(0).tolist() == PATH[1].tolist()


def test_states_of_fine_motions_are_counted_at_a_fixed_distance():
    ends = np.array([[0.0, 0.0], [1.0, 0.0]])
    for resolution, count in ((0.1, 10), (1 / 16, 16), (COUNTED_RESOLUTION, 32), (1e-5, 32)):
        assert SampledMotion.of(ends, METRIC, resolution).counted == count
