"""What was measured of each pair, joined and refined: small arrays, worked out by hand."""

import numpy as np
import pytest

from harness.session.observation.measured_clearance import MeasuredClearance

NAN = np.nan
BOX, CUP = ("robot", "box"), ("robot", "cup")


def measured(count, **pairs):
    """Pairs as name -> (rows, distances, links or None, travels)."""
    found = MeasuredClearance(count)
    for name, (rows, distances, links, travels) in pairs.items():
        found.put(
            ("robot", name),
            np.array(rows),
            np.array(distances, dtype=float),
            None if links is None else np.array(links),
            np.array(travels, dtype=float),
        )
    return found


def test_a_pair_is_absent_until_it_is_set():
    found = measured(4, box=([1, 3], [0.1, 0.3], [7, 8], [0.01, 0.02]))
    np.testing.assert_array_equal(found.distances[BOX], [NAN, 0.1, NAN, 0.3])
    assert found.links[BOX].tolist() == [-1, 7, -1, 8]
    assert found.travels[BOX].tolist() == [0, 0.01, 0, 0.02]
    found.put(BOX, np.array([0]), np.array([0.5]), None, np.array([0.0]))
    np.testing.assert_array_equal(found.distances[BOX], [0.5, 0.1, NAN, 0.3])
    assert found.links[BOX].tolist() == [-1, 7, -1, 8]
    assert measured(2, box=([0], [0.1], None, [0.0])).links == {}


def test_parts_share_the_sample_between_them():
    """The first sample of each part but the first is the last one of the part before it."""
    parts = [
        measured(3, box=([0, 1, 2], [1, 2, 3], [4, 5, 6], [0, 0.1, 0.2])),
        measured(2, box=([0, 1], [9, 4], [9, 7], [9, 0.3])),
        measured(3, cup=([0, 1, 2], [9, 6, 7], None, [9, 0.4, 0.5])),
    ]
    whole = MeasuredClearance.joined(parts)
    assert whole.count == 6
    np.testing.assert_array_equal(whole.distances[BOX], [1, 2, 3, 4, NAN, NAN])
    np.testing.assert_array_equal(whole.distances[CUP], [NAN, NAN, NAN, NAN, 6, 7])
    assert whole.links[BOX].tolist() == [4, 5, 6, 7, -1, -1]
    assert CUP not in whole.links
    assert whole.travels[BOX].tolist() == [0, 0.1, 0.2, 0.3, 0, 0]
    assert whole.travels[CUP].tolist() == [0, 0, 0, 0, 0.4, 0.5]


def test_further_samples_are_merged_and_their_travel_where_they_follow_each_other():
    """Measured at 0, 5 and 10; then at 4, 5, 6 and 8. The travel at 8 is since 6, not since 7."""
    found = measured(
        3,
        box=([0, 1, 2], [1.0, 2.0, 3.0], [1, 2, 3], [0, 0.5, 0.6]),
        cup=([0, 1, 2], [5.0, 6.0, 7.0], [1, 1, 1], [0, 0.1, 0.2]),
    )
    finer = measured(4, box=([0, 1, 2, 3], [1.8, 2.1, 2.2, 2.6], [4, 5, 6, 7], [0, 0.3, 0.4, 0.9]))
    samples = found.refined(finer, np.array([0, 5, 10]), np.array([4, 5, 6, 8]))
    assert samples.tolist() == [0, 4, 5, 6, 8, 10]
    assert found.count == 6
    assert found.distances[BOX].tolist() == [1.0, 1.8, 2.1, 2.2, 2.6, 3.0]
    np.testing.assert_array_equal(found.distances[CUP], [5.0, NAN, NAN, NAN, NAN, 7.0])
    assert found.links[BOX].tolist() == [1, 4, 5, 6, 7, 3]
    assert found.links[CUP].tolist() == [1, -1, -1, -1, -1, 1]
    assert found.travels[BOX].tolist() == [0, 0, 0.3, 0.4, 0, 0.6]
    assert found.travels[CUP].tolist() == [0, 0, 0.1, 0, 0, 0.2]


@pytest.mark.parametrize("first", [0, 1])
def test_the_first_of_the_further_samples_follows_none(first):
    found = measured(2, box=([0, 1], [1.0, 2.0], None, [0, 0.5]))
    finer = measured(2, box=([0, 1], [1.1, 1.2], None, [0.7, 0.1]))
    found.refined(finer, np.array([0, 5]), np.array([first, first + 1]))
    assert found.travels[BOX][first] == 0


def test_a_distance_may_dip_by_half_of_what_the_bodies_move_beyond_its_change():
    found = measured(4, box=([0, 1, 2, 3], [1.0, 1.0, 0.4, NAN], None, [9, 0.2, 0.8, 0.5]))
    assert found.dips()[BOX] == pytest.approx([0.1, 0.1, 0.0])
