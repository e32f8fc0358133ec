"""Follows the guide of the studio in a browser, and takes its pictures.

Run: python -m docs.generators.studio_guide
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Page

ROOT = Path(__file__).resolve().parents[2]
GUIDE = ROOT / "docs" / "guides" / "studio.md"
PICTURES = {"7": "studio_plan.jpg", "12": "studio_passed.jpg"}
"""Pictures by the number of the step after which they are taken."""

PHONE = "studio_phone.jpg"
"""The picture of the end on a narrow, dark screen."""

SENTENCE = re.compile(
    r"Click \*\*(?P<click>[^*]+)\*\*"
    r"|Type `(?P<text>[^`]+)` into \*(?P<field>[^*]+)\*"
    r"|Choose `(?P<option>[^`]+)` as \*(?P<select>[^*]+)\*"
    r"|Press `(?P<key>[^`]+)`|It shows `(?P<shown>[^`]+)`"
)
"""The sentences of the guide that say what to do, and what is seen then."""


def steps() -> Iterator[tuple[str, list[re.Match[str]]]]:
    """The number of each step of the guide, and its sentences."""
    text = GUIDE.read_text(encoding="utf-8")
    part = text[text.index("## The pick") : text.index("The file passes with")]
    for number, step in re.findall(r"^(\d+)\. (.*(?:\n {3}.*)*)", part, re.MULTILINE):
        yield number, list(SENTENCE.finditer(" ".join(step.split())))


def follow(page: Page, sentence: re.Match[str]) -> str:
    """Do what a sentence says.

    Returns:
        What the page must show then; empty where the sentence says nothing of that.
    """
    match sentence.groupdict():
        case {"click": str(name)}:
            found = (page.get_by_role(role, name=name, exact=True) for role in ("button", "tab"))
            next(each for each in found if each.count()).click()
        case {"text": str(text), "field": str(label)}:
            page.get_by_label(label, exact=True).fill(text)
        case {"option": str(option), "select": str(label)}:
            page.get_by_label(label, exact=True).select_option(option)
        case {"key": str(key)}:
            page.evaluate("document.activeElement.blur()")
            page.keyboard.press(key)
        case _:
            return sentence["shown"]
    return ""


def is_shown(text: str) -> str:
    """An expression that is true once a page shows a text."""
    return f"(document.body.innerText + ace.edit('editor').getValue()).includes({text!r})"


def main() -> None:
    """Take the pictures of the guide."""
    from playwright.sync_api import sync_playwright

    from harness.plugins.studio.document import new_text
    from harness.plugins.studio.files import StudioFiles
    from harness.plugins.studio.guard import Guard
    from harness.plugins.studio.server import StudioServer, page_assets
    from harness.plugins.studio.studio import Studio

    folder = Path(tempfile.mkdtemp())
    file = folder / "open_manipulator_x_by_hand.scenario.yaml"
    text = new_text("open_manipulator_x by hand", {"model": "open_manipulator_x"}, "empty")
    studio = Studio.opened(StudioFiles(folder, file), text, None, "")
    guard = Guard.of(page_assets(), is_open=False)
    server = StudioServer("127.0.0.1", 0, guard, studio.session.handle)
    studio.open()
    with sync_playwright() as playwright:
        arguments = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=arguments)
        page = browser.new_page(viewport={"width": 1400, "height": 800})
        page.set_default_timeout(600_000)  # pictures are drawn in software
        page.goto(f"http://127.0.0.1:{server.port}/")
        page.wait_for_selector(".joint")
        page.wait_for_timeout(6000)
        for number, sentences in steps():
            for sentence in sentences:
                shown = follow(page, sentence)
                while shown and not page.evaluate(is_shown(shown)):
                    page.wait_for_timeout(50)
            if number in PICTURES:
                page.wait_for_timeout(5000)
                picture = ROOT / "docs" / "pictures" / PICTURES[number]
                page.screenshot(path=picture, type="jpeg", quality=70)
        page.emulate_media(color_scheme="dark")
        page.set_viewport_size({"width": 390, "height": 1000})
        page.reload()
        page.wait_for_selector(".joint")
        page.wait_for_timeout(8000)
        page.screenshot(path=ROOT / "docs" / "pictures" / PHONE, type="jpeg", quality=70)
        browser.close()
    studio.close()


if __name__ == "__main__":
    main()
