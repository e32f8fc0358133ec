"""path_efficiency: how direct the TCP's way is."""

import numpy as np
import pytest

from harness.plugins.smoothness.expectations.path_efficiency import PathEfficiency
from tests.judging import evidence_runs as shared
from tests.judging.evidence import AT_ONCE, Evidence, Free, Three
from tests.judging.synthetic_run import heights, make_run, verdict


def there_and_back(share):
    """A run in which the TCP goes up and some of the way back, with that efficiency."""
    back = (1 - share) / (1 + share)
    ways = [np.linspace(0, 0.5, 101)[:-1], np.linspace(0.5, 0.5 - 0.5 * back, 100)]
    return make_run(tcp_pose=heights(np.concatenate(ways)))


EVIDENCE = Evidence(
    three_runs=(
        Three(
            PathEfficiency(at_least=0.8),
            there_and_back(0.9),
            there_and_back(0.79),
            -0.01,
            "1",
            make_run(),
        ),
    ),
    mutation_cases=((PathEfficiency(at_least=0.9), shared.late(tcp_pose=shared.ALONG), "late"),),
    free_shifts=(
        Free("a way has no orientation", "path_efficiency", "tcp_pose", "+-roll +-pitch +-yaw"),
        Free("the same way elsewhere", "path_efficiency", "tcp_pose", "+-x +-y +-z", (AT_ONCE,)),
        Free("a steady drift of a steady line is one", "path_efficiency", "tcp_pose", "+-x +-y"),
        Free("a faster or slower line is one, either way", "path_efficiency", "tcp_pose", "+-z"),
    ),
)


@pytest.mark.parametrize("corners", [1, 2, 7])
def test_half_a_circle_of_straight_pieces_has_its_diameter_over_its_way(corners):
    angles = np.linspace(0, np.pi, corners + 2)
    edge = np.repeat(0.1 * np.cos(angles), 200 // len(angles))
    height = np.repeat(0.1 * np.sin(angles), 200 // len(angles))
    poses = heights(height)
    poses[:, 0] = edge
    run = make_run(len(poses), objects=(), tcp_pose=poses)
    way = (corners + 1) * 2 * np.sin(np.pi / (2 * (corners + 1)))
    answer = verdict(run, PathEfficiency(at_least=0.1))
    assert answer.measures[0].value == pytest.approx(2 / way)
