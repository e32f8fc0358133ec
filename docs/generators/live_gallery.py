"""The lessons of the gallery on the site: each with its film and its report page, made by a run."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

FOLDER = "gallery"
"""Folder of the reports in the site."""
RATE = 12
"""Frames of a film in a second of simulated time."""
VIEWS = {
    "01": "xyz: [0.8, -0.7, 1.5], rpy: [0, 22 deg, 132 deg]",
    "02": "xyz: [0.8, -0.7, 1.5], rpy: [0, 22 deg, 132 deg]",
    "03": "xyz: [1.5, -1.4, 2.0], rpy: [0, 20 deg, 137 deg]",
    "04_ur": "xyz: [1.1, -0.9, 1.75], rpy: [0, 23 deg, 135 deg]",
    "05": "xyz: [1.5, -1.4, 2.0], rpy: [0, 20 deg, 137 deg]",
}
"""Pose in the world of the camera that films a lesson, by the beginning of the lesson's name."""
PICTURE = re.compile(r"!\[[^\]]*\]\(pictures/gallery/(\w+)\.png\)\n")
LIVE = """
```{{raw}} html
{film}<details class="report">
<summary>The report of this run: replay, timeline, verdicts, plots</summary>
<iframe src="../{folder}/{lesson}/report.html" loading="lazy" title="{lesson}"></iframe></details>
<p><a href="../{folder}/{lesson}/report.html">The report in a page of its own</a></p>
```
"""
FILM = """<video controls loop muted playsinline
  src="../{folder}/{lesson}/cameras/film/video.mp4"></video>
"""


def view_of(lesson: str) -> str:
    """The pose of the camera that films a lesson; empty where none does."""
    return next((pose for name, pose in VIEWS.items() if lesson.startswith(name)), "")


def with_pages(text: str, most: int) -> str:
    """The text of the gallery with a film and a page below the first pictures."""

    def live(found: re.Match[str]) -> str:
        names = {"folder": f"{FOLDER}/lessons", "lesson": found[1]}
        film = FILM.format(**names) if view_of(found[1]) else ""
        return (found[0] if not film else "") + LIVE.format(film=film, **names)

    return PICTURE.sub(live, text, count=most)


def run_lessons(site: Path, most: int) -> None:
    """Run the first lessons that the gallery shows, with reports in the folder of the site."""
    page = Path(__file__).parents[1] / "gallery.md"
    for lesson in PICTURE.findall(page.read_text(encoding="utf-8"))[:most]:
        words = ["run", f"lessons/{lesson}", "--report-dir", FOLDER]
        if pose := view_of(lesson):
            size = "image: {width: 640, height: 480}"
            words += ["--set", f"cameras=[{{name: film, pose: {{{pose}}}, {size}}}]"]
            words += ["--set", f"videos=[{{camera: film, rate: {RATE}}}]"]
        command = [sys.executable, "-m", "harness.cli", *words]
        subprocess.run(command, cwd=site, check=True, stdout=subprocess.DEVNULL)
        for file in ("signals.npz", "visuals.npz"):  # the page has what it shows
            (site / FOLDER / "lessons" / lesson / file).unlink(missing_ok=True)
