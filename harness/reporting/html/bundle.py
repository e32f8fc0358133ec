"""The page's scripts and styles as one text each; modules keep their own scope."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).with_name("page")
ENTRY = "main.js"
IMPORT = re.compile(r'^import \{([^}]*)\} from "\./([\w-]+\.js)";$', re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:async )?(?:function|const|class) (\w+))", re.MULTILINE)


@cache
def script() -> str:
    """Every module that `main.js` needs, as one classic script.

    A browser refuses to import modules from disk, so each becomes a function that returns what it
    exports, in the order of their imports.
    """
    modules: dict[str, str] = {}
    _collect(ENTRY, modules, ())
    return "\n".join(modules.values())


@cache
def style() -> str:
    """The style sheet."""
    return theme() + _read("page.css")


@cache
def theme() -> str:
    """The colours, of this page and of others."""
    return _read("theme.css")


@cache
def skeleton() -> str:
    """The page's elements that scripts fill."""
    return _read("page.html")


def _collect(name: str, modules: dict[str, str], importing: tuple[str, ...]) -> None:
    if name in modules:
        return
    if name in importing:
        raise ValueError(f"modules import each other: {' -> '.join((*importing, name))}")
    text = _read(name)
    for _, needed in IMPORT.findall(text):
        _collect(needed, modules, (*importing, name))
    exported = ", ".join(EXPORT.findall(text))
    text = IMPORT.sub(lambda match: f"const {{{match[1]}}} = {_variable(match[2])};", text)
    text = EXPORT.sub("", text)
    modules[name] = f"const {_variable(name)} = (() => {{\n{text}return {{ {exported} }};\n}})();"


def _variable(name: str) -> str:
    return "module_" + name.removesuffix(".js").replace("-", "_")


def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")
