"""What a document says about xacro: whether it is xacro, and which arguments it takes."""

from __future__ import annotations

import re
from collections.abc import Iterator

from harness.language.files.xml_file import XmlElement

PREFIX = "xacro:"
ARG = re.compile(r"\$\(arg +([^ )]+) *\)")
OTHERS = ("gazebo", "ros2_control", "transmission")
"""Elements of a robot that are for other programs."""

SUBSTITUTION = re.compile(r"\$\([^)]*\)|\$\{[^}]*\}")


def is_xacro(root: XmlElement) -> bool:
    """Whether a document has parts that xacro replaces."""
    return next(xacro_parts(root), None) is not None


def xacro_parts(root: XmlElement) -> Iterator[tuple[XmlElement, str, str]]:
    """What xacro replaces in a robot's document: the element, its attribute if any, and the text.

    Attributes in elements for other programs, such as `<gazebo>`, do not count.
    """
    for item in root.walk():
        if item.tag.startswith(PREFIX):
            yield item, "", f"<{item.tag}>"
    for item in (item for each in root.children if each.tag not in OTHERS for item in each.walk()):
        for key, value in item.attributes.items():
            if found := SUBSTITUTION.search(value):
                yield item, key, found[0]


def arguments_of(root: XmlElement) -> frozenset[str]:
    """Names that a xacro document declares or uses as arguments."""
    texts = [text for item in root.walk() for text in (*item.attributes.values(), item.text)]
    used = {found[1] for text in texts for found in ARG.finditer(text)}
    declared = {item.get("name") for item in root.walk() if item.tag == f"{PREFIX}arg"}
    return frozenset(declared | used)
