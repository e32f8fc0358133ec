"""A real browser for report pages: Debian's chromium, drawn in software, without a network."""

import os
import shutil
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.waiting import HANG

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
SOFTWARE_GL = (
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-gpu-watchdog",  # on a busy machine it takes the software renderer for a hang
)
WITHOUT_GRAPHICS_CARD = (
    "--disable-gpu-rasterization",
    "--disable-gpu-compositing",
    "--webgl-antialiasing-mode=none",
    "--webgl-msaa-sample-count=0",
    "--disable-features=WebUIOmniboxPopup,WebUIOmniboxAimPopup,PaintHolding,HttpsUpgrades",
)
"""What a graphics card does at no cost, and windows of the browser itself: half of its time."""

NO_WEBGL = """(() => {
  const context = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
    return kind === "webgl2" ? null : context.call(this, kind, ...more);
  };
})()"""
"""A script that leaves a page without its 3D view."""


def installed():
    """The browser's file; None where there is none."""
    return next(filter(None, map(shutil.which, BROWSERS)), None)


_EMPTY = {}
"""Empty pages of each browser, to be used again: that costs half of a new one."""


@contextmanager
def launched(*options):
    """The installed browser, drawing in software."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        options = [*SOFTWARE_GL, *options]
        browser = playwright.chromium.launch(executable_path=installed(), args=options)
        yield browser
        _EMPTY.pop(browser, None)
        browser.close()


@pytest.fixture(scope="session")
def browser():
    """Debian's chromium, drawn in software, without a network."""
    if installed() is None:
        if os.environ.get("CI") == "true":
            pytest.fail("no chromium is installed, and CI must open the pages in one")
        pytest.skip("no chromium is installed: apt-get install chromium")
    with launched(*WITHOUT_GRAPHICS_CARD) as browser:
        yield browser


def new_context(browser, **options):
    """A context whose pages wait as long as nothing but a hang takes.

    Pages are drawn with a quarter of their pixels, unless a test states `device_scale_factor`.
    """
    context = browser.new_context(**{"device_scale_factor": 0.5} | options)
    context.set_default_timeout(1000 * HANG)
    return context


def wait_for(page, expression, complaints=()):
    """Wait until an expression is true in a page, whose policy keeps it from evaluating any.

    A page that complains meanwhile is not waited for.
    """
    end = time.monotonic() + HANG
    while not page.evaluate(expression):
        assert list(complaints) == []
        assert time.monotonic() < end, f"not within {HANG:g} s: {expression}"
        page.wait_for_timeout(20)


def go_to(page, place):
    """Change what follows `#` in a page's address, and wait until the page is there."""
    go = """(place) => new Promise((done) => {
      addEventListener("hashchange", () => done(null), { once: true });
      location.hash = place;
    })"""
    page.evaluate(go, place)


def put_back(page, place):
    """Go to a place of a report page that tests share, with nothing focused or zoomed by others."""
    page.keyboard.press("Escape")
    number = page.evaluate("window.visits = (window.visits ?? 0) + 1")
    go_to(page, f"{place}&visit={number}")
    page.evaluate("document.querySelector('#unzoom').click(), document.activeElement.blur()")


def wait_for_frame(page):
    """Wait until a page has drawn what it was about to draw."""
    frame = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
    page.evaluate(f"{frame}.then(() => null)")


class Visit:
    """An open page, and everything that went wrong or went out."""

    def __init__(self, page):
        self.page = page
        self.complaints = []
        self.requests = []
        self._listeners = {
            "console": lambda m: m.type == "error" and self.complaints.append(m.text),
            "pageerror": lambda error: self.complaints.append(str(error)),
            "request": lambda request: self.requests.append(request.url),
        }
        for event, listener in self._listeners.items():
            page.on(event, listener)

    def leave(self):
        """Empty the page, as it is for the next visit."""
        for event, listener in self._listeners.items():
            self.page.remove_listener(event, listener)
        self.page.goto("about:blank")
        self.page.emulate_media(media="null", color_scheme="null")

    def time(self):
        return float(self.page.get_attribute("#track", "aria-valuenow"))

    def text(self, selector):
        return self.page.inner_text(selector)


@contextmanager
def visits(browser):
    """Opens pages from disk and waits for them; at the end nothing may have gone wrong.

    Only with `has_scene` they have a 3D view: drawn in software, it takes longer than all the rest.
    """
    opened = []
    empty = _EMPTY.setdefault(browser, [])

    def open_page(file, place="", *, has_scene=False, **options):
        size = {"width": options.pop("width", 1100), "height": options.pop("height", 720)}
        scripts = options.pop("scripts", True)
        is_plain = scripts and not has_scene and not options
        if is_plain and empty:
            page = empty.pop()
            page.set_viewport_size(size)
        else:
            context = new_context(
                browser, viewport=size, java_script_enabled=scripts, offline=True, **options
            )
            page = context.new_page()
            if not has_scene:
                page.add_init_script(NO_WEBGL)
        visit = Visit(page)
        opened.append((is_plain, visit))
        visit.page.goto(f"{Path(file).as_uri()}{place}")
        if scripts:
            ready = "document.documentElement.dataset.ready === 'yes'"
            wait_for(visit.page, ready, visit.complaints)
        return visit

    yield open_page
    for is_plain, visit in opened:
        if is_plain:
            visit.leave()
            empty.append(visit.page)
        else:
            visit.page.context.close()
        assert visit.complaints == []
        local = ("file:", "data:", "blob:")
        remote = [url for url in visit.requests if not url.startswith(local)]
        assert remote == [], "the page requested something from the network"


@pytest.fixture
def visit(browser):
    """Opens pages, which are closed at the end: an open one goes on drawing its small pictures."""
    with visits(browser) as open_page:
        yield open_page
