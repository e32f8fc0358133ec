"""clearance: the distance between two bodies, against a limit or against the plan."""

from dataclasses import replace

import numpy as np
import pytest

from harness.judging.expectations.never import Never
from harness.plugins.arms.expectations.clearance import Clearance
from harness.reporting.margins import margin_share
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import (
    BOX,
    ROBOT,
    TABLE,
    attachment,
    changed,
    make_run,
    step,
    thing,
    verdict,
)


def clearance_run(distance, cutoff=0.15, **changes):
    return make_run(
        clearances={("robot", "box"): np.asarray(distance), ("robot", "Table"): np.full(200, 0.1)},
        clearance_links={("robot", "box"): np.full(200, 2), ("robot", "Table"): np.full(200, -1)},
        clearance_cutoff=cutoff,
        **changes,
    )


def test_clearance_names_the_nearest_link_and_the_moment():
    distance = np.full(200, 0.15)
    distance[70] = 0.012
    spec = Clearance(between=("robot", "box"), at_least=0.01)
    answer = verdict(clearance_run(distance), spec)
    assert answer.status == "passed"
    assert answer.margin == pytest.approx(0.002)
    assert answer.reason == "12.0 mm between arm_link and box, 10.0 mm required at t=0.700 s"
    nearer = Clearance(between=("box", "robot"), at_least=0.0121)
    assert verdict(clearance_run(distance), nearer).status == "failed"


def test_the_nearest_link_is_that_of_the_sample_within_its_step():
    distance = np.full(200, 0.15)
    distance[70] = 0.012
    run = clearance_run(distance)
    links = np.full(200, ROBOT.link_names.index("palm"))
    links[70] = ROBOT.link_names.index("arm_link")
    run = changed(run, clearance_links={("robot", "box"): links})
    run = replace(run, steps=(step("near", 60, 100),))
    reason = verdict(run, Clearance(between=("robot", "box"), at_least=0.01), "near").reason
    assert reason == "12.0 mm between arm_link and box, 10.0 mm required at t=0.700 s"


def test_without_a_nearest_link_the_pair_is_named_as_it_was_recorded():
    clearances = {("box", "Table"): np.full(200, 0.05), ("robot", "robot"): np.full(200, 0.04)}
    held = (attachment("box", 0, 200),)
    run = make_run(clearances=clearances, clearance_cutoff=0.15, attachments=held)
    for between, pair in (
        (("box", "Table"), "box and Table"),
        (("robot", "robot"), "robot and its"),
    ):
        reason = verdict(run, Clearance(between=between, at_least=0.01)).reason
        assert f"mm between {pair}" in reason


def test_a_distance_may_be_little_less_than_with_the_arm_at_its_commands():
    planned, actual = np.full(200, 0.02), np.full(200, 0.02)
    actual[90] = 0.0175
    run = clearance_run(actual)
    spec = Clearance(between=("robot", "box"), max_below_plan=0.003)
    assert verdict(run, spec).status == "not observable", "the plan was not recorded"
    run = changed(run, planned_clearances={("robot", "box"): planned})
    assert verdict(run, spec).margin == pytest.approx(0.0005)
    answer = verdict(run, Clearance(between=("robot", "box"), max_below_plan=0.002))
    assert (answer.status, answer.margin) == ("failed", pytest.approx(-0.0005))
    assert answer.reason == (
        "17.5 mm between robot and box, planned 20.0 mm: 2.5 mm less, 2.0 mm allowed at t=0.900 s"
    )
    both = Clearance(between=("robot", "box"), at_least=0.018, max_below_plan=0.003)
    assert verdict(run, both).reason.startswith("17.5 mm between arm_link and box, 18.0 mm req")
    lost = changed(run, clearances={("robot", "box"): np.full(200, np.nan)})
    assert verdict(lost, spec).status == "not observable"
    gone = replace(lost, objects=(TABLE, replace(BOX, present=())))
    assert verdict(gone, spec).status == "not reached"
    unknown = changed(run, planned_clearances={("robot", "box"): np.full(200, np.nan)})
    assert verdict(unknown, spec).status == "failed"


def test_clearance_is_judged_while_the_object_is_there():
    distance = np.full(200, np.nan)
    spec = Clearance(between=("robot", "box"), at_least=0.01)
    never_there = (TABLE, replace(BOX, present=()))
    absent = verdict(clearance_run(distance, objects=never_there), spec)
    assert absent.status == "not reached"
    assert absent.reason == "robot and box were never there together"
    distance[50:60] = 0.02
    there = clearance_run(distance, objects=(TABLE, replace(BOX, present=((0.5, 0.59),))))
    assert verdict(there, spec).status == "passed"
    assert verdict(there, Never(predicate=spec)).status == "failed"


