"""effort: joint efforts stay below a share of their limits."""

import numpy as np
import pytest

from harness.expectations.effort import Effort
from tests.assertions import evidence_runs as shared
from tests.assertions.evidence import Evidence, Three
from tests.assertions.synthetic_run import make_run, verdict


def positions(shoulder, finger=0.0):
    return np.tile([shoulder, finger], (200, 1))


def test_effort_is_a_share_of_the_limit():
    run = make_run(joint_efforts=positions(-5.0))
    assert verdict(run, Effort(max_fraction=0.6)).margin == pytest.approx(0.1)
    assert verdict(run, Effort(max_fraction=0.4)).status == "failed"
    assert verdict(run, Effort(during="gone")).status == "not reached"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Effort(max_fraction=0.5), make_run(), shared.with_joint(joint_efforts=5.05), -0.005, "1"
        ),
    ),
    mutation_cases=((Effort(max_fraction=0.5), shared.late(**shared.MOVING), "late"),),
    picture=(("pick", "0.9"), ("wall", "0.9")),
)
