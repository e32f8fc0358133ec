"""duration: simulated seconds of a step or of the run."""

import pytest

from harness.judging.expectations.duration import DurationCheck
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Three
from tests.judging.synthetic_run import make_run, step, verdict


def test_durations_of_steps_and_runs():
    run = make_run(steps=(step("move", 0, 101), step("broken", 100, 150, status="failed")))
    assert verdict(run, DurationCheck(at_most=1.0), "move").margin == pytest.approx(0.0)
    late = verdict(run, DurationCheck(at_most=0.99), "move")
    assert late.status == "failed"
    assert " at t=" not in late.reason, "a duration is no moment"
    assert verdict(run, DurationCheck(at_least=1.5)).margin == pytest.approx(0.49)
    assert verdict(run, DurationCheck(at_most=5), "broken").status == "not reached"
    early = make_run(ended_early="GOAL_IN_COLLISION")
    assert verdict(early, DurationCheck(at_most=5)).status == "not reached"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            DurationCheck(at_most=0.5),
            shared.lasting(49),
            shared.lasting(51),
            -0.01,
            "s",
            during="move",
        ),
    ),
    mutation_cases=((DurationCheck(at_most=1.0, at_least=0.9), shared.late(), "late"),),
    picture=(
        ("pick", "{at_most: 2 s, during: lift}"),
        ("pick", "{at_most: 0.8 s, during: lift}"),
    ),
)
