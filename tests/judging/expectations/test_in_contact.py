"""in_contact: two bodies touch."""

import numpy as np
import pytest

from harness.judging.expectations.collision import Collision
from harness.judging.expectations.never import Never
from harness.plugins.objects.expectations.in_contact import InContact
from tests.judging import evidence_runs as shared
from tests.judging.evidence import DRIFT, Evidence, Free, Three
from tests.judging.synthetic_run import changed, force, lift_run, make_run, verdict


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


@pytest.mark.parametrize(
    ("gap", "status"),
    [(0, "failed"), (5, "failed"), (10, "failed"), (11, "passed"), (50, "passed")],
)
@pytest.mark.parametrize("word", ["in_contact", "collision"])
def test_a_contact_is_broken_by_gaps_of_more_than_ten_milliseconds(word, gap, status):
    """200 samples of 1 ms: the arm touches the box for 20 ms, then not, again and again."""
    touching = (np.arange(200) % (20 + gap) < 20) & (np.arange(200) < 195)
    run = make_run(contact_forces={("arm_link", "box"): 3.0 * touching})
    run = changed(run, times=np.arange(200) * 0.001)
    spec = {"in_contact": InContact, "collision": Collision}[word](between=("robot", "box"))
    assert verdict(run, Never(predicate=spec, **{"for": 0.06})).status == status
    assert verdict(run, Never(predicate=spec, **{"for": 0.019})).status == "failed"
    once = changed(run, contact_forces={("arm_link", "box"): force(200, (100, 120), value=3.0)})
    assert verdict(once, Never(predicate=spec, **{"for": 0.02})).status == "passed"
    at_end = changed(run, contact_forces={("arm_link", "box"): force(200, (185, 195), value=3.0)})
    assert verdict(at_end, Never(predicate=spec, **{"for": 0.012})).status == "passed"


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


@pytest.mark.parametrize(
    ("words", "status"),
    [
        ({}, "passed"),
        ({"min_force": 1.0}, "passed"),
        ({"min_force": 3.0}, "failed"),
        ({"min_force": 3.0, "force_window": 0.0}, "passed"),
        ({"min_force": 0.5, "force_window": 0.1}, "failed"),
    ],
)
def test_a_required_force_is_a_mean_and_a_touch_is_a_sample(words, status):
    """200 samples of 1 ms: a blow of 20 N in one of them."""
    run = make_run(contact_forces={("arm_link", "box"): force(200, (100, 101), value=20.0)})
    run = changed(run, times=np.arange(200) * 0.001)
    assert verdict(run, InContact(between=("robot", "box"), **words)).status == status
