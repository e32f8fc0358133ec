"""Which pictures a run needs: those of `capture` steps and those that expectations read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from harness.core.details import Detail
from harness.judging.observations import PictureKind
from harness.recording.step_record import StepRecord


@dataclass(frozen=True)
class TakenPicture(Detail):
    """What a step took with a camera: the recorded sample of the pictures, and its time [s]."""

    camera: str
    kinds: tuple[PictureKind, ...]
    time: float
    sample: int


@dataclass(frozen=True)
class Look:
    """One camera at one recorded sample.

    Attributes:
        step: Id of the `capture` step; empty when an expectation needs the picture.
    """

    camera: str
    sample: int
    kinds: tuple[PictureKind, ...]
    step: str = ""


def looks_of_steps(steps: Iterable[StepRecord]) -> tuple[Look, ...]:
    """What `capture` steps took."""
    return tuple(
        Look(taken.camera, taken.sample, taken.kinds, step.id)
        for step in steps
        if (taken := step.result.find(TakenPicture)) is not None
    )


def merged_looks(looks: Iterable[Look]) -> tuple[Look, ...]:
    """One look for each camera and sample, of every kind that any of them needs, in time order."""
    together: dict[tuple[int, str], Look] = {}
    for look in looks:
        known = together.get((look.sample, look.camera), look)
        kinds = tuple(dict.fromkeys((*known.kinds, *look.kinds)))
        step = known.step or look.step
        together[look.sample, look.camera] = Look(look.camera, look.sample, kinds, step)
    return tuple(together[key] for key in sorted(together))
