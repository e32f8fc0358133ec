"""The reporter `film`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.recording.stored_run import StoredRun
from harness.reporting.reporter import Reporter


class FilmReporter(Reporter):
    """The replay as `film.mp4`, and the moment that decided as `moment.jpg`; `--film` for short."""

    name: ClassVar[str] = "film"
    takes_argument: ClassVar[bool] = False
    package: ClassVar[str] = "av"

    def write(self, folder: Path, stored: StoredRun) -> None:
        """Write the film and the picture."""
        from harness.plugins.cameras.film import draw_film, draw_moment

        (folder / "film.mp4").write_bytes(draw_film(stored))
        (folder / "moment.jpg").write_bytes(draw_moment(stored))
