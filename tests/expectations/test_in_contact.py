"""in_contact: two bodies touch."""

import pytest

from harness.expectations.in_contact import InContact
from harness.expectations.never import Never
from tests.assertions import evidence_runs as shared
from tests.assertions.evidence import DRIFT, Evidence, Free, Three
from tests.assertions.synthetic_run import force, lift_run, make_run, verdict


def test_contact_counts_from_the_required_force_on():
    run = make_run(contact_forces={("left_finger", "box"): force(200, (30, 40), value=2.0)})
    spec = InContact(between=("box", "gripper"), min_force=2.0)
    answer = verdict(run, spec)
    assert (answer.status, answer.margin, answer.time) == ("passed", 0.0, pytest.approx(0.3))
    assert answer.reason.endswith("(first at t=0.300 s, 0.1 s in all, up to 2.0 N) at t=0.300 s")
    weaker = InContact(between=("box", "robot"), min_force=2.1)
    assert verdict(run, weaker).margin == pytest.approx(-0.1)
    assert verdict(run, Never(predicate=InContact(between=("box", "any")))).status == "failed"
    assert verdict(run, InContact(between=("box", "Table"))).status == "failed"
    assert verdict(run, InContact(between=("box", "ghost"))).status == "not observable"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            InContact(between=("robot", "box"), min_force=1.0),
            shared.touched(2.0),
            shared.touched(0.99),
            -0.01,
            "N",
        ),
    ),
    mutation_cases=(
        (InContact(between=("left_finger", "box"), min_force=0.5), lift_run(), "lift"),
    ),
    picture=(
        ("pick", "{between: [gripper, red_box]}"),
        ("pick", "{between: [gripper, red_box], min_force: 40 N}"),
    ),
    free_shifts=(
        Free("a harder contact is one", "in_contact", "contact_forces", "+"),
        Free(
            "it is to be true once, and was before the force had drifted away",
            "in_contact",
            "contact_forces",
            "-",
            (DRIFT,),
        ),
    ),
)
