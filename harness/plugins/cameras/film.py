"""Draws the replay of a run as a film, and the moment that decided it as a picture."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing

import numpy as np

from harness.core.activity import Activity, unobserved
from harness.core.picture_files import jpeg
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.plugins.cameras.camera_scene import floor_height, scene_poses
from harness.plugins.cameras.caption import DARK, RED, captioned, strip_height
from harness.plugins.cameras.film_story import Frame, Moment, deciding_moment, frames_of
from harness.plugins.cameras.picture_model import build_picture_model
from harness.plugins.cameras.renderer import make_renderer
from harness.plugins.cameras.stills import INK, overview
from harness.recording.run import ObjectRecord
from harness.recording.stored_run import StoredRun

SIZE = 960, 540  # [pixels]: slides and phones show it whole
RATE = 15.0  # frames per second of simulated time
MOST_FRAMES = 900  # a minute, drawn in two minutes of processor time; of longer runs fewer a second
LINES = 2  # of a caption
FITTED = 40  # samples, which the view of a film contains


def draw_film(
    stored: StoredRun,
    size: tuple[int, int] = SIZE,
    rate: float = RATE,
    activity: Activity = unobserved,
) -> bytes:
    """An MP4 of the replay in real time, with the step and its verdict below the picture.

    Args:
        stored: A run with its verdicts.
        size: Width and height in pixels, both even.
        rate: Frames per second of simulated time; fewer of long runs.
        activity: Called with the number of frames that are drawn, and their number.

    Raises:
        ModuleNotFoundError: The extra `video` is not installed.
    """
    from harness.recording.film import encoded_film

    rate = min(rate, MOST_FRAMES / max(stored.run.duration, 1e-9))
    last = len(stored.run.signals.times) - 1
    fitted = np.unique(np.linspace(0, last, FITTED).astype(int)).tolist()
    with closing(ReplayRenderer(stored, size, fitted)) as renderer:
        return encoded_film(renderer.pictures(rate, activity), rate, size)


def draw_moment(stored: StoredRun, size: tuple[int, int] = SIZE) -> bytes:
    """A JPEG of the moment that decided a run, with a sentence on it."""
    moment = deciding_moment(stored)
    times = stored.run.signals.times
    sample = min(int(np.searchsorted(times, moment.time - 1e-9)), len(times) - 1)
    with closing(ReplayRenderer(stored, size, [sample])) as renderer:
        return jpeg(renderer.picture(Frame(sample, None, moment)))


class ReplayRenderer:
    """Draws recorded samples of a saved run from one side."""

    def __init__(self, stored: StoredRun, size: tuple[int, int], fitted: Sequence[int]) -> None:
        """Load the shapes and the graphics library.

        Args:
            size: Width and height in pixels.
            fitted: The samples that the view contains.
        """
        self._stored, run = stored, stored.run
        self._objects = [_object(record) for record in run.objects]
        floor = floor_height(run.robot, self._objects)
        width, height = size
        self._letters = max(8, height // 30)  # 18 of 540, which a phone shows legibly
        height -= strip_height(self._letters, LINES)
        size = width, height
        self._picture = build_picture_model(
            run.robot, self._objects, floor_height=floor, width=width, height=height
        )
        self._picture.model.vis.quality.offsamples = 0  # half of the time on a processor
        self._renderer = make_renderer(self._picture, width, height, "auto")
        self._view = overview(run.robot, self._objects, run, fitted, size).view

    def pictures(self, rate: float, activity: Activity = unobserved) -> Iterator[np.ndarray]:
        """The captioned pictures of a film, RGB."""
        frames = list(frames_of(self._stored, rate))
        for number, frame in enumerate(frames):
            activity("drawing", number, len(frames))
            picture = self.picture(frame)
            for _ in range(frame.repeats):
                yield picture

    def picture(self, frame: Frame) -> np.ndarray:
        """A captioned picture, RGB."""
        run = self._stored.run
        self._picture.pose(scene_poses(run.robot, self._objects, run, frame.sample))
        pixels = self._renderer.render(self._view)
        text, status, ink = self._words(frame)
        return captioned(
            pixels, text, ink=ink, status=status, status_ink=ink, size=self._letters, lines=LINES
        )

    def _words(self, frame: Frame) -> tuple[str, str, tuple[int, int, int]]:
        """Caption and status below the picture, and their colour."""
        run = self._stored.run
        time = f"{float(run.signals.times[frame.sample]):.2f} s"
        if frame.moment is not None:
            return frame.moment.text, time, _ink(frame.moment)
        if frame.step is None:
            return run.scenario, time, DARK
        number = run.steps.index(frame.step) + 1
        return f"{number}/{len(run.steps)}  {frame.step.summary or frame.step.verb}", time, DARK

    def close(self) -> None:
        """Free the resources of the graphics library."""
        self._renderer.close()


def _ink(moment: Moment) -> tuple[int, int, int]:
    return INK["passed"] if moment.is_good else RED


def _object(record: ObjectRecord) -> WorldObject:
    """An object as pictures need it."""
    pose = SE3.from_vector(np.array(record.pose)) if record.pose else SE3.identity()
    return WorldObject(
        record.name,
        record.shapes,
        pose,
        record.is_static,
        0.0,
        np.zeros(3),
        np.zeros((3, 3)),
        in_planning=record.in_planning,
        in_simulation=record.in_simulation,
        visuals=record.visuals,
    )
