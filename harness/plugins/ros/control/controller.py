"""What a controller follows: one motion at a time, from a command to its outcome."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from harness.core.types import FloatArray, IntArray
from harness.plugins.ros.control.goals import Code
from harness.recording.commands import CommandKind
from harness.robot.description import TrackingTolerances
from harness.robot.end_effector import Gripper
from harness.robot.mechanism import Joint

Rows = FloatArray  # positions, velocities and accelerations, shape (3, N, dof)


@dataclass(frozen=True, eq=False)
class Outcome:
    """How a goal ended, with the result message of its action.

    Attributes:
        hold: Positions that are commanded from now on; None where the last set point is kept.
    """

    goal: str
    has_succeeded: bool
    result: Any
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


class Motion(Protocol):
    """What a controller follows.

    Attributes:
        goal: The identifier of its goal; empty for a trajectory from a topic.
        effort: The effort limit that it sets [N or N m]; 0 for the gripper's own.
    """

    goal: str
    effort: float

    def at(self, times: FloatArray) -> Rows:
        """Set points at some times [s]."""
        ...

    def judge(self, window: Window) -> Outcome | None:
        """How the goal ended; None while it is active."""
        ...

    def feedback(self, window: Window) -> Any:
        """The feedback message of its action."""
        ...

    def interrupted(self, code: Code, reason: str, window: Window) -> Outcome:
        """How the goal ends when a newer goal or a request to cancel ends it."""
        ...


@dataclass(eq=False)
class Controller:
    """Moves some joints along one motion at a time.

    Attributes:
        columns: Where its joints are among the actuated ones.
        places: Where they are in the description.
        bounds: The tolerances of a trajectory that has none of its own.
        gripper: The gripper whose joint it moves; None of an arm's controller.
        motion: What it follows; None while it follows nothing.
    """

    joints: Sequence[Joint]
    columns: IntArray
    places: IntArray
    bounds: TrackingTolerances
    gripper: Gripper | None = None
    motion: Motion | None = None

    @property
    def kinds(self) -> tuple[CommandKind, ...]:
        """The commands that it takes."""
        return ("trajectory",) if self.gripper is None else ("trajectory", "gripper")
