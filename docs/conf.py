"""The documentation site: `make site` builds it from the pages of the repository with Sphinx.

The README is its front page. The pages stay plain Markdown, which any viewer of the repository
shows: what only the site needs, such as the table of contents, is added while they are read.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path

from sphinx.application import Sphinx

sys.path.insert(0, str(Path(__file__).parents[1]))
from docs.generators.live_gallery import run_lessons, with_pages
from harness import __version__

ROOT = Path(__file__).parents[1]
CONTENTS = "docs/README"
"""The page whose tables list the pages of the site."""

project, version, release = "armharness", __version__, __version__
copyright = "the armharness authors"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = "armharness"
html_copy_source = False
html_show_sphinx = False
html_static_path = ["static"]
html_css_files = ["site.css"]
source_suffix = {".md": "markdown"}
root_doc = "README"
include_patterns = [
    "*.md",
    "docs/**",
    "scenarios/**",
    "robots/**",
    "worlds/**",
    "reports/README.md",
]
exclude_patterns = ["docs/generators/**"]
myst_heading_anchors = 4
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"exclude-members": "model_config, model_post_init"}


LINK = re.compile(r"\[([^\]]*)\]\(([\w./-]+)\)")


def lead_to_pages(_app: Sphinx, page: str, text: list[str]) -> None:
    """Let links to folders lead to their README; a folder without one is named alone."""

    def link(found: re.Match[str]) -> str:
        shown, target = found.groups()
        folder = (ROOT / page).parent / target
        if not folder.is_dir():
            return found[0]
        return (
            f"[{shown}]({target.rstrip('/')}/README.md)"
            if (folder / "README.md").is_file()
            else shown
        )

    text[0] = LINK.sub(link, text[0])


def add_contents(app: Sphinx, page: str, text: list[str]) -> None:
    """Add the table of contents to the front page, as the tables of `docs/README.md` have it.

    Pages in a folder with the name of a page, as in `docs/reference/api`, stand below that page.
    """
    below = sorted(each for each in app.env.found_docs if each.startswith(f"{page}/"))
    if page != root_doc and below:
        text[0] += _toctree("", below)
    if page != root_doc:
        return
    listed = (ROOT / f"{CONTENTS}.md").read_text(encoding="utf-8")
    found = {*app.env.found_docs}
    left = {each for each in found - {root_doc} if str(Path(each).parent) not in found}
    sections = [part.partition("\n")[::2] for part in re.split(r"(?m)^## ", listed)[1:]]
    for title, rows in sections:
        named = re.findall(r"\]\(([\w/.]+)\.md\)", rows)
        pages = [os.path.normpath(f"{CONTENTS}/../{name}") for name in named]
        text[0] += _toctree(title, [each for each in dict.fromkeys(pages) if each in left])
        left -= {*pages}
    text[0] += _toctree("More", sorted(left))


def _toctree(title: str, pages: list[str]) -> str:
    caption = f":caption: {title}\n" if title else ""
    entries = "".join(f"/{page}\n" for page in pages)
    return f"\n\n```{{toctree}}\n:hidden:\n{caption}\n{entries}```\n"


def show_lessons_alive(app: Sphinx, page: str, text: list[str]) -> None:
    """Put the film and the report page of each lesson below its picture in the gallery."""
    if page == "docs/gallery" and app.config.gallery_runs:
        text[0] = with_pages(text[0], app.config.gallery_runs)


def run_gallery(app: Sphinx, error: Exception | None) -> None:
    """Run the lessons of the gallery; their reports are a part of the site."""
    if error is None and app.builder.format == "html" and app.config.gallery_runs:
        run_lessons(Path(app.outdir), app.config.gallery_runs)


def write_texts(app: Sphinx, error: Exception | None) -> None:
    """Write `llms.txt`, which lists the pages for language models, and the site as a zip file."""
    if error is not None or app.builder.format != "html":
        return
    site = Path(app.outdir)
    lines = ["# armharness", "", "> Scenarios of robot arms: planned, simulated, judged.", ""]
    for page in sorted(app.env.found_docs):
        text = Path(app.env.doc2path(page)).read_text(encoding="utf-8")
        paragraphs = [each for each in text.split("\n\n") if each[:1].isalpha()]
        first = " ".join(paragraphs[0].split()) if paragraphs else ""
        shown = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", first)
        lines.append(f"- [{app.env.titles[page].astext()}]({page}.html): {shown}")
    (site / "llms.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (site / "index.html").write_text(
        f'<!doctype html><meta http-equiv="refresh" content="0; url={root_doc}.html">\n',
        encoding="utf-8",
    )
    archive = shutil.make_archive(str(site.parent / "armharness-site"), "zip", site)
    shutil.move(archive, site / "armharness-site.zip")


def setup(app: Sphinx) -> None:
    """Connect the additions to Sphinx; `-D gallery_runs=0` builds without running lessons."""
    app.add_config_value("gallery_runs", 100, "env", int)  # lessons at most: all
    app.connect("source-read", lead_to_pages)
    app.connect("source-read", add_contents)
    app.connect("source-read", show_lessons_alive)
    app.connect("build-finished", run_gallery)
    app.connect("build-finished", write_texts)
