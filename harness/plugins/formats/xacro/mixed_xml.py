"""Documents whose text and elements are in one order: pieces of text are children."""

from __future__ import annotations

from harness.language.files.xml_file import XmlElement, XmlReader

TEXT = ""
LITERAL = "<![CDATA["
"""Tags of text, and of CDATA."""


class MixedReader(XmlReader):
    """Builds elements from expat's events, text among them."""

    def __init__(self, content: bytes, named: str) -> None:
        super().__init__(content, named)
        self._text_tag = TEXT
        self._parser.StartCdataSectionHandler = lambda: self._begin(LITERAL)
        self._parser.EndCdataSectionHandler = lambda: self._begin(TEXT)

    def _begin(self, tag: str) -> None:
        self._text_tag = tag

    def _text(self, data: str) -> None:
        if not self._open:
            return
        children = self._open[-1].children
        if not children or children[-1].tag != self._text_tag:
            children.append(XmlElement(self._text_tag, {}, self._here()))
        children[-1].text += data


def in_elements(root: XmlElement) -> XmlElement:
    """A mixed document as `read_xml` has one: text is in its element."""
    for element in list(root.walk()):
        is_text = [child.tag in (TEXT, LITERAL) for child in element.children]
        pairs = list(zip(element.children, is_text, strict=True))
        element.text = "".join(child.text for child, is_one in pairs if is_one)
        element.children = [child for child, is_one in pairs if not is_one]
    return root
