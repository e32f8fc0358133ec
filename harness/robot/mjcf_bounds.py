"""What an MJCF file may ask for: a few words of it make MuJoCo take any amount of memory."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from harness.spec.xml_file import XmlElement

MOST: Mapping[str, Mapping[str, int]] = {
    "texture": {"width": 8192, "height": 8192 * 6},
    "hfield": {"nrow": 2048, "ncol": 2048},
    "mesh": {"params": 100},
    "size": dict.fromkeys(
        (
            "nkey", "nuserdata", "nuser_body", "nuser_jnt", "nuser_geom", "nuser_site", "nuser_cam",
            "nuser_tendon", "nuser_actuator", "nuser_sensor",
        ),
        1000,
    ),
}  # fmt: skip
"""Largest numbers in attributes, by element; the height of a cube's picture has its six sides."""

MOST_COPIES = 1000
"""Copies that all `<replicate>` together make."""

UNUSED = {
    "composite": "bodies that bend are no part of an arm",
    "flexcomp": "bodies that bend are no part of an arm",
    "extension": "plugins are not loaded",
    "model": "models of other files are not attached",
}


def refuse_unbounded(roots: Sequence[XmlElement]) -> None:
    """Refuse what a robot has no use for, and numbers that would not end.

    Raises:
        SpecError: At the element or its attribute.
    """
    copies = 1.0
    for item in (item for root in roots for item in root.walk()):
        if item.tag in UNUSED:
            item.refuse(UNUSED[item.tag], f"remove the <{item.tag}>")
        for name, most in MOST.get(item.tag, {}).items():
            if max(_numbers(item.get(name)), default=0.0) > most:
                item.refuse(f"<{item.tag}> has a {name} above {most}", at=name)
        if item.tag == "replicate":
            copies *= max(_numbers(item.get("count")), default=1.0)
            if copies > MOST_COPIES:
                item.refuse(f"more than {MOST_COPIES} copies are made", at="count")


def _numbers(text: str) -> list[float]:
    """The numbers of an attribute; what is none, and so refused by MuJoCo, counts as endless."""
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return [math.inf]
    return [math.inf if math.isnan(value) else value for value in values]
