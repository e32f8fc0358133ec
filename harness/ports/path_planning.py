"""Planning pipelines as plug-ins: they search paths between joint positions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.core.registry import Plugin
from harness.core.types import FloatArray
from harness.ports.kinematics import JointSpace


@dataclass(frozen=True, eq=False)
class PathRequest:
    """What a planning pipeline must find: a free path from a start to one of several goals.

    The checks answer for the planning scene as it is now, with attached objects, allowed
    collisions and padding; each costs state checks. After the budget is used up, a check ends the
    search of a third-party planner: the search has failed.

    Attributes:
        planner_id: The name of the planner, as `PathPlanner.check` returned it.
        space: The joints that move.
        start: Joint positions, shape (dof,), free.
        goals: Joint positions, shape (dof,) each, free; nearest first.
        is_state_free: Whether joint positions are free of collisions.
        is_edge_free: Whether the straight line from free joint positions to others is free.
        state_checks: The number of state checks used by this search.
        max_state_checks: The budget of this search.
        resolution: Joint-space distance at which a planner's own checks of edges are fine enough
            [rad]; `is_edge_free` checks more finely.
        seed: The only source of randomness; the same request must give the same path.
        parameters: The planner's parameters, by name.
    """

    planner_id: str
    space: JointSpace
    start: FloatArray
    goals: tuple[FloatArray, ...]
    is_state_free: Callable[[FloatArray], bool]
    is_edge_free: Callable[[FloatArray, FloatArray], bool]
    state_checks: Callable[[], int]
    max_state_checks: int
    resolution: float
    seed: int
    parameters: Mapping[str, float]

    @property
    def rng(self) -> np.random.Generator:
        """A generator of random numbers at the start of its sequence."""
        return np.random.default_rng(self.seed)


@dataclass(frozen=True, eq=False)
class PathResult:
    """What a planning pipeline found.

    Attributes:
        waypoints: Joint positions, shape (N, dof), from the start to a goal; None: no path.
        vertices: The number of vertices of its trees or graph, for statistics.
        gap: The joint-space distance that was left to a goal [rad]; None when it is not known.
        planner_id: The planner that found it, where `planner_id` left that open.
    """

    waypoints: FloatArray | None
    vertices: int = 0
    gap: float | None = None
    planner_id: str = ""


class PathPlanner(Plugin, ABC):
    """A planning pipeline, selected by `planning: {pipeline: NAME}`.

    Its paths are checked anew, shortened, timed and verified like those of every other pipeline.

    Attributes:
        planner_ids: Names that `planner_id` may have; empty for a pipeline of one planner.
        parameters: Names that `parameters` may have.
    """

    plugin_kind: ClassVar[str] = "planner"
    planner_ids: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def check(cls, planner_id: str, parameters: Mapping[str, float]) -> str:
        """Check a file's `planner_id` and `parameters`.

        Args:
            planner_id: The name in the file; empty where the file has none.
            parameters: The parameters in the file, by name.

        Returns:
            The planner's name; by default the first of `planner_ids`.

        Raises:
            ValueError: There is no such planner, or it takes no such parameter; says what there is.
        """
        name = planner_id or next(iter(cls.planner_ids), "")
        if name and name not in cls.planner_ids:
            known = ", ".join(cls.planner_ids) or "none, leave out `planner_id`"
            raise ValueError(
                f"the planning pipeline `{cls.name}` has no planner '{name}'; planners: {known}"
            )
        for each in parameters:
            if each not in cls.parameters:
                known = ", ".join(cls.parameters) or "none"
                raise ValueError(
                    f"the planning pipeline `{cls.name}` has no parameter '{each}' (it has: "
                    f"{known})"
                )
        return name

    @abstractmethod
    def find_path(self, request: PathRequest) -> PathResult:
        """Search a path; a new object of the class is made for every search."""
