"""capture: the camera's next picture."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.language.base import Name
from harness.language.step import Step
from harness.recording.looks import TakenPicture


class Capture(Step):
    """Wait for a camera's next picture and keep it; it is drawn after the run."""

    short = "camera"

    verb: ClassVar[str] = "capture"
    synonyms = ("photo", "take_picture", "snapshot")
    results = (TakenPicture,)

    camera: Name = Field(description="The name of the camera.")
    kinds: Annotated[
        tuple[Literal["color", "depth", "segmentation"], ...], Field(min_length=1, max_length=3)
    ] = Field(default=("color",), description="The kinds of images that are kept.")

    def summary(self) -> str:
        return f"{self.camera}: {', '.join(self.kinds)}"

    def check(self, at: At) -> None:
        at.scope.check_camera(self.camera, at.key("camera"))
        at.scope.take_picture(self.camera, at.loc)

    def execute(self, cell: Cell) -> None:
        """Hold the last commands until the camera takes its next picture.

        Pictures are taken at multiples of 1 / update_rate. This one is drawn after the run, from
        the last recorded sample of the step: physics never waits for it.
        """
        camera = cell.cameras[self.camera]
        now = cell.simulator.time
        taken = math.floor(now * camera.update_rate + 1e-6) + 1
        cell.simulator.hold(taken / camera.update_rate - now)
        sample = cell.simulator.sample_count - 1
        cell.report(TakenPicture(self.camera, self.kinds, cell.simulator.time, sample))
