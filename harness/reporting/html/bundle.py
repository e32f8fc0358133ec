"""The page's scripts, styles and content policy; modules keep their own scope."""

from __future__ import annotations

import base64
import hashlib
import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jinja2 import Environment

FOLDER = Path(__file__).with_name("page")
TEMPLATE = FOLDER / "page.html"
IMPORT = re.compile(r'^import \{([^}]*)\} from "\./([\w-]+\.js)";$', re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:async )?(?:function|const|class) (\w+))", re.MULTILINE)


@cache
def script(entry: Path = FOLDER / "main.js") -> str:
    """Every module that an entry needs, as one classic script; from its folder or the run page's.

    A browser refuses to import modules from disk, so each becomes a function that returns what it
    exports, in the order of their imports.
    """
    modules: dict[str, str] = {}
    _collect(entry, modules, ())
    return "\n".join(modules.values())


@cache
def style() -> str:
    """The style sheet."""
    return theme() + _read("page.css")


@cache
def theme() -> str:
    """The colours, of this page and of others."""
    return _read("theme.css")


def _collect(file: Path, modules: dict[str, str], importing: tuple[str, ...]) -> None:
    name = file.name
    if name in modules:
        return
    if name in importing:
        raise ValueError(f"modules import each other: {' -> '.join((*importing, name))}")
    text = file.read_text(encoding="utf-8")
    for _, needed in IMPORT.findall(text):
        own = file.with_name(needed)
        _collect(own if own.is_file() else FOLDER / needed, modules, (*importing, name))
    exported = ", ".join(EXPORT.findall(text))
    text = IMPORT.sub(lambda match: f"const {{{match[1]}}} = {_variable(match[2])};", text)
    text = EXPORT.sub("", text)
    modules[name] = f"const {_variable(name)} = (() => {{\n{text}return {{ {exported} }};\n}})();"


def _variable(name: str) -> str:
    return "module_" + name.removesuffix(".js").replace("-", "_")


def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")


_SCRIPTS = re.compile(r"<script>(.*?)</script>", re.DOTALL)
_STYLES = re.compile(r"<style>(.*?)</style>", re.DOTALL)


def rendered(file: Path, *, script: str, style: str, **content: object) -> str:
    """A self-contained page of a template, in which every text of a run stays text.

    Args:
        file: The template; it includes those of its folder, or of the run page.
    """
    from markupsafe import Markup

    policy = content_policy(file.read_text(encoding="utf-8"), script=script, style=style)
    return (
        templates(file.parent)
        .get_template(file.name)
        .render(policy=policy, script=Markup(script), style=Markup(style), **content)
    )


@cache
def templates(folder: Path) -> Environment:
    """The templates of a folder, then the run page's; each is compiled when it is used first."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # not before it is needed

    environment = Environment(
        loader=FileSystemLoader([folder, FOLDER]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        keep_trailing_newline=True,
    )
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    return environment


def content_policy(skeleton: str, *, script: str, style: str) -> str:
    """The Content-Security-Policy of a page [1].

    Nothing is fetched, embedded or sent anywhere, and no script or style runs but those of the
    skeleton, by their hashes. Attributes may style an element, which is how bars get their length.

    Args:
        skeleton: The page's template, which no data of a run is in yet.

    References:
        [1] W3C, "Content Security Policy Level 3".
    """
    page = skeleton.replace("{{ script }}", script).replace("{{ style }}", style)
    scripts, styles = (_hashes(found.findall(page)) for found in (_SCRIPTS, _STYLES))
    return (
        f"default-src 'none'; script-src {scripts}; style-src {styles};"
        " style-src-attr 'unsafe-inline'; img-src data: blob:; media-src blob:;"
        " base-uri 'none'; form-action 'none'"
    )


def _hashes(texts: list[str]) -> str:
    digests = (hashlib.sha256(text.encode()).digest() for text in texts)
    return " ".join(f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests)
