"""Why a step could not be executed, as typed records; their fields are those of `explanation`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from harness.core.details import Detail
from harness.core.types import Pair


@dataclass(frozen=True)
class ObjectFailure(Detail):
    """An object that the planning scene does not have, and those that it has."""

    object: str
    known: tuple[str, ...]


@dataclass(frozen=True)
class NotHeldFailure(Detail):
    """An object to place that the gripper does not hold; None where none is named."""

    not_held: str | None


@dataclass(frozen=True)
class WidthFailure(Detail):
    """An object that does not fit between the fingers [m]."""

    width: float
    opening: float
    least_gap: float
    height: float


@dataclass(frozen=True)
class ContactForce(Detail):
    """Two bodies that touch, and their normal force [N]."""

    bodies: Pair
    force: float


@dataclass(frozen=True)
class ControlFailure(Detail):
    """A joint that does not follow its command.

    Attributes:
        error: The position error of the joint, in `unit`.
        time: The simulation time of the failure [s].
        contacts: The robot's contacts, strongest first.
    """

    joint: str
    error: float
    tolerance: float
    unit: Literal["m", "rad"]
    time: float
    contacts: tuple[ContactForce, ...]


@dataclass(frozen=True)
class GripperOutcome(Detail):
    """Where the gripper ended.

    Attributes:
        target: The commanded position of its joint [rad or m].
        stalled: Whether it stopped before the target.
        contacts: Bodies that each finger side touches.
    """

    target: float
    position: float
    effort: float
    stalled: bool
    reached_goal: bool
    contacts: Mapping[str, tuple[str, ...]]


@dataclass(frozen=True)
class GraspFailure(Detail):
    """A grasp in which a finger side does not touch the object; `mode` is the step's."""

    mode: str


@dataclass(frozen=True)
class UnrestFailure(Detail):
    """A body that still moves when its time to settle is over."""

    moving: str
    speed: float
    limit: float
    timeout: float


@dataclass(frozen=True)
class TimeoutFailure(Detail):
    """A step that takes longer than its timeout [s]."""

    duration: float
    timeout: float


@dataclass(frozen=True)
class LengthFailure(Detail):
    """A run that would be too long: its end [s] or its size, against the limit."""

    limit: float
    end: float | None = None
    bytes: int | None = None
