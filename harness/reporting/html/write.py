"""The page in a run's folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from harness.recording.explanation import recorded_explanation
from harness.recording.read_run import read_run
from harness.recording.stored_run import PAGE, StoredRun, blames_changes
from harness.reporting.html.page import page_html
from harness.reporting.html.summary import SummaryPicture

PICTURES = 6
WIDTH = 360  # [pixels]
WHY = "-why"
"""How names of pictures end that show what explains a failure."""
CAPTION_SHARE = 26 / 480
"""Of a still's height: the strip below with words too small for the page."""
QUALITY = 70


def write_page(folder: Path, stored: StoredRun | None = None) -> Path:
    """Write `report.html` into a run's folder, from the saved run if none is given.

    Raises:
        HarnessError: The folder holds no run.
    """
    stored = stored or read_run(folder)
    page = folder / PAGE
    with blames_changes(folder, stored):
        text = page_html(stored, _pictures(folder, stored))
    page.write_text(text, encoding="utf-8", newline="")
    return page


def _pictures(folder: Path, stored: StoredRun) -> list[SummaryPicture]:
    """A few of the stills that the folder has: failures, the end, and between them."""
    executed = [step for step in stored.run.steps if step.status != "not reached"]
    stills = {
        int(file.name.partition("-")[0]) - 1: file
        for file in (folder / "images").glob("[0-9]*-*.jpg")
        if not file.stem.endswith(WHY)
    }
    there = [number for number in sorted(stills) if number < len(executed)]
    failed = [number for number in there if executed[number].status == "failed"]
    moving = [n for n in there if executed[n].end_time > executed[n].start_time]
    ends = {executed[number].end_time: number for number in moving or there}
    rest = [number for _, number in sorted(ends.items()) if number not in failed]
    chosen = sorted(
        {*failed[:PICTURES], *_spread(rest, PICTURES - len(failed))},
        key=lambda number: (executed[number].end_time, number),
    )
    captioned = [
        (stills[n], f"{executed[n].summary}, t = {executed[n].end_time:.2f} s") for n in chosen
    ]
    captioned += [
        (folder / picture, f"why: {step.summary}")
        for step in executed
        if step.status == "failed"
        and (picture := recorded_explanation(step.explanation).picture) is not None
    ]
    return [
        SummaryPicture(caption, small)
        for file, caption in captioned
        if (small := _small(file)) is not None
    ]


def _spread(numbers: Sequence[int], count: int) -> list[int]:
    if count <= 0 or not numbers:
        return []
    last = len(numbers) - 1
    return [numbers[round(last * (i + 1) / count)] for i in range(count)]


def _small(file: Path) -> bytes | None:
    if not file.is_file():
        return None
    picture = cv2.imdecode(np.frombuffer(file.read_bytes(), dtype=np.uint8), cv2.IMREAD_COLOR)
    if picture is None:
        return None
    picture = picture[: round(picture.shape[0] * (1 - CAPTION_SHARE))]
    height = round(picture.shape[0] * WIDTH / picture.shape[1])
    picture = cv2.resize(picture, (WIDTH, height), interpolation=cv2.INTER_AREA)
    is_coded, data = cv2.imencode(".webp", picture, [cv2.IMWRITE_WEBP_QUALITY, QUALITY])
    return data.tobytes() if is_coded else None
