"""The documentation site: built without a warning, complete, and without requests elsewhere."""

import importlib
import inspect
import re
import subprocess
import sys
import zipfile
from contextlib import closing
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from tests.docs.test_public_interface import MODULES
from tests.reporting.browser import new_context

ROOT = Path(__file__).parents[2]
REQUESTING = {
    ("link", "href"),
    ("script", "src"),
    ("img", "src"),
    ("source", "src"),
    ("iframe", "src"),
    ("video", "src"),
}


class Page(HTMLParser):
    """The anchors and links of a page, and the addresses that a browser requests for it."""

    def __init__(self, path):
        super().__init__()
        self.anchors, self.links, self.requested = set(), [], []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id":
                self.anchors.add(value)
            if (tag, name) == ("a", "href"):
                self.links.append(value)
            if (tag, name) in REQUESTING:
                self.requested.append(value)


def built(folder, options, runs=0):
    """A site in a folder with some lessons in its gallery, and what Sphinx printed."""
    command = f"-m sphinx -q -D gallery_runs={runs} -b html -c docs {options} ."
    done = subprocess.run(
        [sys.executable, *command.split(), str(folder)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return folder, done.stderr


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder, warnings = built(tmp_path_factory.mktemp("site") / "html", "-W --keep-going")
    assert warnings == ""
    return folder


@pytest.fixture(scope="module")
def page_of_packages(tmp_path_factory):
    """A site of one page, without those that it links to."""
    page = "docs/reference/api/run"
    options = f"-D root_doc={page} -D include_patterns={page}.md"
    return built(tmp_path_factory.mktemp("page") / "html", options)[0]


@pytest.mark.nightly
def test_a_report_in_the_gallery_is_alive_in_a_browser(browser, tmp_path):
    """The first lesson is run for the site; its page is opened inside the gallery's and moved."""
    page = "docs/gallery"
    options = f"-D root_doc={page} -D include_patterns={page}.md"
    site, _ = built(tmp_path / "html", options, runs=1)
    with closing(new_context(browser, viewport={"width": 1440, "height": 900})) as context:
        context.set_offline(True)
        opened, errors = context.new_page(), []
        opened.on("pageerror", lambda error: errors.append(str(error)))
        opened.goto((site / f"{page}.html").as_uri())
        opened.click(".report summary")
        frame = opened.frame_locator(".report iframe")
        frame.locator("#view canvas").wait_for()
        before = frame.locator("#view canvas").screenshot()
        frame.locator("#track").focus()
        frame.locator("#track").press("End")
        frame.locator("#track:not([aria-valuenow='0.000'])").wait_for()
        assert frame.locator("#view canvas").screenshot() != before
        video = opened.locator("video").first
        assert video.evaluate("each => new Promise(done => {"
                              "each.addEventListener('loadeddata', () => done(true));"
                              "each.addEventListener('error', () => done(false));"
                              "each.load(); })")  # fmt: skip
        assert errors == []


@pytest.fixture(scope="module")
def pages(site):
    return {path: Page(path) for path in site.rglob("*.html")}


@pytest.mark.nightly
def test_every_page_of_the_documentation_is_on_the_site(site, pages):
    named = {path.relative_to(ROOT).with_suffix(".html") for path in (ROOT / "docs").rglob("*.md")}
    assert named <= {path.relative_to(site) for path in pages}
    listed = (site / "llms.txt").read_text(encoding="utf-8")
    assert all(f"({path.as_posix()})" in listed for path in named)
    with zipfile.ZipFile(site / "armharness-site.zip") as archive:
        kept = {Path(name) for name in archive.namelist()}
    files = {path.relative_to(site) for path in site.rglob("*") if path.is_file()}
    assert files - kept == {Path("armharness-site.zip")}


@pytest.mark.nightly
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_no_page_of_the_site_is_wider_than_a_phone(site, pages, browser, scheme):
    size = {"width": 390, "height": 844}
    with closing(new_context(browser, viewport=size, color_scheme=scheme)) as context:
        context.set_offline(True)
        opened, errors = context.new_page(), []
        opened.on("pageerror", lambda error: errors.append(str(error)))
        for path in sorted(pages.keys() - {site / "index.html"}):  # which leads to another page
            opened.goto(path.as_uri())
            wide = opened.evaluate("document.documentElement.scrollWidth - innerWidth")
            assert wide <= 0, path.relative_to(site)
        assert errors == []


@pytest.mark.nightly
def test_every_link_and_anchor_of_the_site_exists(site, pages):
    broken = []
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = path if not parts.path else (path.parent / unquote(parts.path)).resolve()
            if not target.exists():
                broken.append((path.relative_to(site).as_posix(), link))
            elif parts.fragment and target in pages:
                anchors = pages[target].anchors
                if unquote(parts.fragment) not in anchors:
                    broken.append((path.relative_to(site).as_posix(), link))
    assert broken == []


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["site", "page_of_packages"])
def test_the_site_requests_nothing_from_other_hosts(name, request):
    site = request.getfixturevalue(name)
    pages = {path: Page(path) for path in site.rglob("*.html")}
    requested = [link for page in pages.values() for link in page.requested]
    assert [link for link in requested if urlsplit(link).netloc] == []
    code = [path for kind in ("*.css", "*.js") for path in site.rglob(kind)]
    assert code
    for path in code:
        text = path.read_text(encoding="utf-8")
        loads = r"(?:@import|url\(|fetch\(|importScripts\(|\.src\s*=)\s*['\"]?https?://"
        assert not re.search(loads, text), path


def test_the_interface_of_packages_has_its_signatures(page_of_packages):
    text = (page_of_packages / "docs/reference/api/run.html").read_text(encoding="utf-8")
    for name in ("harness.run", "harness.recording.read_run.read_run", "harness.recording.run.Run"):
        assert f'id="{name}"' in text


@pytest.mark.nightly
@pytest.mark.parametrize("module", MODULES)
def test_every_public_class_and_function_has_its_signature(module, pages):
    reference = [page for path, page in pages.items() if "api" in path.parts]
    described = {anchor.rpartition(".")[2] for page in reference for anchor in page.anchors}
    loaded = importlib.import_module(module)
    names = getattr(loaded, "__all__", None) or [
        name for name, value in vars(loaded).items() if getattr(value, "__module__", "") == module
    ]
    public = [name for name in names if inspect.isroutine(getattr(loaded, name))]
    public += [name for name in names if inspect.isclass(getattr(loaded, name))]
    assert [name for name in public if name not in described and name[0] != "_"] == []
