"""What a predicate reads from a run beyond the signals that every run records."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple, cast

from harness.core.errors import HarnessError
from harness.core.types import FloatArray
from harness.judging.recorded import Unreadable
from harness.recording.run import Run
from harness.recording.signals import CaptureRecord, Signals

PictureKind = Literal["color", "depth", "segmentation"]

CLEARANCE_CUTOFF = 0.15  # distances that every run records are exact up to here [m]
CLEARANCE_ROOM = 0.05  # [m], by which distances go beyond a limit, so that margins are seen


class PictureRequest(NamedTuple):
    """Pictures that a predicate reads: which camera takes them, and of which kind."""

    camera: str
    kind: PictureKind


@dataclass(frozen=True)
class Observations:
    """What must be recorded for a predicate.

    Attributes:
        frames: Names of frames whose poses are needed: links, but objects and `world` too, which
            every run records.
        clearance_cutoff: Distances up to here must be exact [m]; 0 where recorded ones are read
            as they are, None where none are read.
        planned_clearances: Whether distances with the arm at its commands are needed, too.
    """

    frames: frozenset[str] = frozenset()
    clearance_cutoff: float | None = None
    planned_clearances: bool = False
    pictures: frozenset[PictureRequest] = frozenset()

    @property
    def reads_distances(self) -> bool:
        """Whether distances must be measured, in a recording that has none."""
        return bool(self.clearance_cutoff)

    @property
    def recorded_cutoff(self) -> float:
        """Distances up to here are exact in a run [m]."""
        return max(CLEARANCE_CUTOFF, self.clearance_cutoff or 0.0)


def merged(several: Iterable[Observations]) -> Observations:
    """Everything that any of several predicates needs."""
    every = list(several)
    cutoffs = [each.clearance_cutoff for each in every if each.clearance_cutoff is not None]
    return Observations(
        frozenset[str]().union(*(each.frames for each in every)),
        max(cutoffs, default=None),
        any(each.planned_clearances for each in every),
        frozenset[PictureRequest]().union(*(each.pictures for each in every)),
    )


class ExpectationError(HarnessError):
    """The class of an expectation breaks its contract: an error of the program."""


class UndeclaredObservation(ExpectationError):
    """A predicate reads what its `observations` do not declare."""

    def __init__(self, predicate: str, what: str) -> None:
        self.predicate = predicate
        super().__init__(
            f"{predicate} reads {what}, which its method `observations` does not declare"
        )


def restricted(run: Run, declared: Observations, predicate: str) -> Run:
    """The run as a predicate may read it: what it does not declare raises UndeclaredObservation.

    Poses of TCPs and of links that objects were attached to may always be read, where they were
    recorded.
    """
    signals = _DeclaredSignals(run, declared, predicate)
    captures = run.captures
    if not declared.pictures:
        error = UndeclaredObservation(predicate, "camera pictures")
        captures = cast("tuple[CaptureRecord, ...]", Unreadable(error))
    return replace(run, signals=cast("Signals", signals), captures=captures)


class _DeclaredSignals:
    """Signals of which a predicate reads what it declares."""

    def __init__(self, run: Run, declared: Observations, predicate: str) -> None:
        self._run, self._declared, self._predicate = run, declared, predicate

    def __getattr__(self, name: str) -> Any:
        declared = self._declared
        match name:
            case "frames":
                return _DeclaredFrames(self._run, declared.frames, self._predicate)
            case "clearances" | "clearance_links" if declared.clearance_cutoff is None:
                raise UndeclaredObservation(self._predicate, "distances")
            case "planned_clearances" if not declared.planned_clearances:
                raise UndeclaredObservation(self._predicate, "planned distances")
            case _:
                return getattr(self._run.signals, name)


class _DeclaredFrames(Mapping[str, FloatArray]):
    """Poses of the links that a predicate declares."""

    def __init__(self, run: Run, declared: frozenset[str], predicate: str) -> None:
        self._run, self._declared, self._predicate = run, declared, predicate

    def __getitem__(self, link: str) -> FloatArray:
        self._refuse_undeclared(link)
        return self._run.signals.frames[link]

    def __contains__(self, link: object) -> bool:
        self._refuse_undeclared(link)
        return link in self._run.signals.frames

    def __iter__(self) -> Iterator[str]:
        return iter(name for name in self._run.signals.frames if name in self._declared)

    def __len__(self) -> int:
        return len(list(iter(self)))

    def _refuse_undeclared(self, link: object) -> None:
        robot = self._run.robot
        if link in self._declared or link not in robot.link_names:
            return
        is_fixed = link in robot.static_link_poses
        is_carrier = "attachments" not in self._run.unrecorded and any(
            link == record.link for record in self._run.attachments
        )
        is_tip = any(link == arm.tcp_link for arm in robot.arms)
        if not is_fixed and not is_carrier and not is_tip:
            raise UndeclaredObservation(self._predicate, f"the pose of the link '{link}'")
