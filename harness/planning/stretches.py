"""Checks motions by few states: one with wide margins speaks for the stretch around it."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin

from harness.core.types import BoolArray, FloatArray
from harness.planning.certificates import ROUNDING
from harness.planning.nearing import nearing_rates
from harness.planning.robot_model import GroupSpace
from harness.planning.scene import CollisionModel

STRETCH = 1 / 40
"""Joint-space distance for which a state with wide margins speaks [rad]."""

FEW_STATES = 2
"""States at most that are checked one by one, without asking whether one speaks for the others."""

WORTH = 4.0
"""States that one with wide margins must speak for on average, to be asked on in a motion."""

HEAD_START = 30
"""States taken as spoken for before any was asked."""


class Stretches:
    """Answers whether all states of a motion are free, as checking each of them would."""

    def __init__(
        self, model: CollisionModel, space: GroupSpace, margins: Mapping[tuple[str, str], float]
    ) -> None:
        """Take a scene, the group that moves in it, and the margin of every pair [m]."""
        self._model, self._space, self._margins = model, space, margins
        self._asked, self._spoken_for = 0, HEAD_START

    def are_free(self, states: FloatArray, is_free: Callable[[FloatArray], bool]) -> bool:
        """Whether all states are free, shape (N, dof), neighbours near each other.

        Args:
            states: Of the group.
            is_free: Decides about one of them.
        """
        scaled = states * self._space.metric
        length = float(np.linalg.norm(np.diff(scaled, axis=0), axis=1).sum())
        if len(states) <= FEW_STATES or length > 0.5 * STRETCH * len(states):
            return all(is_free(states[step - 1]) for step in coarse_to_fine(len(states)))
        if not is_free(states[-1]):
            return False
        waiting = deque([(0, len(states) - 1)])
        while waiting:
            start, end = waiting.popleft()
            if end - start <= FEW_STATES:
                if not all(is_free(state) for state in states[start:end]):
                    return False
                continue
            middle = before = (start + end) // 2
            after = middle + 1
            if self._has_room(states[middle]):
                away = np.linalg.norm(scaled[start:end] - scaled[middle], axis=1) > STRETCH
                before = start + _behind_last(away[: middle - start])
                after = middle + 1 + _first(away[middle - start + 1 :])
                self._spoken_for += after - before
            elif not is_free(states[middle]):
                return False
            waiting += [span for span in ((start, before), (after, end)) if span[0] < span[1]]
        return True

    def _has_room(self, positions: FloatArray) -> bool:
        """Whether every pair keeps its margin for `STRETCH` around a state; not asked in vain."""
        if self._spoken_for < WORTH * self._asked:
            return False
        self._asked += 1
        robot = self._model.robot
        configuration = robot.configuration(self._space.whole(positions))
        manager, _ = self._wide
        return not pin.computeCollisions(robot.model, robot.data, manager, configuration, True)

    @cached_property
    def _wide(self) -> tuple[Any, Any]:
        """Coal's manager with margins as wide as `STRETCH` may take bodies nearer, and its data."""
        model = self._model
        data = model.geometry.createData()
        requests = data.collisionRequests
        rates = nearing_rates(model, self._space)
        for pair, rate in zip(model.pairs, rates.tolist(), strict=True):
            margin = self._margins[pair.first, pair.second] + STRETCH * rate + ROUNDING
            for row in pair.pairs:
                requests[row].security_margin = margin
        manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
            model.robot.model, model.geometry, data
        )
        return manager, data


def coarse_to_fine(count: int) -> Iterator[int]:
    """The numbers 1 to `count`, the end first, then halves, quarters ...: collisions show early."""
    step = 1
    while step < count:
        step *= 2
    yield count
    while step > 1:
        half = step // 2
        yield from range(half, count, step)
        step = half


def _first(flags: BoolArray) -> int:
    """Index of the first that is true, or their number."""
    return int(flags.argmax()) if flags.any() else len(flags)


def _behind_last(flags: BoolArray) -> int:
    """Index behind the last that is true, or 0."""
    return len(flags) - _first(flags[::-1])
