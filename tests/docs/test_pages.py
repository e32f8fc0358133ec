"""Every link in every page leads to a file or a heading that exists."""

import re
import unicodedata
from functools import cache

import pytest

from docs import ROOT
from docs.generators.floors import floors_picture, layers

FOLDERS = ("docs", "scenarios", "robots", "worlds")
PAGES = sorted(
    [*ROOT.glob("*.md"), ROOT / "reports/README.md"]
    + [page for folder in FOLDERS for page in (ROOT / folder).rglob("*.md")]
)
PICTURES = ("svg", "png", "jpg")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
CODE = re.compile(r"(?ms)^```.*?^```$")


def name(page):
    return page.relative_to(ROOT).as_posix()


def links(text):
    """Relative targets of the links and pictures of a page, outside of its code blocks."""
    return [target for target in LINK.findall(CODE.sub("", text)) if ":" not in target]


@cache
def anchors(page):
    """The fragment of each heading, as GitHub derives it."""
    seen, found = {}, set()
    for title in re.findall(r"(?m)^#+ +(.*?) *$", CODE.sub("", page.read_text(encoding="utf-8"))):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).lower()
        kept = [c for c in words if c in "-_ " or unicodedata.category(c)[0] in "LN"]
        anchor = "".join(kept).replace(" ", "-")
        count = seen[anchor] = seen.get(anchor, -1) + 1
        found.add(f"{anchor}-{count}" if count else anchor)
    return found


def broken_links(page, text):
    """The links of a page that lead nowhere."""
    return [target for target in links(text) if not leads_somewhere(page, target)]


def leads_somewhere(page, target):
    path, _, fragment = target.partition("#")
    file = (page.parent / path).resolve() if path else page
    if not file.exists() or not file.is_relative_to(ROOT):
        return False
    return not fragment or (file.suffix == ".md" and fragment in anchors(file))


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_every_link_of_a_page_leads_to_a_file_or_a_heading(page):
    assert broken_links(page, page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    "target",
    ["reference/stepz.md", "reference/steps.md#no_such_step", "#no-heading", "../../etc/hosts"],
)
def test_a_broken_link_is_found(target):
    page = ROOT / "docs/README.md"
    assert broken_links(page, f"[x]({target}) and [y](reference/steps.md#move_to)") == [target]


def test_every_page_and_picture_of_the_documentation_can_be_reached_from_the_readme():
    reached, waiting = set(), [ROOT / "README.md"]
    while waiting:
        file = waiting.pop()
        if file in reached:
            continue
        reached.add(file)
        if file.suffix == ".md":
            targets = links(file.read_text(encoding="utf-8"))
            waiting += [(file.parent / each.partition("#")[0]).resolve() for each in targets]
    pictures = [file for kind in PICTURES for file in (ROOT / "docs").rglob(f"*.{kind}")]
    assert {*PAGES, *pictures} - reached == set()


TREE = r"(?:harness|docs|tests|scenarios|robots|worlds|\.ci)"
PATH = re.compile(rf"`({TREE}/[\w./-]+)`")


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_every_path_that_a_page_names_exists(page):
    text = page.read_text(encoding="utf-8")
    new_files = re.findall(r"(?m)^`(.*)`:\n\n```", text)  # those that extending.md has written
    named = set(PATH.findall(CODE.sub("", text))) - set(new_files)
    assert [path for path in named if not (ROOT / path).exists()] == []


@pytest.mark.parametrize("container", ["harness", "harness.planning"])
def test_the_picture_of_the_floors_has_every_package_and_its_purpose(container):
    folder = ROOT / container.replace(".", "/")
    packages = {path.parent.name for path in folder.glob("*/__init__.py")}
    floors = layers(container)
    named = [package for floor in floors for package in floor]
    assert packages <= set(named)
    picture = floors_picture(container)
    drawn = re.findall(r'class="name" x="\d+" y="(\d+)">(\w+)<', picture)
    assert [package for _, package in drawn] == named
    heights = [int(y) for y, _ in drawn]
    assert heights == sorted(heights)
    assert len(set(heights)) == len(floors)


@pytest.mark.parametrize("folder", ["scenarios", "robots", "worlds"])
def test_folders_of_data_hold_short_pages_about_the_data(folder):
    for page in (ROOT / folder).rglob("*.md"):
        assert page.name == "README.md"
        assert len(page.read_text(encoding="utf-8").split()) < 500, name(page)


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_no_page_has_both_sides_of_a_merge(page):
    assert not re.search(r"(?m)^(<{7}|>{7}) ", page.read_text(encoding="utf-8"))
