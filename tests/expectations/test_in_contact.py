"""in_contact: two bodies touch."""

import pytest

from harness.expectations.in_contact import InContact
from harness.expectations.never import Never
from tests.assertions.synthetic_run import force, make_run, verdict


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
