"""Checks states and edges of a group's motion for collisions, and counts the states."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin

from harness.core.errors import PlanningFailed
from harness.core.types import FloatArray
from harness.planning.collision import wording
from harness.planning.collision.certificates import MotionArrays, motion_arrays
from harness.planning.collision.native.library import certify
from harness.planning.collision.sampled_motion import SampledMotion
from harness.planning.collision.scene import CoalScene
from harness.planning.model.robot_model import GroupSpace
from harness.ports.scene import Touch
from harness.recording.explanation import LoweredMargin
from harness.recording.goal_failures import CollisionFailure, TouchRecord

DEEPEST_START = 0.002  # Penetration at the start above which a motion is rejected [m]
TOUCHING = 0.0001
"""Distance at the start below which a pair is in contact, like an object and its table [m]."""

MARGIN_SLACK = 0.0005  # How much nearer a pair may get that is below its margin at the start [m]
HOLD_RESOLUTION = 1 / 16
"""Joint-space distance between states at which the arm must be able to stand still [rad]: an effort
changes by a few per cent between two of them."""


class MotionChecker:
    """Answers whether a group's joint positions, and straight lines between them, are free.

    Every pair keeps its margin: the padding between robot and objects and between two arms, zero
    for other pairs. A pair that is nearer at the start (an object resting on its table, a finger
    next to what it grasps) keeps its start distance minus `MARGIN_SLACK` instead: it may separate
    and slide, but not penetrate deeper. A pair without contact at the start never gets into one.

    A motion is free when all its states at the requested spacing are free. The compiled check does
    not look at most of them one by one: where every pair is farther apart than a stretch of the
    motion can bring it nearer, the whole stretch is free (conservative advancement). Coal decides
    the states that are left. Results, counts and plans do not depend on which of them decides.

    Attributes:
        checks: The number of states checked, as `SampledMotion.counted` has it.
        can_hold: Whether the arm can stand still at positions (N, dof), which edges require too;
            None where nothing is required.
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
        self.can_hold: Callable[[FloatArray], bool] | None = None
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
                f"the robot starts in collision: {wording.touches(deep)}",
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
        return self.edge_free(positions, positions, 1.0)

    def edge_free(self, first: FloatArray, second: FloatArray, resolution: float) -> bool:
        """Whether the straight line between two positions is free; its start is not checked."""
        length = self.space.distance(first, second)
        if self.can_hold is not None:
            shares = np.linspace(1.0, 0.0, max(1, math.ceil(length / HOLD_RESOLUTION)), False)
            if not self.can_hold(first + shares[:, None] * (second - first)):
                return False
        count = max(1, math.ceil(length / resolution))
        places = np.array([-1.0, count - 1])
        motion = SampledMotion(np.array([first, second]), places, length / count)
        return self._is_free(motion)

    def path_free(self, path: FloatArray, resolution: float) -> bool:
        """Whether a polyline is free, shape (N, dof); its start is not checked."""
        return self._is_free(SampledMotion.of(path, self.space.metric, resolution))

    def first_block(
        self, path: FloatArray, resolution: float
    ) -> tuple[float, FloatArray, list[Touch]] | None:
        """Where a polyline is blocked first, as `SampledMotion.row`; the state, its touches."""
        motion = SampledMotion.of(path, self.space.metric, resolution)
        self.checks += motion.counted
        blocked = self._blocked(motion, 0, motion.last)
        if blocked is None:
            return None
        low = 0
        while low < blocked:
            middle = (low + blocked) // 2
            earlier = self._blocked(motion, low, middle)
            low, blocked = (middle + 1, blocked) if earlier is None else (low, earlier)
        state = motion.state(blocked)
        return motion.row(blocked), state, self.touches(state)

    def _is_free(self, motion: SampledMotion) -> bool:
        self.checks += motion.counted
        return self._blocked(motion, 0, motion.last) is None

    def _blocked(self, motion: SampledMotion, low: int, high: int) -> int | None:
        """A state of a motion from `low` to `high` that is not free, or None.

        The compiled check decides all states but those within `ROUNDING` of a margin and those in
        contact, which Coal checks.
        """
        blocked, undecided = self._arrays.certify(certify(), motion, low, high)
        if blocked >= 0:
            return blocked
        found = (self._blocked_by_coal(motion, *stretch) for stretch in undecided.tolist())
        return next((state for state in found if state is not None), None)

    def _blocked_by_coal(self, motion: SampledMotion, low: int, high: int) -> int | None:
        """The same by Coal alone, the last state first: a motion often ends in an obstacle."""
        states = (high, *range(low, high))
        return next(
            (each for each in states if not self._is_free_in_coal(motion.state(each))), None
        )

    @cached_property
    def _arrays(self) -> MotionArrays:
        return motion_arrays(self._scene_model, self.space, self._margins)

    @cached_property
    def _broad_phase(self) -> tuple[Any, pin.GeometryData]:
        """Coal's broad phase, and its data, to which it refers."""
        geometry, data = self._scene_model.geometry, self._scene_model.check_data(self._margins)
        manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager
        return manager(self._robot, geometry, data), data

    def _is_free_in_coal(self, positions: FloatArray) -> bool:
        manager, _ = self._broad_phase
        configuration = self.space.configuration(positions)
        return not pin.computeCollisions(self._robot, self._data, manager, configuration, True)

    def touches(self, positions: FloatArray) -> list[Touch]:
        """Pairs nearer than their margin at group positions, nearest first."""
        configuration = self.space.configuration(positions)
        return [touch for _, touch in self._scene_model.near(configuration, self._margins)]


def touch_records(touches: Sequence[Touch]) -> tuple[TouchRecord, ...]:
    """Touches as a failure records them."""
    return tuple(TouchRecord((touch.first, touch.second), touch.distance) for touch in touches)
