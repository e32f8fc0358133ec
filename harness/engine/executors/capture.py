"""capture: the camera's next picture."""

from __future__ import annotations

import math

from harness.cell.cell import Cell
from harness.engine.registry import execute
from harness.spec.steps import Capture


@execute.handles(Capture)
def capture(step: Capture, cell: Cell) -> None:
    """Hold the last commands until the camera takes its next picture.

    Pictures are taken at multiples of 1 / update_rate. This one is drawn after the run, from the
    last recorded sample of the step: physics never waits for it.
    """
    camera = cell.cameras[step.camera]
    now = cell.simulator.time
    taken = math.floor(now * camera.update_rate + 1e-6) + 1
    cell.simulator.hold(taken / camera.update_rate - now)
    cell.notes.result.update(
        camera=step.camera,
        kinds=list(step.kinds),
        time=cell.simulator.time,
        sample=cell.simulator.sample_count - 1,
    )
