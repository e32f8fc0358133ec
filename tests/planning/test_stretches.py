"""A clearance certificate at one state agrees with the exact check of the states around it."""

import numpy as np
import pytest

from harness.core.geometry import Box, Shape
from harness.planning.collision.checker import MotionChecker
from harness.planning.collision.compiled import use_compiled
from harness.planning.collision.motion_bound import nearing_rates
from harness.planning.model.robot_model import GroupSpace
from tests.planning.lesson import FIRST_BOXES, Cell, at, boxes, thing
from tests.planning.problem import HOMES, description_of

GROUPS = [(model, "arm") for model in HOMES] + [(model, "gripper") for model in HOMES]


@pytest.fixture(autouse=True)
def plain():
    use_compiled("never")
    yield
    use_compiled("when it pays")


def cell_of(model):
    """The lesson's tables and boxes, the arm at home, a stick in its hand."""
    cell = Cell(description_of(model))
    cell.add(boxes(*FIRST_BOXES))
    cell.state = cell.with_arm(HOMES[model])
    tcp = cell.kinematics.link_pose(cell.state, cell.description.tcp_link)
    cell.add(thing("stick", tcp @ at(0.05, 0, 0), Shape(Box((0.2, 0.01, 0.01)))))
    hand = cell.description.gripper.links
    cell.scene.attach_object("stick", cell.description.tcp_link, hand, cell.state)
    return cell


def space_of(cell, kind):
    groups = {"arm": cell.description.arm_group, "gripper": cell.description.gripper.group}
    return GroupSpace(cell.kinematics.robot, groups[kind], cell.state)


def drawn(space, generator):
    """Group positions within limits, a turn each way where there are none."""
    return generator.uniform(np.maximum(space.lower, -np.pi), np.minimum(space.upper, np.pi))


@pytest.mark.parametrize(("model", "kind"), GROUPS)
def test_no_pair_comes_nearer_than_its_rate_says(model, kind):
    cell = cell_of(model)
    space = space_of(cell, kind)
    rates = dict(
        zip(
            [(pair.first, pair.second) for pair in cell.scene.collision_model().pairs],
            nearing_rates(cell.scene.collision_model(), space),
            strict=True,
        )
    )
    generator = np.random.default_rng(8)
    closest = 0.0
    for step in (0.02, 0.3):
        for _ in range(60):
            first = drawn(space, generator)
            second = first + step * generator.normal(size=space.dof) / np.sqrt(space.dof)
            second = np.clip(second, space.lower, space.upper)
            moved = space.distance(first, second)
            before, after = (
                {(touch.first, touch.second): touch.distance for touch, _ in found}
                for found in map(cell.scene.distances, map(space.whole, (first, second)))
            )
            for pair, rate in rates.items():
                if before[pair] <= 0 or after[pair] <= 0:  # how deep is reported roughly
                    continue
                nearer = abs(before[pair] - after[pair])
                assert nearer <= rate * moved + 2e-5, pair
                closest = max(closest, nearer / max(rate * moved, 1e-9) if rate > 0 else 0.0)
    assert closest > 0.3  # the rates are no empty promise


@pytest.mark.parametrize("model", list(HOMES))
def test_whole_edges_are_as_free_as_their_states(model):
    cell = cell_of(model)
    space = space_of(cell, "arm")
    home = np.array(HOMES[model])
    generator = np.random.default_rng(2)
    verdicts = []
    for padding in (0.0, 0.02):
        checker = MotionChecker(cell.scene, space, home, padding)
        each = MotionChecker(cell.scene, space, home, padding)
        for number in range(60):
            start = drawn(space, generator)
            end = start + generator.normal(size=space.dof) * (0.1, 0.4)[number % 2]
            end = np.clip(end, space.lower, space.upper)
            count = max(1, int(np.ceil(space.distance(start, end) * 512)))
            shares = np.arange(1, count + 1)[:, None] / count
            states = start + (end - start) * shares
            verdicts.append(checker.edge_free(start, end, 1 / 512))
            assert verdicts[-1] == all(map(each.state_free, states))
            assert checker.states_free(states) == verdicts[-1]
            assert checker.first_blocked(states) == (
                None
                if verdicts[-1]
                else next(i for i, state in enumerate(states) if not each.state_free(state))
            )
    assert 0.2 < np.mean(verdicts) < 0.95


def line(first, second, space):
    """States every 1/512 rad, the first left out."""
    count = max(1, int(np.ceil(space.distance(first, second) * 512)))
    return first + (second - first) * np.arange(1, count + 1)[:, None] / count


@pytest.mark.parametrize("model", list(HOMES))
def test_a_motion_that_only_just_touches_on_its_way_is_not_free(model):
    """It goes 3 mrad beyond the last free state, and back."""
    cell = cell_of(model)
    space = space_of(cell, "arm")
    checker = MotionChecker(cell.scene, space, np.array(HOMES[model]), 0.0)
    generator = np.random.default_rng(6)
    seen = 0
    while seen < 60:
        free, blocked = (drawn(space, generator) for _ in range(2))
        if not checker.state_free(free) or checker.state_free(blocked):
            continue
        start = free
        while space.distance(free, blocked) > 0.003:
            middle = 0.5 * (free + blocked)
            free, blocked = (middle, blocked) if checker.state_free(middle) else (free, middle)
        back = blocked + (start - blocked) * generator.uniform(0.1, 0.9)
        states = np.concatenate([line(start, blocked, space), line(blocked, back, space)])
        seen += 1
        assert not checker.states_free(states)
