"""capture: the camera's next picture."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.language.base import Name
from harness.plugins.cameras.known import check_camera
from harness.plugins.cameras.looks import TakenPicture

MOST_CAPTURES = 1000  # pictures that the steps of a file take; one of 640 x 480 takes 0.2 s


class Capture(Step):
    """Wait for a camera's next picture and keep it; it is drawn after the run."""

    short = "camera"

    verb: ClassVar[str] = "capture"
    plans: ClassVar[bool] = False
    synonyms = ("photo", "take_picture", "snapshot")
    results = (TakenPicture,)

    camera: Name = Field(description="The name of the camera.")
    kinds: Annotated[
        tuple[Literal["color", "depth", "segmentation"], ...], Field(min_length=1, max_length=3)
    ] = Field(default=("color",), description="The kinds of images that are kept.")

    def summary(self) -> str:
        return f"{self.camera}: {', '.join(self.kinds)}"

    def check(self, at: At) -> None:
        check_camera(self.camera, at.scope, at.key("camera"))
        scope, before = at.scope, at.scope.requested_pictures
        camera = scope.cameras.get(self.camera)
        scope.requested_pictures += 1.0 if camera is None else camera.pictures_counted
        if before <= MOST_CAPTURES < scope.requested_pictures:  # all are drawn after the run
            scope.problems.add(
                at.loc,
                f"the steps take more than {MOST_CAPTURES} pictures, repeated ones counted,"
                " those beyond 1280 x 720 by their pixels",
                "take fewer, or make it several scenarios; `videos` records a camera at a rate",
                needs=(),
            )

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
