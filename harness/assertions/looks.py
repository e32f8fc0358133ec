"""Which pictures the expectations about cameras need, and for how long each of them speaks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from harness.assertions.placed import PlacedExpectation
from harness.assertions.window import NotReached, Window, window_of
from harness.core.camera import Camera
from harness.recording.looks import Look
from harness.recording.run import Run
from harness.spec.checks import Sees

WATCH_RATE = 5.0
"""Pictures a second at most of a camera that an expectation watches [Hz]: each costs 0.2 s."""

MOST_PICTURES = 200
"""That one expectation looks at; over a longer time they are taken less often."""


def period(camera: Camera, window: Window) -> float:
    """Time between the pictures that watch a window [s]."""
    span = float(window.times[-1] - window.times[0])
    return max(1.0 / min(camera.update_rate, WATCH_RATE), span / MOST_PICTURES)


def looks_of_expectations(run: Run, expectations: Sequence[PlacedExpectation]) -> tuple[Look, ...]:
    """What to draw so that every `sees` can be judged.

    The last sample of its window; beside a temporal word, `for` or `within` the first one too and
    samples between them, one period apart.
    """
    cameras = {camera.name: camera for camera in run.cameras}
    found: list[Look] = []
    for placed in expectations:
        for spec, is_watched in _sees_in(placed):
            try:
                window = window_of(run, _step_of(placed, spec))
            except NotReached:
                continue
            camera = cameras.get(spec.camera)
            if camera is None:
                continue
            samples = [window.stop - 1]
            if is_watched:
                samples = _watched(window, period(camera, window))
            kind = "color" if spec.object is None else "segmentation"
            found += [Look(spec.camera, sample, (kind,)) for sample in samples]
    return tuple(found)


def _sees_in(placed: PlacedExpectation) -> Iterator[tuple[Sees, bool]]:
    """Every `sees` of an expectation, and whether it is about more than the window's end."""
    spec = placed.spec
    if isinstance(spec, Sees):
        yield spec, spec.for_ is not None or spec.within is not None
    for key in ("predicate", "until"):
        inner = getattr(spec, key, None)
        if isinstance(inner, Sees):
            yield inner, True


def _step_of(placed: PlacedExpectation, spec: Sees) -> str:
    return getattr(placed.spec, "during", None) or spec.during or placed.step


def _watched(window: Window, every: float) -> list[int]:
    times = window.times
    wanted = np.arange(float(times[0]), float(times[-1]), every)
    inside = np.searchsorted(times, wanted - 1e-9)
    return sorted({*(window.start + inside).tolist(), window.stop - 1})
