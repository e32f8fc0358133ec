"""Which camera pictures expectations need."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from harness.core.camera import Camera
from harness.judging.expectation import Expectation, Predicate
from harness.judging.placed import PlacedExpectation
from harness.judging.window import NotReached, Window, window_of
from harness.plugins.cameras.looks import Look
from harness.recording.run import Run

WATCH_RATE = 5.0  # [Hz], pictures of a watched camera at most: each costs 0.2 s
MOST_PICTURES = 200  # that one expectation looks at; over a longer time they are taken less often


def period(camera: Camera, window: Window) -> float:
    """Time between the pictures that watch a window [s]."""
    span = float(window.times[-1] - window.times[0])
    return max(1.0 / min(camera.update_rate, WATCH_RATE), span / MOST_PICTURES)


def looks_of_expectations(run: Run, expectations: Sequence[PlacedExpectation]) -> tuple[Look, ...]:
    """What to draw so that every expectation can be judged that reads pictures.

    The last sample of its window; with a temporal word, `for` or `within` the first one too and
    samples between them, one period apart.
    """
    cameras = {camera.name: camera for camera in run.cameras}
    found: list[Look] = []
    for placed in expectations:
        for predicate, is_watched in _predicates_in(placed.spec):
            requests = predicate.observations().pictures
            try:
                step = placed.spec.during or predicate.during or placed.step
                window = window_of(run, step) if requests else None
            except NotReached:
                continue
            for camera_name, kind in sorted(requests):
                camera = cameras.get(camera_name)
                if camera is None or window is None:
                    continue
                samples = [window.stop - 1]
                if is_watched:
                    samples = _watched(window, period(camera, window))
                found += [Look(camera_name, sample, (kind,)) for sample in samples]
    return tuple(found)


def _predicates_in(spec: Expectation) -> Iterator[tuple[Predicate, bool]]:
    """Every predicate of an expectation, and whether it is about more than the window's end."""
    if isinstance(spec, Predicate):
        yield spec, spec.for_ is not None or spec.within is not None
    for inner in spec.predicates().values():
        yield inner, True


def _watched(window: Window, every: float) -> list[int]:
    times = window.times
    due = np.arange(float(times[0]), float(times[-1]), every)
    inside = np.searchsorted(times, due - 1e-9)
    return sorted({*(window.start + inside).tolist(), window.stop - 1})
