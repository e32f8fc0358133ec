"""XML files as elements that know their places: data only, bounded, no DOCTYPE, no entities."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from harness.core.errors import Problem, SpecError
from harness.core.inputs import read_bounded
from harness.core.limits import LONGEST_NAME, XML_ATTRIBUTES, XML_ELEMENTS, XML_FILE, XML_LEVELS
from harness.language.files.source import Place, Source

QUOTED_ROOTS = ("robot", "mujoco", "mujocoinclude", "sdf", "world", "model")
"""Root elements of robots and worlds. A scenario can name any file of the machine, so messages
quote only files that are of these kinds."""


@dataclass(eq=False)
class XmlElement:
    """An element.

    Attributes:
        tag: The tag with its prefix as written; namespaces are not resolved.
        text: All of its own character data.
    """

    tag: str
    attributes: dict[str, str]
    place: Place
    children: list[XmlElement] = field(default_factory=list["XmlElement"])
    text: str = ""

    def find(self, tag: str) -> XmlElement | None:
        return next((child for child in self.children if child.tag == tag), None)

    def findall(self, tag: str) -> list[XmlElement]:
        return [child for child in self.children if child.tag == tag]

    def walk(self) -> Iterator[XmlElement]:
        """The element and everything in it, in file order."""
        yield self
        for child in self.children:
            yield from child.walk()

    def get(self, name: str, default: str = "") -> str:
        return self.attributes.get(name, default)

    def need(self, name: str) -> str:
        """An attribute that must be there."""
        if name not in self.attributes:
            self.refuse(f"<{self.tag}> lacks its attribute '{name}'")
        return self.attributes[name]

    def name(self) -> str:
        """Its `name`, which must be there and of a length that every file can hold."""
        name = self.need("name")
        if len(name) > LONGEST_NAME:
            self.refuse(f"a name has at most {LONGEST_NAME} characters, this one {len(name)}")
        return name

    def problem(self, message: str, hint: str = "", *, at: str = "") -> Problem:
        return (self.place_of(at) if at else self.place).problem(message, hint)

    def refuse(self, message: str, hint: str = "", *, at: str = "") -> NoReturn:
        """Raise a mistake at the element, or at the value of its attribute `at`."""
        raise SpecError([self.problem(message, hint, at=at)])

    def place_of(self, name: str) -> Place:
        """The place of an attribute's value; the element's place where that is unknown."""
        source, line = self.place.source, self.place.line
        pattern = re.compile(rf"(?<![\w:.-]){re.escape(name)}\s*=\s*[\"']")
        begin = self.place.column - 1
        while 0 < line <= len(source.lines) and line < self.place.line + 40:
            text = source.line(line)
            found = pattern.search(text, begin)
            if found:
                length = len(self.attributes.get(name, "")) or 1
                return Place(source, line, found.end() + 1, length)
            if ">" in text[begin:]:
                break
            line, begin = line + 1, 0
        return self.place


def read_xml(path: Path) -> XmlElement:
    """The root element of a file.

    Raises:
        SpecError: It cannot be read, is too large, is not well-formed, or declares a document
            type; with line and column.
    """
    return parse_xml(read_bounded(path, "XML file", XML_FILE), str(path))


def parse_xml(content: str | bytes, named: str) -> XmlElement:
    """The root element of a document; see `read_xml`."""
    return XmlReader(content, named).root()


INVALID_TOKEN = expat.errors.codes[expat.errors.XML_ERROR_INVALID_TOKEN]
UNFINISHED = {
    expat.errors.codes[each]
    for each in (
        expat.errors.XML_ERROR_NO_ELEMENTS,
        expat.errors.XML_ERROR_UNCLOSED_TOKEN,
        expat.errors.XML_ERROR_TAG_MISMATCH,
    )
}
"""What expat says of a file that ends, or closes another element, before one is closed."""


class XmlReader:
    """Builds elements from expat's events."""

    def __init__(self, content: str | bytes, named: str) -> None:
        self._content = content
        text = content if isinstance(content, str) else content.decode("utf-8", errors="replace")
        self._source = Source(named, tuple(re.split("\r\n|\r|\n", text)))
        self._open: list[XmlElement] = []
        self._root: XmlElement | None = None
        self._count = 0
        self._parser = expat.ParserCreate()
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._text
        self._parser.StartDoctypeDeclHandler = self._doctype

    def root(self) -> XmlElement:
        """The root element; raises SpecError as `read_xml` does."""
        try:
            self._parser.Parse(self._content, True)
        except expat.ExpatError as error:
            place = Place(self._quoted(), error.lineno, error.offset + 1)
            reason = expat.errors.messages.get(error.code, "")
            message = f"not well-formed XML: {reason or expat.ErrorString(error.code)}"
            raise SpecError([place.problem(message, self._advice(error.code))]) from error
        except (LookupError, ValueError) as error:  # the encoding that it declares
            raise SpecError(
                [Place(self._quoted(), 1, 1).problem(str(error), "write the file in UTF-8")]
            ) from error
        assert self._root is not None
        return self._root

    def _advice(self, code: int) -> str:
        if code == INVALID_TOKEN:
            return "write `&amp;` for &, `&lt;` for <, values in quotes, and no `--` in a comment"
        if code not in UNFINISHED or not self._open or not self._quoted().lines:
            return ""
        last = self._open[-1]
        return f"<{last.tag}> of line {last.place.line} is not closed before this"

    def _quoted(self, tag: str = "") -> Source:
        """The file; without its text, which messages quote, unless it is of a kind that is read."""
        root = self._root.tag if self._root is not None else tag
        return self._source if root in QUOTED_ROOTS else Source(self._source.path)

    def _here(self, tag: str = "") -> Place:
        parser = self._parser
        return Place(self._quoted(tag), parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if self._count > XML_ELEMENTS:
            self._refuse(f"more than {XML_ELEMENTS} elements")
        if len(attributes) > XML_ATTRIBUTES:
            self._refuse(f"<{tag}> has more than {XML_ATTRIBUTES} attributes")
        if len(self._open) >= XML_LEVELS:
            self._refuse(f"elements are nested more than {XML_LEVELS} deep")
        here = self._here(tag)
        place = Place(here.source, here.line, here.column + 1, len(tag))  # after the bracket
        element = XmlElement(tag, attributes, place)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self._root = element
        self._open.append(element)

    def _end(self, _tag: str) -> None:
        self._open.pop()

    def _text(self, data: str) -> None:
        if self._open:
            self._open[-1].text += data

    def _doctype(self, *_declaration: object) -> None:
        """Refuse it; what it declares is not quoted, as the kind of file is not known yet."""
        here = self._here()
        shown = "<!DOCTYPE".ljust(here.column - 1) + "..."
        lines = ("",) * (here.line - 1) + (shown,)
        place = Place(Source(here.source.path, lines), here.line, here.column, 3)
        raise SpecError(
            [place.problem("a DOCTYPE, and with it entities, is not read", "remove it")]
        )

    def _refuse(self, message: str, hint: str = "") -> NoReturn:
        raise SpecError([self._here().problem(message, hint)])
