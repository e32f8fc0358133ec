"""Checks motions with few states: a clearance certificate (a free ball) covers several states."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin

from harness.core.types import BoolArray, FloatArray
from harness.planning.collision.certificates import ROUNDING
from harness.planning.collision.motion_bound import nearing_rates
from harness.planning.collision.scene import CollisionModel
from harness.planning.model.robot_model import GroupSpace

FREE_BALL_RADIUS = 1 / 40
"""Joint-space radius of the free ball that a clearance certificate covers [rad]."""

FEW_STATES = 2
"""Largest number of states that are checked individually, without a certificate."""

STATES_PER_CERTIFICATE = 4.0
"""Average number of states that a certificate must cover for certificates to be tried."""

INITIAL_COVERED = 30
"""Initial number of covered states, before the first certificate is tried."""


class ClearanceCertificates:
    """Decides whether all states of a motion are free, with the result of individual checks."""

    def __init__(
        self, model: CollisionModel, space: GroupSpace, margins: Mapping[tuple[str, str], float]
    ) -> None:
        """Prepare certificates of a scene for a group and the margins of every pair [m]."""
        self._model, self._space, self._margins = model, space, margins
        self._tried, self._covered = 0, INITIAL_COVERED

    def are_free(self, states: FloatArray, is_free: Callable[[FloatArray], bool]) -> bool:
        """Whether all states of a motion are free.

        Args:
            states: Group positions, densely sampled, shape (N, dof).
            is_free: The exact check of one state.
        """
        scaled = states * self._space.metric
        length = float(np.linalg.norm(np.diff(scaled, axis=0), axis=1).sum())
        if len(states) <= FEW_STATES or length > 0.5 * FREE_BALL_RADIUS * len(states):
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
                away = np.linalg.norm(scaled[start:end] - scaled[middle], axis=1) > FREE_BALL_RADIUS
                before = start + _after_last(away[: middle - start])
                after = middle + 1 + _first(away[middle - start + 1 :])
                self._covered += after - before
            elif not is_free(states[middle]):
                return False
            waiting += [span for span in ((start, before), (after, end)) if span[0] < span[1]]
        return True

    def _has_room(self, positions: FloatArray) -> bool:
        """Whether a state certifies its free ball; False untried where that rarely helps."""
        if self._covered < STATES_PER_CERTIFICATE * self._tried:
            return False
        self._tried += 1
        robot = self._model.robot
        configuration = robot.configuration(self._space.whole(positions))
        manager, _ = self._wide
        return not pin.computeCollisions(robot.model, robot.data, manager, configuration, True)

    @cached_property
    def _wide(self) -> tuple[Any, Any]:
        """Coal's manager with margins enlarged by the free ball's motion bound, and its data."""
        model = self._model
        data = model.geometry.createData()
        requests = data.collisionRequests
        rates = nearing_rates(model, self._space)
        for pair, rate in zip(model.pairs, rates.tolist(), strict=True):
            margin = self._margins[pair.first, pair.second] + FREE_BALL_RADIUS * rate + ROUNDING
            for row in pair.pairs:
                requests[row].security_margin = margin
        manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
            model.robot.model, model.geometry, data
        )
        return manager, data


def coarse_to_fine(count: int) -> Iterator[int]:
    """The numbers 1 to `count`: the end, then halves, quarters ...; collisions are found early."""
    step = 1
    while step < count:
        step *= 2
    yield count
    while step > 1:
        half = step // 2
        yield from range(half, count, step)
        step = half


def _first(flags: BoolArray) -> int:
    """Index of the first true flag, or the number of flags."""
    return int(flags.argmax()) if flags.any() else len(flags)


def _after_last(flags: BoolArray) -> int:
    """Index after the last true flag, or 0."""
    return len(flags) - _first(flags[::-1])
