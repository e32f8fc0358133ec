"""Plans that cases share: the same scene, start, goal, options and seed, the same plan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Generic, Protocol, TypeVar

from harness.core.details import Details
from harness.core.errors import ErrorCode, PlanningFailed
from harness.core.sharing import shared
from harness.planning.collision.scene import CoalScene
from harness.ports.motion_planning import MotionRequest

R = TypeVar("R")


class _Planner(Protocol):
    scene: CoalScene


P = TypeVar("P", bound=_Planner)
Method = Callable[[P, MotionRequest], R]


@dataclass(frozen=True)
class _Refusal:
    """A failure of the planner, which is as much a result as a plan."""

    code: ErrorCode
    message: str
    details: Details


@dataclass(frozen=True)
class _Answer(Generic[R]):
    result: R | None
    refusal: _Refusal | None = None


def sharing_plans(kind: str) -> Callable[[Method[P, R]], Method[P, R]]:
    """Let cases share the results of a planner's method.

    Args:
        kind: What the results are called in the record of a case.
    """

    def decorated(method: Method[P, R]) -> Method[P, R]:
        @wraps(method)
        def planning(self: P, request: MotionRequest) -> R:
            answer = shared(
                kind,
                lambda: (method.__qualname__, self.scene.key, request),
                lambda: _answer(method, self, request),
            )
            if answer.refusal is not None:
                raise _failure(answer.refusal)
            assert answer.result is not None
            return answer.result

        return planning

    return decorated


def _answer(
    method: Callable[[P, MotionRequest], R], planner: P, request: MotionRequest
) -> _Answer[R]:
    try:
        return _Answer(method(planner, request))
    except PlanningFailed as failure:
        return _Answer(None, _Refusal(failure.code, failure.message, failure.details))


def _failure(refusal: _Refusal) -> PlanningFailed:
    return PlanningFailed(refusal.code, refusal.message, *refusal.details)
