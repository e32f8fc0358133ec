"""path_length: how far the TCP travels."""

import numpy as np
import pytest

from harness.plugins.paths.expectations.path_length import PathLength
from tests.judging import evidence_runs as shared
from tests.judging.evidence import AT_ONCE, Evidence, Free, Three
from tests.judging.synthetic_run import heights, make_run, verdict


def test_the_path_of_the_tcp_has_a_length():
    run = make_run(tcp_pose=heights(np.linspace(0, 0.4, 200)))
    assert verdict(run, PathLength(at_most=0.41)).margin == pytest.approx(0.01)
    assert verdict(run, PathLength(at_most=0.39)).status == "failed"
    assert verdict(run, PathLength(at_most=0.41, during="gone")).status == "not reached"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            PathLength(at_most=0.4),
            shared.travelling(0.4),
            shared.travelling(0.41),
            -0.01,
            "m",
        ),
    ),
    mutation_cases=(
        (PathLength(at_most=0.21, at_least=0.19), shared.late(tcp_pose=shared.ALONG), "late"),
    ),
    picture=(
        ("paths", "{at_most: 16.2 cm, during: straight}"),
        ("paths", "{at_most: 16.2 cm, during: bent}"),
    ),
    free_shifts=(
        Free("a path has no orientation", "path_length", "tcp_pose", "+-roll +-pitch +-yaw"),
        Free(
            "the same path elsewhere is as long",
            "path_length",
            "tcp_pose",
            "+-x +-y +-z",
            (AT_ONCE,),
        ),
    ),
)
