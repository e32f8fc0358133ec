"""A real browser for the pages, and real runs for it to open."""

import os
import shutil
from pathlib import Path

import pytest

from harness.session import run_case

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
SOFTWARE_GL = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")

HOSTILE = """\
scenario: "<script>document.title = 'taken over'</script> & <b>bold</b>"
# </script><script>document.title = 'taken over'</script>
robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}
world: lesson_ur
seed: 3
steps:
  - move_to: mogi_home
    id: <img src=x onerror=alert(1)>
  - move_to: {pose: {frame: base_link, xyz: [0.9, 0, 0.3], quat_wxyz: [1, 0, 0, 0]}}
    id: too_far
    expect_error: NO_IK_SOLUTION
  - ptp: {joints: {shoulder_pan_joint: -1.2}}
    id: swing
    expect:
      - duration: {at_most: 0.2}
  - gripper: closed
expect:
  - named_target: mogi_home
  - tracking_error: {max: 0.05}
  - clearance: {at_least: 0.01}
"""


@pytest.fixture(scope="session")
def browser():
    """Debian's chromium, drawn in software, without a network."""
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        if os.environ.get("CI") == "true":
            pytest.fail("no chromium is installed, and CI must open the pages in one")
        pytest.skip("no chromium is installed: apt-get install chromium")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=list(SOFTWARE_GL))
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def failed_run(tmp_path_factory):
    """The folder of a run of which one step's and one final expectation do not hold."""
    folder = tmp_path_factory.mktemp("failed")
    file = folder / "hostile.scenario.yaml"
    file.write_text(HOSTILE)
    result = run_case(file, report_dir=folder / "run")
    assert result.outcome == "failed", result.message
    assert Path(result.page) == folder / "run" / "report.html"
    return folder / "run"


class Visit:
    """An open page, and everything that went wrong or went out."""

    def __init__(self, page):
        self.page = page
        self.complaints = []
        self.requests = []
        page.on("console", lambda m: m.type == "error" and self.complaints.append(m.text))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))

    def time(self):
        return float(self.page.get_attribute("#track", "aria-valuenow"))

    def text(self, selector):
        return self.page.inner_text(selector)


@pytest.fixture(scope="module")
def visit(browser):
    """Opens a page from disk and waits for it; at the end nothing may have gone wrong."""
    opened = []

    def open_page(file, place="", **options):
        size = {"width": options.pop("width", 1100), "height": options.pop("height", 720)}
        scripts = options.pop("scripts", True)
        context = browser.new_context(
            viewport=size, java_script_enabled=scripts, offline=True, **options
        )
        visit = Visit(context.new_page())
        opened.append((context, visit))
        visit.page.goto(f"{Path(file).as_uri()}{place}")
        if scripts:
            visit.page.wait_for_function("document.documentElement.dataset.ready === 'yes'")
        return visit

    yield open_page
    for context, visit in opened:
        context.close()
        assert visit.complaints == []
        asked = [url for url in visit.requests if not url.startswith(("file:", "data:", "blob:"))]
        assert asked == [], "the page asked the network for something"
