"""Checks states and edges of a group's motion for collisions, and counts the states."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

import numpy as np
import pinocchio as pin

from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray, IntArray
from harness.planning.collision import wording
from harness.planning.collision.approximation import approximation_note
from harness.planning.collision.certificates import MotionArrays, motion_arrays
from harness.planning.collision.compiled import compiled_stage, count_states
from harness.planning.collision.free_stretches import ClearanceCertificates, coarse_to_fine
from harness.planning.collision.scene import CoalScene
from harness.planning.model.robot_model import GroupSpace
from harness.ports import Touch
from harness.recording.explanation import LoweredMargin
from harness.recording.goal_failures import CollisionFailure, TouchRecord

DEEPEST_START = 0.002
"""Penetration at the start above which a motion is rejected [m]."""

FEW_OPEN = 3
"""Number of undecided states and pairs at which Coal first checks whether one is blocked."""

MOST_OPEN = 4096
"""Largest number of undecided states and pairs on an edge; with more, Coal checks all states."""

MOST_SINGLE_PAIRS = 12
"""Largest number of shape pairs of one state that are checked without the broad phase."""

_MEASURED = 1e-4  # [m] extra margin within which found pairs are measured

TOUCHING = 0.0001
"""Distance at the start below which a pair is in contact, like an object and its table [m]."""

MARGIN_SLACK = 0.0005
"""How much nearer a pair may get that is below its margin at the start [m]."""


class MotionChecker:
    """Answers whether a group's joint positions, and straight lines between them, are free.

    Every pair keeps its margin: the padding between robot and objects, zero for other pairs. A pair
    that is nearer at the start (an object resting on its table, a finger next to the object that it
    grasps) keeps its start distance minus `MARGIN_SLACK` instead: it may separate and slide, but
    not penetrate deeper. A pair without contact at the start never gets into contact.

    With the compiled stage, edges are checked in two stages: sphere covers certify parts of the
    motion as free or a state as blocked, and Coal's exact shapes decide what remains undecided.
    Without it, states with enough clearance certify their neighbourhood (`ClearanceCertificates`).
    An edge is free when all its states at the requested spacing are free, and it counts as that
    many states in either case: results, counts and plans do not depend on the stage.

    Attributes:
        checks: The number of states checked.
        lowered: The pairs with a lowered margin.
    """

    def __init__(
        self, scene: CoalScene, space: GroupSpace, start: FloatArray, padding: float
    ) -> None:
        """Create a checker of the current scene.

        Raises:
            PlanningFailed: START_STATE_IN_COLLISION, when a pair is deeper than `DEEPEST_START`.
        """
        self.scene = scene
        self._scene_model = scene.collision_model()
        self.space = space
        self.padding = padding
        self.checks = 0
        self.lowered: list[LoweredMargin] = []
        model = self._scene_model
        self._pairs = model.pairs
        self._robot = model.robot.model
        self._data = self._robot.createData()
        self._geometry = geometry = model.geometry  # the manager below holds no reference
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
                f"the robot starts in collision: {wording.touches(deep)}"
                + approximation_note(deep, self.scene),
                CollisionFailure(touch_records(deep)),
            )
        for touch in near:
            lowered = touch.distance - MARGIN_SLACK
            if touch.distance > TOUCHING:
                lowered = max(lowered, 0.0)
            margins[touch.first, touch.second] = lowered
            self.lowered.append(LoweredMargin((touch.first, touch.second), touch.distance, lowered))
        return margins

    def _set_margins(self, more: float) -> None:
        requests = self._geometry_data.collisionRequests
        for pair in self._pairs:
            margin = self._margins[pair.first, pair.second] + more
            for row in pair.pairs:
                requests[row].security_margin = margin

    def _near(self, positions: FloatArray, slack: float) -> list[Touch]:
        """Pairs nearer than margin plus slack, nearest first; only those are measured."""
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
        """Whether the straight line between two positions is free; its start is not checked.

        Args:
            first: Group positions at the start, known to be free.
            second: Group positions at the end.
            resolution: The largest joint-space distance between checked states [rad].
        """
        count = max(1, int(np.ceil(self.space.distance(first, second) / resolution)))
        shares = np.arange(1, count + 1) / count
        return self._all_free(first + (second - first) * shares[:, None], straight=True)

    def states_free(self, states: FloatArray) -> bool:
        """Whether all states of a motion are free, shape (N, dof), densely sampled."""
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
            return self._clearance_certificates.are_free(states, self._exact)
        arrays = self._arrays
        values = np.ascontiguousarray(self.space.whole(states)[:, arrays.columns])
        for room in (self._open[:FEW_OPEN], self._open):  # undecided pairs may be blocked
            blocked, left_open = arrays.certify(certify, values, straight, room)
            if blocked >= 0:
                return False
            if left_open >= 0:
                return self._decide(states, room[:left_open])
            if not self._decide(states, room):
                return False
        return all(self._exact(states[step - 1]) for step in coarse_to_fine(len(states)))

    @cached_property
    def _clearance_certificates(self) -> ClearanceCertificates:
        return ClearanceCertificates(self._scene_model, self.space, self._margins)

    @cached_property
    def _arrays(self) -> MotionArrays:
        return motion_arrays(self._scene_model, self.space, self._margins)

    @cached_property
    def _open(self) -> IntArray:
        return np.empty((MOST_OPEN, 2), dtype=np.int64)

    def _decide(self, states: FloatArray, left_open: IntArray) -> bool:
        """Whether the pairs that the covers leave undecided are free, by Coal's exact shapes."""
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
        """Whether all edges of a path are free; its first waypoint is not checked."""
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
        """Where a straight line (0 to 1) is first blocked, and the pairs too near there."""
        count = max(1, int(np.ceil(self.space.distance(first, second) / resolution)))
        states = first + (second - first) * (np.arange(1, count + 1) / count)[:, None]
        index = self.first_blocked(states)
        return None if index is None else ((index + 1) / count, self.touches(states[index]))


def touch_records(touches: Sequence[Touch]) -> tuple[TouchRecord, ...]:
    """Touches as a failure records them."""
    return tuple(TouchRecord((touch.first, touch.second), touch.distance) for touch in touches)
