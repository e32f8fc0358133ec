"""The pictures of `docs/pictures/gallery`: run as a script, it runs the lessons and draws them."""

from __future__ import annotations

import tempfile
from pathlib import Path

import cv2

from docs import ROOT
from harness.core.types import FloatArray
from tests.reporting.browser import launched, wait_for
from tests.running import run_case

FOLDER = ROOT / "docs/pictures/gallery"
LESSONS = ROOT / "scenarios/lessons"
RENEW = "python -m docs.generators.gallery"
SHOWN = {
    "01_open_manipulator_first_steps": "lift",
    "02_open_manipulator_inverse_kinematics": "put-down-lower",
    "03_ur_sixteen_steps": "step-14",
    "04_gripper_alone": "steps-2",
    "04_ur_pick_by_friction": "hold",
    "05_fails_on_purpose": "into-the-table-why",
}
"""The picture in `images` that shows each lesson."""
SIZE = 480, 360
PAGE = "page", "03_ur_sixteen_steps", "#t=29.2&expect=27"
"""Name of the picture of a page, the lesson of that page, and the place in it."""
WINDOW = {"width": 1400, "height": 900}
PAGE_SIZE = 1050, 675


def write(file: Path, picture: FloatArray, size: tuple[int, int]) -> None:
    """Write a picture as a PNG of this size."""
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(file), small, [cv2.IMWRITE_PNG_COMPRESSION, 9])


def photograph(page: Path, place: str, file: Path) -> None:
    """Save what a browser shows of a page."""
    with launched() as browser:
        tab = browser.new_page(viewport=WINDOW, color_scheme="light")
        tab.goto(f"{page.as_uri()}{place}")
        wait_for(tab, "document.documentElement.dataset.ready === 'yes'")
        tab.wait_for_timeout(8000)  # the film strip is drawn when nothing else is to do
        tab.screenshot(path=file)


def draw(lesson: str, image: str, runs: Path) -> Path:
    """Run a lesson, draw its picture, and return the path of its page."""
    result = run_case(LESSONS / f"{lesson}.scenario.yaml", report_dir=runs / lesson)
    [file] = (runs / lesson / "images").glob(f"*-{image}.jpg")
    write(FOLDER / f"{lesson}.png", cv2.imread(str(file)), SIZE)
    return Path(result.page)


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        runs = Path(folder)
        pages = {lesson: draw(lesson, image, runs) for lesson, image in SHOWN.items()}
        name, lesson, place = PAGE
        photograph(pages[lesson], place, runs / "page.png")
        write(FOLDER / f"{name}.png", cv2.imread(str(runs / "page.png")), PAGE_SIZE)
