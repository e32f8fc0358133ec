"""Which links of a robot touch each other at random configurations: pairs that may be allowed.

The kinds are those of MoveIt's Setup Assistant: adjacent links, links that touch where the robot
starts, always, or in no sample.
"""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np
import pinocchio as pin

from harness.core.types import BoolArray, FloatArray
from harness.planning.collision.collision_model import Body, CollisionModel
from harness.planning.collision.rigid_shapes import link_shapes
from harness.planning.model.robot_model import RobotModel
from harness.robot.description import RobotDescription
from harness.robot.srdf.srdf import link_pair
from harness.robot.tree import adjacent_pairs, carriers

Reason = Literal["Adjacent", "Default", "Always", "Never"]
REASONS: tuple[Reason, ...] = ("Adjacent", "Default", "Always", "Never")

ALWAYS = 0.95  # Part of the samples from which a pair touches always, as in the Setup Assistant
WORLD = "world"


@dataclass(frozen=True, eq=False)
class SelfTouches:
    """Which links touched at which configurations.

    Attributes:
        description: The description of the robot.
        pairs: Links that move against each other, sorted names; allowed pairs included.
        touched: Whether a pair touched in a sample, shape (N, P).
        at_start: Whether a pair touches where the robot starts, shape (P,).
    """

    description: RobotDescription
    pairs: tuple[tuple[str, str], ...]
    touched: BoolArray
    at_start: BoolArray

    @property
    def is_checked(self) -> BoolArray:
        """Which pairs the planner checks, shape (P,)."""
        allowed = self.description.allowed_collisions
        across = _across(self.description)
        return np.array([pair not in allowed and pair not in across for pair in self.pairs], bool)

    @property
    def is_free(self) -> BoolArray:
        """In which samples no checked pair touches, shape (N,)."""
        return np.logical_not(self.touched[:, self.is_checked].any(axis=1))

    @property
    def rate(self) -> float:
        """Part of the samples in which the robot collides with itself."""
        return float(1.0 - self.is_free.mean())

    def most_frequent(self, count: int) -> tuple[tuple[tuple[str, str], float], ...]:
        """Checked pairs that touch most often, with the part of the samples in which they do."""
        means = np.where(self.is_checked, self.touched.mean(axis=0), 0.0)
        order = np.argsort(-means, kind="stable")[:count]
        return tuple((self.pairs[i], float(means[i])) for i in order if means[i] > 0)

    def proposed(self) -> dict[tuple[str, str], Reason]:
        """Pairs that need not be checked, with the reason; adjacent ones first."""
        reasons = {pair: self._reason(index) for index, pair in enumerate(self.pairs)}
        return {
            pair: kind for kind in REASONS for pair, reason in reasons.items() if reason == kind
        }

    def _reason(self, index: int) -> Reason | None:
        if self.pairs[index] in adjacent_pairs(self.description.links, self.description.joints):
            return "Adjacent"
        if self.at_start[index]:
            return "Default"
        mean = float(self.touched[:, index].mean())
        return "Always" if mean >= ALWAYS else "Never" if mean == 0 else None


def self_touches(
    description: RobotDescription,
    positions: FloatArray,
    on_checked: Callable[[int], None] = lambda _: None,
) -> SelfTouches:
    """Look for touching links at joint positions, description order, shape (N, n).

    Args:
        on_checked: Called with the number of rows that are checked.
    """
    checker = _Checker(description)
    found: list[BoolArray] = []
    for row in positions:
        found.append(checker.touching(row))
        on_checked(len(found))
    touched = np.array(found, dtype=bool)
    at_start = checker.touching(description.start_positions())
    shape = (len(positions), len(checker.pairs))
    return SelfTouches(description, checker.pairs, touched.reshape(shape), at_start)


class _Checker:
    """All shapes of a robot, and the pairs of links that can collide."""

    def __init__(self, description: RobotDescription) -> None:
        self._robot = RobotModel(description)
        bodies = [
            Body(name, rigid, is_link=True, is_held=False)
            for name, rigid in link_shapes(description).items()
        ]
        carrier = carriers(description.joints, WORLD)
        numbers = [
            (first, second)
            for first, second in combinations(range(len(bodies)), 2)
            if carrier[bodies[first].name] != carrier[bodies[second].name]
        ]
        pairs = np.array(numbers, dtype=np.int64).reshape(-1, 2)
        unpadded = np.zeros(len(pairs), dtype=bool)
        model = CollisionModel(self._robot, tuple(bodies), pairs, unpadded)
        self.pairs = tuple(link_pair(*model.names(pair)) for pair in range(len(pairs)))
        self._geometry, self._data = model.geometry, model.check_data(model.margins(0.0))
        self._owners, self._ends = model.pair_of_row, model.rows
        shapes = [shape.geometry for shape in self._geometry.geometryObjects]
        for shape in shapes:
            shape.computeLocalAABB()
        self._centers = [np.array(shape.aabb_center).ravel() for shape in shapes]
        radii = np.array([shape.aabb_radius for shape in shapes])
        self._near = radii[self._ends].sum(axis=1)

    def touching(self, joint_positions: FloatArray) -> BoolArray:
        """Which pairs touch, in the order of `pairs`; shapes whose spheres are apart do not."""
        configuration = self._robot.configuration(np.asarray(joint_positions))
        model, data, shapes = self._robot.model, self._robot.data, self._geometry
        pin.updateGeometryPlacements(model, data, shapes, self._data, configuration)
        placed = zip(self._data.oMg, self._centers, strict=True)
        centers = np.array([pose.act(center) for pose, center in placed]).reshape(-1, 3)
        first, second = self._ends.T
        away = np.linalg.norm(centers[first] - centers[second], axis=1)
        found = np.zeros(len(self.pairs), dtype=bool)
        for number in np.flatnonzero(away <= self._near):
            owner = self._owners[number]
            found[owner] = found[owner] or pin.computeCollision(shapes, self._data, int(number))
        return found


def _across(description: RobotDescription) -> frozenset[tuple[str, str]]:
    """Pairs of links that a joint connects."""
    return frozenset(link_pair(joint.parent, joint.child) for joint in description.joints)
