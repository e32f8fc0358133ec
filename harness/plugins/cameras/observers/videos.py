"""Cameras whose video has a lower rate than requested."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from harness.cell.program import Program
from harness.recording.run import Finding, Run
from harness.session.observation.observer import Observer


class Videos(Observer):
    """Cameras whose video has a lower rate than requested."""

    name: ClassVar[str] = "videos"

    def report(self, run: Run, program: Program) -> tuple[Finding, ...]:
        return slowed_videos(run, program.parts.get("videos", {}))


def slowed_videos(run: Run, rates: Mapping[str, float]) -> tuple[Finding, ...]:
    """The cameras whose video has a lower rate than requested, since the run is long."""
    most = {camera.name: camera.most_frames for camera in run.cameras}
    return tuple(
        Finding(
            "video_rate",
            f"{name} is recorded at {most[name] / run.duration:.3g} Hz instead of {rate:g} Hz:"
            f" a video of this size has at most {most[name]} frames",
        )
        for name, rate in rates.items()
        if run.duration * rate > most[name]
    )
