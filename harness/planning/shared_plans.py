"""Plans that cases share: the same scene, start, goal, options and seed, the same plan."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Protocol, TypeVar

from harness.core.errors import PlanningFailed
from harness.core.sharing import shared
from harness.planning.collision.scene import CoalScene
from harness.ports.motion_planning import MotionRequest

R = TypeVar("R")


class _Planner(Protocol):
    scene: CoalScene


P = TypeVar("P", bound=_Planner)
Method = Callable[[P, MotionRequest], R]


def sharing_plans(kind: str) -> Callable[[Method[P, R]], Method[P, R]]:
    """Let cases share the results of a planner's method, of which a failure is one.

    Args:
        kind: What the results are called in the record of a case.
    """

    def decorated(method: Method[P, R]) -> Method[P, R]:
        @wraps(method)
        def planning(self: P, request: MotionRequest) -> R:
            def result() -> R | PlanningFailed:
                try:
                    return method(self, request)
                except PlanningFailed as failure:
                    return failure

            found = shared(kind, lambda: (method.__qualname__, self.scene.key, request), result)
            if isinstance(found, PlanningFailed):
                raise found
            return found

        return planning

    return decorated
