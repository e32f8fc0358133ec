"""Checks states and whole edges of a group's motion against the scene, and counts the states."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import pinocchio as pin

from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray, IntArray
from harness.planning import wording
from harness.planning.certificates import MotionArrays, motion_arrays
from harness.planning.compiled import compiled_stage, count_states
from harness.planning.robot_model import GroupSpace
from harness.planning.scene import CoalScene
from harness.planning.stretches import Stretches, coarse_to_fine
from harness.ports import Touch

DEEPEST_START = 0.002
"""Penetration at the start of a motion above which it is refused [m]."""

FEW_OPEN = 3
"""States and pairs left open after which Coal is asked first whether one of them is blocked."""

MOST_OPEN = 4096
"""States and pairs that the covers may leave open on an edge; more are checked all by Coal."""

MOST_SINGLE_PAIRS = 12
"""Pairs of shapes of one state that are checked one by one; more go through the broad phase."""

_MEASURED = 1e-4  # [m] beyond a limit, what collision checks find is measured

TOUCHING = 0.0001
"""Gap at the start of a motion below which a pair touches, as an object does its table [m]."""

MARGIN_SLACK = 0.0005
"""A pair that is too near at the start may come this much nearer during the motion [m]."""


class MotionChecker:
    """Answers whether a group's joint positions, and straight lines between them, are free.

    Every pair keeps its margin: the padding between robot and objects, zero elsewhere. A pair
    that is nearer than that at the start (an object resting on its table, a finger beside what it
    will grasp) keeps its distance at the start less `MARGIN_SLACK` instead: it may leave, it may
    slide along, it may not go deeper. What does not touch at the start never does.

    Whole edges are checked in two stages where the compiled one is there: covers certify stretches
    of the motion as free, or a state as blocked; Coal's exact shapes decide what they leave open.
    Where it is not, states whose margins are wide speak for those around them (`Stretches`). An
    edge is free when all its states are, at the spacing asked for, and it counts as so many states,
    whichever stage decided: verdicts, counts and plans are the same with and without.

    Attributes:
        checks: States checked so far.
        lowered: Pairs whose margin was lowered: `pair`, `start_distance`, `margin`.
    """

    def __init__(
        self, scene: CoalScene, space: GroupSpace, start: FloatArray, padding: float
    ) -> None:
        """Take the scene as it is now.

        Raises:
            PlanningFailed: START_STATE_IN_COLLISION, deeper than `DEEPEST_START`.
        """
        self.scene = scene
        self._scene_model = scene.collision_model()
        self.space = space
        self.padding = padding
        self.checks = 0
        self.lowered: list[Mapping[str, Any]] = []
        model = self._scene_model
        self._pairs = model.pairs
        self._robot = model.robot.model
        self._data = self._robot.createData()
        self._geometry = geometry = model.geometry  # kept: the manager below does not keep it
        self._geometry_data = geometry.createData()
        self._margins = self._choose_margins(start)
        self._set_margins(0.0)
        self._manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
            self._robot, geometry, self._geometry_data
        )

    def _choose_margins(self, start: FloatArray) -> dict[tuple[str, str], float]:
        margins = {
            (pair.first, pair.second): self.padding if pair.keeps_padding else 0.0
            for pair in self._pairs
        }
        self._margins = margins
        near = self._near(start, MARGIN_SLACK)
        deep = [touch for touch in near if touch.distance < -DEEPEST_START]
        if deep:
            raise PlanningFailed(
                "START_STATE_IN_COLLISION",
                f"the robot starts in collision: {wording.touches(deep)}",
                {"touches": touch_facts(deep)},
            )
        for touch in near:
            lowered = touch.distance - MARGIN_SLACK
            if touch.distance > TOUCHING:
                lowered = max(lowered, 0.0)
            margins[touch.first, touch.second] = lowered
            self.lowered.append(
                {
                    "pair": [touch.first, touch.second],
                    "start_distance": touch.distance,
                    "margin": lowered,
                }
            )
        return margins

    def _set_margins(self, more: float) -> None:
        requests = self._geometry_data.collisionRequests
        for pair in self._pairs:
            margin = self._margins[pair.first, pair.second] + more
            for row in pair.pairs:
                requests[row].security_margin = margin

    def _near(self, positions: FloatArray, slack: float) -> list[Touch]:
        """Pairs nearer than margin and slack, nearest first; only those are measured."""
        geometry, found = self._geometry, self._geometry_data
        self._set_margins(slack + _MEASURED)
        configuration = self.space.robot.configuration(self.space.whole(positions))
        pin.computeCollisions(self._robot, self._data, geometry, found, configuration, False)
        results = found.collisionResults
        near: list[Touch] = []
        for pair in self._pairs:
            if any(results[row].isCollision() for row in pair.pairs):
                distances = (
                    pin.computeDistance(geometry, found, row).min_distance for row in pair.pairs
                )
                touch = Touch(pair.first, pair.second, float(min(distances)))
                if touch.distance < self._margins[pair.first, pair.second] + slack:
                    near.append(touch)
        return sorted(near, key=lambda touch: (touch.distance, touch.first, touch.second))

    def state_free(self, positions: FloatArray) -> bool:
        """Whether every pair keeps its margin at group positions."""
        self.checks += 1
        return self._exact(positions)

    def edge_free(self, first: FloatArray, second: FloatArray, resolution: float) -> bool:
        """Whether the straight line between two positions is free, its first end taken as checked.

        Args:
            first: Group positions, checked before.
            second: Group positions.
            resolution: Largest joint-space distance between checked states [rad].
        """
        count = max(1, int(np.ceil(self.space.distance(first, second) / resolution)))
        shares = np.arange(1, count + 1) / count
        return self._all_free(first + (second - first) * shares[:, None], straight=True)

    def states_free(self, states: FloatArray) -> bool:
        """Whether all states of a motion are free, shape (N, dof), neighbours near each other."""
        return self._all_free(states, straight=False)

    def first_blocked(self, states: FloatArray) -> int | None:
        """Index of the first state of a motion that is not free, shape (N, dof), or None."""
        if self.states_free(states):
            return None
        return next(index for index, state in enumerate(states) if not self._exact(state))

    def _all_free(self, states: FloatArray, *, straight: bool) -> bool:
        self.checks += len(states)
        certify = compiled_stage()
        if certify is None:
            count_states(len(states))
            return self._stretches.are_free(states, self._exact)
        arrays = self._arrays
        values = np.ascontiguousarray(self.space.whole(states)[:, arrays.columns])
        for room in (self._open[:FEW_OPEN], self._open):  # what is left open may be blocked
            blocked, left_open = arrays.certify(certify, values, straight, room)
            if blocked >= 0:
                return False
            if left_open >= 0:
                return self._decide(states, room[:left_open])
            if not self._decide(states, room):
                return False
        return all(self._exact(states[step - 1]) for step in coarse_to_fine(len(states)))

    @cached_property
    def _stretches(self) -> Stretches:
        return Stretches(self._scene_model, self.space, self._margins)

    @cached_property
    def _arrays(self) -> MotionArrays:
        return motion_arrays(self._scene_model, self.space, self._margins)

    @cached_property
    def _open(self) -> IntArray:
        return np.empty((MOST_OPEN, 2), dtype=np.int64)

    def _decide(self, states: FloatArray, left_open: IntArray) -> bool:
        """Whether the pairs that the covers left open are free, by Coal's exact shapes."""
        rows_of = self._arrays.rows
        by_state: dict[int, list[int]] = {}
        for state, check in left_open.tolist():
            by_state.setdefault(state, []).extend(rows_of[check])
        for state, rows in by_state.items():
            if len(rows) > MOST_SINGLE_PAIRS:
                if not self._exact(states[state]):
                    return False
                continue
            configuration = self.space.robot.configuration(self.space.whole(states[state]))
            geometry, found = self._geometry, self._geometry_data
            pin.updateGeometryPlacements(self._robot, self._data, geometry, found, configuration)
            if any(pin.computeCollision(geometry, found, row) for row in rows):
                return False
        return True

    def _exact(self, positions: FloatArray) -> bool:
        configuration = self.space.robot.configuration(self.space.whole(positions))
        return not pin.computeCollisions(
            self._robot, self._data, self._manager, configuration, True
        )

    def path_free(self, waypoints: FloatArray, resolution: float) -> bool:
        """Whether all edges of a path are free, its first waypoint taken as checked."""
        return all(
            self.edge_free(first, second, resolution) for first, second in pairwise(waypoints)
        )

    def touches(self, positions: FloatArray) -> list[Touch]:
        """Pairs nearer than their margin at group positions, nearest first."""
        required = (
            replace(touch, required=self._margins[pair.first, pair.second])
            for touch, pair in self.scene.distances(self.space.whole(positions))
        )
        return [touch for touch in required if touch.distance <= touch.required]

    def first_block(
        self, first: FloatArray, second: FloatArray, resolution: float
    ) -> tuple[float, list[Touch]] | None:
        """Where along a straight line (0 to 1) the first check fails, and what touches there."""
        count = max(1, int(np.ceil(self.space.distance(first, second) / resolution)))
        states = first + (second - first) * (np.arange(1, count + 1) / count)[:, None]
        index = self.first_blocked(states)
        return None if index is None else ((index + 1) / count, self.touches(states[index]))


def touch_facts(touches: list[Touch]) -> list[dict[str, Any]]:
    """Touches as plain data."""
    return [{"pair": [touch.first, touch.second], "distance": touch.distance} for touch in touches]
