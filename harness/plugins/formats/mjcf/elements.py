"""The XML elements of an MJCF scene: their places, and those that have no effect."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.notes import Notes

LEFT_OUT: Mapping[str, str] = {
    "actuator": "objects have no motors; those of a robot belong to `robot:`",
    "sensor": "expectations observe the run",
    "tendon": "objects are rigid and have no tendons",
    "equality": "objects are not connected to each other",
    "contact": "all objects can touch each other",
    "deformable": "objects are rigid",
    "keyframe": "objects start at the poses of their bodies",
    "camera": "add it to `cameras` of the scenario",
    "site": "poses are given in the frames of objects",
}
"""Elements without an effect, and why."""

UNREAD_OF_GEOMS = ("condim", "priority", "solmix", "solref", "solimp", "margin", "gap")
READ_OF_OPTION = ("timestep", "gravity")


class Elements:
    """The elements of a file and of its includes."""

    def __init__(self, roots: Sequence[XmlElement]) -> None:
        self.root = roots[0]
        self._all = [item for root in roots for item in root.walk()]
        self._named = {(item.tag, item.get("name")): item for item in self._all}
        self._at = {(item.tag, f"line {item.place.line}"): item for item in reversed(self._all)}

    def of(self, part: Any, tag: str) -> XmlElement:
        """The element of a part of the MjSpec; the root where it is unknown."""
        found = self._named.get((tag, part.name)) if part.name else None
        return found or self._at.get((tag, part.info), self.root)

    def note_unread(self, notes: Notes) -> None:
        """Add a note for each kind of element or attribute that has no effect."""
        defaults = [item for item in self._all if item.tag == "default"]
        in_defaults = {id(item) for each in defaults for item in each.walk()}
        for item in self._all:
            is_part = item.tag in ("camera", "site") and id(item) not in in_defaults
            if item.tag in LEFT_OUT and (item.children or is_part):
                notes.add(item.place, f"<{item.tag}> is left out: {LEFT_OUT[item.tag]}")
            unread: Sequence[str] = ()
            if item.tag == "geom":
                unread = [key for key in UNREAD_OF_GEOMS if key in item.attributes]
            elif item.tag == "option":
                unread = [key for key in item.attributes if key not in READ_OF_OPTION]
            elif item.tag == "flag":
                unread = [key for key in item.attributes if key != "gravity"]
            for key in unread:
                why = "the physics has contacts and a solver of its own"
                notes.add(item.place_of(key), f"{key} of <{item.tag}> is left out: {why}")
