"""Checks states and edges of a group's motion for collisions, and counts the states."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import pinocchio as pin

from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.planning.collision import wording
from harness.planning.collision.approximation import approximation_note
from harness.planning.collision.certificates import MotionArrays, motion_arrays
from harness.planning.collision.compiled import compiled_check
from harness.planning.collision.scene import CoalScene
from harness.planning.model.robot_model import GroupSpace
from harness.ports.scene import Touch
from harness.recording.explanation import LoweredMargin
from harness.recording.goal_failures import CollisionFailure, TouchRecord

DEEPEST_START = 0.002
"""Penetration at the start above which a motion is rejected [m]."""

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

    A motion is free when all its states at the requested spacing are free, and it counts as that
    many states. The compiled check decides most of them at once, by conservative advancement on the
    same shapes; Coal decides the others, and all while the compiled check is not loaded. Results,
    counts and plans do not depend on which of them decides.

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
        self._robot = self._scene_model.robot.model
        self._data = self._robot.createData()
        self._margins = self._choose_margins(start)

    def _choose_margins(self, start: FloatArray) -> FloatArray:
        margins = self._scene_model.margins(self.padding)
        configuration = self.space.configuration(start)
        near = [
            (index, replace(touch, required=0.0))
            for index, touch in self._scene_model.near(configuration, margins + MARGIN_SLACK)
        ]
        deep = [touch for _, touch in near if touch.distance < -DEEPEST_START]
        if deep:
            raise PlanningFailed(
                "START_STATE_IN_COLLISION",
                f"the robot starts in collision: {wording.touches(deep)}"
                + approximation_note(deep, self.scene),
                CollisionFailure(touch_records(deep)),
            )
        for index, touch in near:
            lowered = touch.distance - MARGIN_SLACK
            if touch.distance > TOUCHING:
                lowered = max(lowered, 0.0)
            margins[index] = lowered
            self.lowered.append(LoweredMargin((touch.first, touch.second), touch.distance, lowered))
        return margins

    def state_free(self, positions: FloatArray) -> bool:
        """Whether every pair keeps its margin at group positions."""
        return self.states_free(np.asarray(positions)[None])

    def edge_free(self, first: FloatArray, second: FloatArray, resolution: float) -> bool:
        """Whether the straight line between two positions is free; its start is not checked.

        Args:
            first: Group positions at the start, known to be free.
            second: Group positions at the end.
            resolution: The largest joint-space distance between checked states [rad].
        """
        count = max(1, int(np.ceil(self.space.distance(first, second) / resolution)))
        return self._blocked(np.array([first, second]), count, straight=True) is None

    def states_free(self, states: FloatArray) -> bool:
        """Whether all states of a motion are free, shape (N, dof), densely sampled."""
        return self._blocked(states, len(states), straight=False) is None

    def first_blocked(self, states: FloatArray) -> int | None:
        """Index of the first state of a motion that is not free, shape (N, dof), or None."""
        blocked = self._blocked(states, len(states), straight=False)
        if blocked is None:
            return None
        earlier = enumerate(states[:blocked])
        return next((index for index, state in earlier if not self._exact(state)), blocked)

    def _blocked(self, states: FloatArray, count: int, *, straight: bool) -> int | None:
        """A state of a motion that is not free, or None; the arguments of `MotionArrays.certify`.

        The compiled check decides all states but those within `ROUNDING` of a margin. These, and
        all states before it is loaded, are checked by Coal, coarse to fine.
        """
        self.checks += count
        open_states: Iterable[int] | None = None
        certify = compiled_check(count)
        if certify is not None:
            blocked, open_states = self._arrays.certify(certify, states, count, straight=straight)
            if blocked >= 0:
                return blocked
        for index in coarse_to_fine(count) if open_states is None else open_states:
            if straight:
                state = states[0] + (states[1] - states[0]) * ((index + 1) / count)
            else:
                state = states[index]
            if not self._exact(state):
                return int(index)
        return None

    @cached_property
    def _arrays(self) -> MotionArrays:
        return motion_arrays(self._scene_model, self.space, self._margins)

    @cached_property
    def _manager(self) -> tuple[Any, pin.GeometryData]:
        """Coal's broad phase with this checker's margins, and its data, to which it only refers."""
        geometry = self._scene_model.geometry
        data = self._scene_model.check_data(self._margins)
        manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(self._robot, geometry, data)
        return manager, data

    def _exact(self, positions: FloatArray) -> bool:
        manager, _ = self._manager
        configuration = self.space.configuration(positions)
        return not pin.computeCollisions(self._robot, self._data, manager, configuration, True)

    def path_free(self, waypoints: FloatArray, resolution: float) -> bool:
        """Whether all edges of a path are free; its first waypoint is not checked."""
        return all(
            self.edge_free(first, second, resolution) for first, second in pairwise(waypoints)
        )

    def touches(self, positions: FloatArray) -> list[Touch]:
        """Pairs nearer than their margin at group positions, nearest first."""
        configuration = self.space.configuration(positions)
        return [touch for _, touch in self._scene_model.near(configuration, self._margins)]

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


def coarse_to_fine(count: int) -> Iterator[int]:
    """Indices of states: the last, then at halves, quarters ...; collisions are found early."""
    step = 1
    while step < count:
        step *= 2
    yield count - 1
    while step > 1:
        half = step // 2
        yield from range(half - 1, count - 1, step)
        step = half
