"""The pictures of the floors of the package, drawn from the import contracts in pyproject.toml."""

from __future__ import annotations

import ast
import re
import textwrap
import tomllib
from html import escape

from docs import ROOT

WIDTH, MARGIN, GAP = 960, 12, 8  # [px]
LINE, PADDING = 14, 10  # height of a line of text, space above and below the text [px]
CHARACTER = 5.9  # width of a character of the text, estimated [px]
NAME_CHARACTER = 7.6  # width of a character of a name, estimated [px]
WIDE = 300  # a box of this width has its name next to the text [px]
STYLE = """\
text { font: 11px system-ui, sans-serif; fill: #1f2328; }
.name { font-weight: 700; font-size: 12.5px; }
rect { fill: #eef4fb; stroke: #6f9bd1; rx: 5; }
.page { fill: #ffffff; stroke: none; rx: 0; }"""


def layers(container: str) -> list[list[str]]:
    """The floors of a package from the top down, each with its packages and modules."""
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    [contract] = [
        each
        for each in tools["importlinter"]["contracts"]
        if each["type"] == "layers" and each["containers"] == [container]
    ]
    return [re.split(r"\s*[|:]\s*", floor) for floor in contract["layers"]]


def purpose(name: str) -> str:
    """The first sentence of the docstring of a package or module."""
    path = ROOT / name.replace(".", "/")
    package = path / "__init__.py"
    file = package if package.is_file() else path.with_suffix(".py")
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split()).rstrip(".")


def floors_picture(container: str) -> str:
    """The floors of a package as SVG: every box may import from the boxes below it."""
    floors = layers(container)
    longest = max(len(name) for floor in floors for name in floor)
    boxes, y = [], MARGIN
    for floor in floors:
        width = (WIDTH - 2 * MARGIN - GAP * (len(floor) - 1)) // len(floor)
        indent = round(NAME_CHARACTER * longest) + PADDING if width >= WIDE else 0
        columns = int((width - 2 * PADDING - indent) / CHARACTER)
        texts = [textwrap.wrap(purpose(f"{container}.{name}"), columns) for name in floor]
        lines = max(map(len, texts)) + (indent == 0)
        height = 2 * PADDING + LINE * lines - 4
        for place, (name, text) in enumerate(zip(floor, texts, strict=True)):
            x = MARGIN + place * (width + GAP)
            boxes.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}"/>')
            boxes.append(_text(x + PADDING, y, [name], ' class="name"'))
            boxes.append(_text(x + PADDING + indent, y + (0 if indent else LINE), text))
        y += height + GAP
    size = f'width="{WIDTH}" height="{y + MARGIN - GAP}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img">\n<style>\n{STYLE}\n</style>'
    return "\n".join([head, f'<rect class="page" {size}/>', *boxes, "</svg>\n"])


def _text(x: int, y: int, lines: list[str], style: str = "") -> str:
    """Lines of text from the top of a box."""
    return "\n".join(
        f'<text{style} x="{x}" y="{y + PADDING + LINE * (number + 1) - 4}">{escape(line)}</text>'
        for number, line in enumerate(lines)
    )
