"""What steps take with cameras."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from harness.core.details import Detail

PictureKind = Literal["color", "depth", "segmentation"]


@dataclass(frozen=True)
class TakenPicture(Detail):
    """What a step took with a camera: the recorded sample of the pictures, and its time [s]."""

    camera: str
    kinds: tuple[PictureKind, ...]
    time: float
    sample: int
