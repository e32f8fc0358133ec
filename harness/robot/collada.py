"""Checks of a COLLADA file before a library reads it: its unit, and how much its scene repeats."""

from __future__ import annotations

import re
from functools import cache

from harness.core.errors import RobotError, SpecError
from harness.core.limits import COLLADA_NODES
from harness.language.files.xml_file import XmlElement, parse_xml

HEADER = 20_000  # The first bytes of a file, which have its unit

UNIT = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']\s*([0-9.eE+-]+)\s*[\"']")
ROOT = b"<COLLADA"


def metres_of_unit(content: bytes, name: str) -> float:
    """Metres of the unit of a COLLADA file.

    Raises:
        RobotError: It is not a COLLADA file.
    """
    header = content[:HEADER]
    if ROOT not in header:
        raise RobotError(f"{name} is not a COLLADA file")
    found = UNIT.search(header)
    unit = float(found[1]) if found else 1.0
    return unit if unit > 0 else 1.0


def refuse_unreadable(content: bytes, name: str) -> None:
    """Refuse a file that a reader of COLLADA cannot be given.

    Raises:
        RobotError: It is not well-formed, declares a document type, or nodes of its scene repeat
            each other in a circle or too often.
    """
    try:
        root = parse_xml(content, name)
    except SpecError as error:
        first = error.problems[0]
        message = f"{name} cannot be read: line {first.line}: {first.message}"
        raise RobotError(message) from error
    nodes = {item.get("id"): item for item in root.walk() if item.tag == "node"}
    open_nodes: set[int] = set()

    @cache
    def instances(node: XmlElement) -> int:
        if id(node) in open_nodes:
            raise RobotError(f"{name} is damaged: node '{node.get('id')}' contains itself")
        open_nodes.add(id(node))
        inside = [child for child in node.children if child.tag == "node"]
        inside += [
            nodes[target]
            for child in node.findall("instance_node")
            if (target := child.get("url").removeprefix("#")) in nodes
        ]
        count = 1 + sum(map(instances, inside))
        open_nodes.remove(id(node))
        if count > COLLADA_NODES:
            raise RobotError(f"{name} repeats its nodes more than {COLLADA_NODES} times")
        return count

    try:
        for node in nodes.values():
            instances(node)
    except RecursionError as error:
        raise RobotError(f"{name} is damaged: its nodes repeat each other too deeply") from error
