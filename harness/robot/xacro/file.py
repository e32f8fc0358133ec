"""What a document says about xacro: whether it is xacro, and which arguments it takes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.core.errors import RobotOptionError
from harness.language.files.xml_file import XmlElement, read_xml
from harness.robot.xacro.render import OTHERS, PREFIX
from harness.robot.xacro.substitution import ARG

XACRO_ARG = "xacro:arg"
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
    declared = {item.get("name") for item in root.walk() if item.tag == XACRO_ARG}
    return frozenset(declared | used)


def refuse_unknown_arguments(args: Mapping[str, Any], paths: Sequence[Path]) -> None:
    """Refuse arguments that none of a robot's files declares; included files may declare them.

    Raises:
        SpecError: A file is not XML.
        RobotError: No file takes one of the arguments.
    """
    roots = {path: root for path in paths if args and is_xacro(root := read_xml(path))}
    if args and not roots:
        raise RobotOptionError("args", "only a xacro file takes arguments, and none is given")
    declared = {name for root in roots.values() for name in arguments_of(root)}
    includes = any(item.tag == "xacro:include" for root in roots.values() for item in root.walk())
    unknown = [key for key in args if key not in declared]
    if unknown and not includes:
        names = " and ".join(path.name for path in roots)
        raise RobotOptionError(
            "args",
            f"{names} takes no argument '{unknown[0]}'; "
            f"known are {', '.join(sorted(declared)) or 'none'}",
        )
