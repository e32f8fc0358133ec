"""Text that is safe to show: no part of it controls a terminal, a log viewer or a CI service."""

from __future__ import annotations

import os
import re
import unicodedata

ESC = f"\x1b{os.urandom(8).hex()}"
"""The escape character of the program's own control sequences.

Its second part differs in each process, so that no text from a file can contain one. `printable`
keeps it, and `terminal_text` turns it into the escape character that a terminal expects.
"""

_UNSAFE = (
    r"\x00-\x1f\x7f-\x9f"  # C0 and C1 controls: ESC, OSC, CSI, BEL, line ends
    r"\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"  # direction of text
    r"\u2028\u2029\ufeff\ufff9-\uffff"  # line separators, marks without a glyph
    r"\ud800-\udfff"  # surrogates: bytes of file names that are not UTF-8
    r"\U000e0000-\U000e007f"  # tags, which are invisible
)
_COMMAND = r"#(?=#\[|#vso\[|#teamcity\[)"  # where GitHub, Azure and TeamCity read a command

_IN_A_LINE = re.compile(f"{ESC}|[{_UNSAFE}]|{_COMMAND}")
_IN_JSON = re.compile(f"(?!\n)[{_UNSAFE}]|{_COMMAND}")
_COMMAND_LINE = re.compile(r"^( *):(?=:)")  # where GitHub reads a command

_STYLING = re.compile(rf"{ESC}(?:\[\d+m|\]8;;[^\x1b]*{ESC}\\)")
"""Control sequences of colours and links, which have no width."""


def counted(count: int, noun: str) -> str:
    """`1 case`, `2 cases`."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def printable(text: str) -> str:
    r"""The text as one line, with every control, direction and line end as `\x1b`, `\u202e`, `\n`.

    Applying it twice changes nothing more.
    """
    if text.isascii() and text.isprintable() and "#" not in text:
        return text
    return _IN_A_LINE.sub(_escaped, text)


def printable_lines(text: str) -> str:
    """The text with its lines kept, tabs as spaces, and everything else as `printable` has it."""
    lines = text.replace("\r\n", "\n").expandtabs(4).split("\n")
    return "\n".join(map(printable, lines))


def json_printable(text: str) -> str:
    r"""The JSON text with the same meaning in which such characters are `\u` escapes."""
    if text.isascii() and text.isprintable() and "#" not in text:
        return text
    import json  # here: `harness --help` has no use for it

    def escaped(match: re.Match[str]) -> str:
        return r"\u0023" if match[0] == "#" else json.dumps(match[0])[1:-1]

    return _IN_JSON.sub(escaped, text)


def terminal_text(line: str) -> str:
    """A line as it is written to a terminal or a log, with the program's own colours and links.

    A line that a CI service would take for a command is shown with its first sign escaped.
    """
    return _COMMAND_LINE.sub(r"\1\\x3a", printable(line)).replace(ESC, "\x1b")


def columns_of(line: str) -> int:
    """Columns that a terminal gives a printable line: 2 for wide characters, 0 for combining."""
    text = _STYLING.sub("", line)
    return len(text) if text.isascii() else sum(map(_columns, text))


def fitted(line: str, columns: int, end: str = "") -> list[str]:
    """The printable line in parts that fit a terminal, the later ones indented.

    Args:
        end: Suffix of each part except the last, such as a shell's continuation character.

    Returns:
        Parts broken at spaces; a word that is wider than the terminal stays whole.
    """
    if columns_of(line) <= columns:
        return [line]
    indent = " " * min(len(line) - len(line.lstrip(" ")) + 4, columns // 2)
    parts = [""]
    for word in re.findall(r" *[^ ]+", line):
        if parts[-1].strip() and columns_of(parts[-1] + word + end) > columns:
            parts[-1] += end
            parts.append(indent + word.lstrip(" "))
        else:
            parts[-1] += word
    return parts


def cropped(line: str, columns: int) -> str:
    """The printable line without colours and links, its middle left out where it is too long."""
    text = _STYLING.sub("", line)
    if columns_of(text) <= columns:
        return text
    head, tail = text, text[-(columns // 3) :]
    while head and columns_of(f"{head}...{tail}") > columns:
        head = head[:-1]
    return f"{head}...{tail}"


def _columns(character: str) -> int:
    if unicodedata.combining(character) or not character.isprintable():
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def _escaped(match: re.Match[str]) -> str:
    found = match[0]
    if found == "#":
        return r"\x23"
    return found if found == ESC else found.encode("unicode_escape").decode("ascii")
