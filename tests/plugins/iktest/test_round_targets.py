"""Targets at round values, where arithmetic breaks."""

import numpy as np
import pytest

from harness.plugins.iktest import IkTest, run_ik_test
from harness.plugins.iktest.search import draw
from harness.plugins.iktest.strategies.positions import load_chain
from harness.plugins.iktest.strategies.round_poses import round_reachable_poses
from harness.plugins.iktest.strategies.tasks import miss, natural_task
from tests.plugins.iktest.arms import OM, correct

FIRST_AXIS = 0.012  # [m]
SHOULDER = 0.0595  # [m]


def slope(x, y, z, pitch):
    """A solver that divides by the distance from the first axis along x."""
    float(y) / (float(x) - FIRST_AXIS)
    return correct(x, y, z, pitch)


def level(x, y, z, pitch):
    """A solver that divides by the tangent of the pitch."""
    1.0 / float(np.sin(pitch))
    return correct(x, y, z, pitch)


def at_the_shoulder(x, y, z, pitch):
    """A solver that divides by the height above the shoulder."""
    1.0 / (float(z) - SHOULDER)
    return correct(x, y, z, pitch)


def sideways(x, y, z, pitch):
    """A solver that takes the quotient of x and y."""
    float(x) / float(y)
    return correct(x, y, z, pitch)


@pytest.mark.nightly
@pytest.mark.parametrize("ik", [slope, level, at_the_shoulder, sideways])
def test_a_division_by_zero_on_a_plane_of_the_arm_is_found(ik):
    report = run_ik_test(IkTest(ik, OM))
    kinds = {finding.kind for finding in report.findings}
    assert any(kind.startswith("raises ZeroDivisionError at test_round") for kind in kinds)


def refuses_sideways(x, y, z, pitch):
    """A solver without an answer where the target is exactly to a side of the first axis."""
    return [] if x == FIRST_AXIS else correct(x, y, z, pitch)


def refuses_straight_ahead(x, y, z, pitch):
    """A solver without an answer where the target is exactly on the plane of the first axis."""
    return [] if y == 0 else correct(x, y, z, pitch)


def wrong_at_the_shoulder(x, y, z, pitch):
    """A solver whose answers are wrong exactly at the height of the shoulder."""
    return [
        [a + 0.1, *rest] if z == SHOULDER else [a, *rest] for a, *rest in correct(x, y, z, pitch)
    ]


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("ik", "kind", "name", "examples"),
    [
        (refuses_sideways, "refuses a target within reach", "answers", 100),
        (refuses_straight_ahead, "refuses a target within reach", "answers", 20),
        (wrong_at_the_shoulder, "misses the position", "reaches", 100),
    ],
)
def test_round_targets_within_reach_are_judged_as_others_are(ik, kind, name, examples):
    report = run_ik_test(IkTest(ik, OM, examples=examples))
    assert (name, kind) in {(finding.property, finding.kind) for finding in report.findings}


@pytest.mark.nightly(but=["open_manipulator_x"])
@pytest.mark.parametrize("robot", ["open_manipulator_x", "ur3e"])
def test_a_round_target_is_reached_by_the_positions_that_come_with_it(robot):
    chain = load_chain(robot)
    task, exact = natural_task(chain), []

    def visit(target):
        reached = chain.link_pose(target.joint_positions)
        assert max(miss(task, target.pose, reached)) < 1e-8
        assert (target.joint_positions >= chain.lower).all()
        assert (target.joint_positions <= chain.upper).all()
        place = 100 * target.pose.translation
        exact.append((np.abs(place - np.round(place)) < 1e-9).any())
        return True

    draw(round_reachable_poses(chain), visit, 100, 0)
    assert np.mean(exact) > 0.2
