"""What the controllers of a cell have in common: a goal, set points, and how the goal ends."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from harness.core.types import FloatArray, IntArray
from harness.robot.description import Joint
from harness.ros.control.goals import Code
from harness.ros.control.spline import Rows


@dataclass(frozen=True, eq=False)
class Outcome:
    """How a goal ended.

    Attributes:
        goal: The identifier of the goal; empty for one from a topic.
        hold: Positions that are commanded from now on; None where the last set point is kept.
    """

    goal: str
    hold: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Window:
    """Motion of a controller's joints since the last update.

    Attributes:
        times: Simulated times of the samples [s], shape (N,).
        desired: The set points at these times, shape (3, N, dof).
        measured: The measured positions and velocities of the joints, shape (2, N, dof).
        efforts: The efforts at the last sample, shape (dof,).
    """

    times: FloatArray
    desired: Rows
    measured: FloatArray
    efforts: FloatArray


class Followed(Protocol):
    """What a controller follows."""

    @property
    def goal(self) -> str: ...


F = TypeVar("F", bound=Followed)


class Controller(ABC, Generic[F]):
    """Moves some joints towards one goal at a time; a new goal replaces the old one.

    Attributes:
        columns: Where its joints are among the actuated ones.
        places: Where they are in the description.
    """

    columns: IntArray
    places: IntArray

    def __init__(self, name: str, joints: Sequence[Joint]) -> None:
        self._active: F | None = None
        self.name, self.joints = name, tuple(joints)
        self.joint_names = tuple(joint.name for joint in joints)

    @property
    def is_active(self) -> bool:
        """Whether it follows something."""
        return self._active is not None

    @property
    def goal(self) -> str:
        """The identifier of the goal that it follows; empty for none, or one from a topic."""
        return self._active.goal if self._active else ""

    def stop(self) -> str:
        """Follow nothing any more; the identifier of the goal that was followed."""
        goal, self._active = self.goal, None
        return goal

    @abstractmethod
    def begin(
        self, goal: str, content: Mapping[str, Any], now: float, start: Rows, measured: FloatArray
    ) -> None:
        """Follow a goal from now on.

        Args:
            goal: Its identifier; empty for one from a topic.
            content: The values of its message.
            now: The present simulated time [s].
            start: The last set point, shape (3, 1, dof).
            measured: The measured positions, shape (dof,).

        Raises:
            GoalRefused: It cannot be followed; what was followed goes on.
        """

    @abstractmethod
    def set_points(self, times: FloatArray) -> Rows | None:
        """Set points at some times; None where it follows nothing."""

    @abstractmethod
    def judge(self, window: Window) -> Outcome | None:
        """How the goal ended; None while it goes on."""

    @abstractmethod
    def interrupted(self, goal: str, code: Code, reason: str, window: Window) -> Outcome:
        """How a goal ends that something else ended: a newer goal, or a request to cancel."""