def test_a_distance_that_is_lost_for_a_while_leaves_clearance_unknown():
    distance = np.full(200, 0.02)
    distance[50:80] = np.nan
    spec = Clearance(between=("robot", "box"), at_least=0.01)
    assert verdict(clearance_run(distance), spec).status == "not observable"
    distance[120] = 0.005
    assert verdict(clearance_run(distance), spec).status == "failed"
    nearest = Clearance(between=("robot", "any"), at_least=0.01)
    assert verdict(clearance_run(distance), nearest).status == "failed"
    held = clearance_run(
        distance[:120].tolist() + [0.02] * 80,
        attachments=[attachment("box", 49, 81, is_welded=True)],
    )
    assert verdict(held, spec).status == "passed", "a held box has no distance to the robot"


def test_clearance_beyond_the_cutoff_cannot_be_seen():
    spec = Clearance(between=("robot", "box"), at_least=0.2)
    assert verdict(clearance_run(np.full(200, 0.15)), spec).status == "not observable"
    assert verdict(clearance_run(np.full(200, 0.14)), spec).status == "failed"
    assert verdict(make_run(), spec).status == "not observable"
    same = Clearance(between=("robot", "box"), at_least=0.15)
    answer = verdict(clearance_run(np.full(200, 0.15)), same)
    assert answer.status == "passed"
    assert "at least 150 mm" in answer.reason


def test_any_object_is_the_nearest_but_for_what_the_robot_holds():
    distance = np.where(np.arange(200) < 50, 0.08, 0.0)
    spec = Clearance(at_least=0.05)
    believed = clearance_run(distance, attachments=[attachment("box", 50, 250)])
    assert verdict(believed, spec).status == "failed", "the planning scene alone holds it"
    run = clearance_run(distance, attachments=[attachment("box", 50, 250, is_welded=True)])
    answer = verdict(run, spec)
    assert answer.status == "passed"
    assert answer.margin == pytest.approx(0.03)
    assert verdict(clearance_run(distance), spec).status == "failed"


def test_a_held_object_is_found_under_both_of_its_names():
    stand_in = thing("stand_in", physics=False)
    held = attachment("stand_in", 50, 200, represents="box")
    key = ("stand_in", "Table")
    run = make_run(
        objects=(TABLE, BOX, stand_in),
        attachments=[held],
        clearances={key: np.where(np.arange(200) < 50, np.nan, 0.006)},
    )
    spec = Clearance(between=("box", "Table"), at_least=0.005)
    assert verdict(run, spec).margin == pytest.approx(0.001)
    unheld = make_run(objects=(TABLE, BOX, stand_in))
    assert verdict(unheld, spec).status == "not reached"


@pytest.mark.parametrize("at_least", [0.14, 0.05])
def test_a_distance_that_was_recorded_as_at_least_that_far_has_the_largest_margin(at_least):
    far = make_run(clearances={("robot", "box"): np.full(200, 0.15)})
    answer = verdict(far, Clearance(between=("robot", "box"), at_least=at_least))
    assert (answer.status, margin_share(answer)) == ("passed", 1.0)
    near = make_run(clearances={("robot", "box"): np.full(200, 0.10)})
    answer = verdict(near, Clearance(between=("robot", "box"), at_least=0.05))
    assert margin_share(answer) == pytest.approx(0.5)


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Clearance(between=("robot", "box"), at_least=0.01),
            shared.near(0.05),
            shared.near(0.0099),
            -1e-4,
            "m",
            replace(shared.near(np.nan), objects=(TABLE, replace(BOX, present=()))),
        ),
    ),
    mutation_cases=(
        (
            Clearance(between=("robot", "box"), at_least=0.01),
            shared.late(clearances={("robot", "box"): shared.DISTANT}),
            "late",
        ),
        (
            Clearance(between=("robot", "box"), max_below_plan=0.01),
            shared.late(
                clearances={("robot", "box"): shared.DISTANT},
                planned_clearances={("robot", "box"): np.full(shared.N, 0.055)},
            ),
            "late",
        ),
    ),
    picture=(
        ("pick", "{between: [robot, post], at_least: 4 cm}"),
        ("pick", "{between: [robot, post], at_least: 8 cm}"),
    ),
    free_shifts=(
        Free("further away is clear", "clearance, clearance 2", "clearances", "+"),
        Free("less was planned than there was", "clearance 2", "planned_clearances", "-"),
    ),
)
