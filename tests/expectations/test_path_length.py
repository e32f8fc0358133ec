"""path_length: how far the TCP travels."""

import numpy as np
import pytest

from harness.expectations.path_length import PathLength
from tests.assertions.synthetic_run import heights, make_run, verdict


def test_the_path_of_the_tcp_has_a_length():
    run = make_run(tcp_pose=heights(np.linspace(0, 0.4, 200)))
    assert verdict(run, PathLength(at_most=0.41)).margin == pytest.approx(0.01)
    assert verdict(run, PathLength(at_most=0.39)).status == "failed"
    assert verdict(run, PathLength(at_most=0.41, during="gone")).status == "not reached"
