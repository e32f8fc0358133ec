"""What steps report, as typed parts: those that verdicts read, and how a saved run gives them back.

A part that only reports show is defined in the file of its step. The keys of `result` in run.json
are the fields of all parts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Any, TypeVar

from harness.core.details import Detail, Details
from harness.core.registry import registry
from harness.recording.plain import PlainError, from_plain

D = TypeVar("D", bound=Detail)
Pairs = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class SceneChange(Detail):
    """Objects that a step added to the scene, removed from it, or put somewhere else, by name."""

    added: tuple[str, ...] | None = None
    removed: tuple[str, ...] | None = None
    moved: tuple[str, ...] | None = None

    @property
    def names(self) -> tuple[str, ...]:
        return (*(self.added or ()), *(self.removed or ()), *(self.moved or ()))


@dataclass(frozen=True)
class Attachment(Detail):
    """An object that a step fixed to a link in the planning scene.

    Attributes:
        represents: The simulated object that it stands for; None when it is that object.
    """

    attached: str
    link: str
    touch_links: tuple[str, ...]
    represents: str | None = None


@dataclass(frozen=True)
class AllowedCollisions(Detail):
    """Pairs of bodies that may touch during a step."""

    allowed_collisions: Pairs


@dataclass(frozen=True)
class GraspMode(Detail):
    """How a grasp holds its object: by `friction`, or by a `weld`."""

    mode: str


@dataclass(frozen=True)
class DistanceResult(Detail):
    """How far a relative motion goes [m or rad]."""

    distance: float


@dataclass(frozen=True)
class SequenceResult(Detail):
    """How many motions a sequence has, and between how many of them it stops or blends."""

    items: int
    stops: int
    blends: int


@dataclass(frozen=True)
class CartesianPathResult(Detail):
    """What a Cartesian path reaches.

    Attributes:
        fraction: The share of its length.
        largest_joint_step: Between two states [rad or m].
        deviation: The largest distance from its lines [m]; None until it is timed.
        min_fraction: The share that is required, where less is reached.
    """

    fraction: float
    largest_joint_step: float
    deviation: float | None = None
    min_fraction: float | None = None


CELL_RESULTS: tuple[type[Detail], ...] = (
    SceneChange,
    Attachment,
    DistanceResult,
    SequenceResult,
    CartesianPathResult,
)
"""Parts that the methods of a `Cell` report on behalf of any step."""


@dataclass(frozen=True)
class SavedDetails(Details):
    """Details of a saved run as plain data; a part gets its type when it is requested."""

    saved: Mapping[str, Any] = field(default_factory=dict[str, Any])

    def __add__(self, more: Details) -> Details:
        return replace(self, saved={**self.saved, **more.plain()})

    def find(self, kind: type[D]) -> D | None:
        """The part of a kind; None where there is none, or a value is not of its type."""
        known = {entry.name: entry for entry in fields(kind)}
        needed = {name for name, entry in known.items() if entry.default is MISSING}
        if not known.keys() & self.saved.keys() or not needed <= self.saved.keys():
            return None
        try:
            return from_plain(self.saved, kind)
        except PlainError:
            return None

    def replaced(self, part: Detail) -> Details:
        """The details with one part in place of those of its kind."""
        return self + Details.of(part)

    def plain(self) -> dict[str, Any]:
        """Every part as plain data in one mapping."""
        return dict(self.saved)


@dataclass(frozen=True)
class SavedResult(SavedDetails):
    """What a step of a saved run reported.

    The step's class names the types of its parts. It is looked up when a part is requested; where
    the package of the step is not installed, its own parts remain plain data.
    """

    verb: str = ""

    def find(self, kind: type[D]) -> D | None:
        """The part of a kind that the step reports; None where there is none that fits."""
        is_reported = any(issubclass(each, kind) for each in _parts_of(self.verb))
        return super().find(kind) if is_reported else None


def _parts_of(verb: str) -> tuple[type[Detail], ...]:
    steps = registry("step")
    return (*CELL_RESULTS, *(steps[verb].results if verb in steps else ()))
