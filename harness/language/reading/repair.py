"""What remains of a broken file, so that the mistakes in the rest of it are found as well."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any, Literal, cast

from harness.language.expectation import CHECK
from harness.language.language import PLACEHOLDER_VERB, PLACEHOLDER_WORD
from harness.language.step import TAG
from harness.language.variation import VARIATION_KEYS

STAND_INS: dict[str, dict[str, Any]] = {
    "steps": {TAG: PLACEHOLDER_VERB},
    "expect": {CHECK: PLACEHOLDER_WORD},
    "objects": {"static": True, "sphere": {"radius": 1e-3}, "in": "planning"},
}
"""Lists of a scenario, and what stands in for an item that cannot be read."""

STAND_IN_ROBOT = "open_manipulator_x"
"""In place of a robot that cannot be known, so that what does not depend on it is checked."""

ROBOT_DETAILS = ("base", "start_state", "joint_limits", "named_states", "moveit", "args")
"""Keys of `robot` without which it is the same arm."""

KEPT = {"steps": ("id", "planning", "expect"), "expect": (), "objects": ("name",)}
"""Keys of a broken item that are kept unless they are what is broken."""


@dataclass
class Repaired:
    """A scenario without what is broken.

    Attributes:
        data: What may be valid; items of lists keep their places.
        words: Every word of what was taken out: problems that name one may follow from it.
        missing: `robot` or `world`, where something else stands in for it.
    """

    data: dict[str, Any]
    words: set[str] = field(default_factory=set[str])
    missing: set[Literal["robot", "world"]] = field(default_factory=set[Literal["robot", "world"]])


def repair(data: dict[str, Any], places: Iterable[tuple[str | int, ...]]) -> Repaired:
    """The scenario without what is broken.

    Args:
        data: A scenario in the model's shape.
        places: Where pydantic found mistakes.
    """
    found = Repaired(deepcopy(data))
    for place in places:
        _remove_mistake(found, place)
    found.data.setdefault("scenario", "untitled")
    found.data.setdefault("steps", [STAND_INS["steps"]])
    if "robot" not in found.data:
        found.data["robot"] = {"model": STAND_IN_ROBOT}
        found.missing.add("robot")
    return found


def _remove_mistake(found: Repaired, place: tuple[str | int, ...]) -> None:
    data = found.data
    key = str(place[0]) if place else ""
    if not key:  # the whole contradicts itself: how many samples there are
        for each in VARIATION_KEYS:
            data.pop(each, None)
        return
    item = _deepest_item(data, place)
    if item is not None:
        items, index, kind, inside = item
        old, new = items[index], _stand_in(kind, items[index], index, inside)
        still_judged = {key: new[key] for key in ("planning", "expect") if key in new}
        found.words.update(set(_texts(old)) - set(_texts(still_judged)))
        items[index] = new
        return
    value = data.get(key)
    part = str(place[1]) if len(place) > 1 else ""
    is_detail = key != "robot" or part in ROBOT_DETAILS
    if isinstance(value, dict) and part in value and is_detail and key != "world":
        found.words.update(_texts(cast("dict[str, Any]", value).pop(part)))
        return
    found.words.update(_texts(data.pop(key, None)))
    if key == "world":
        found.missing.add("world")


def _deepest_item(
    data: dict[str, Any], place: tuple[str | int, ...]
) -> tuple[list[Any], int, str, str] | None:
    """The innermost step, expectation or object around a place: list, index, kind, key inside."""
    at: Any = data
    name, found, inside = "", None, ""
    for part in place:
        if isinstance(at, list) and isinstance(part, int) and part < len(cast("list[Any]", at)):
            items = cast("list[Any]", at)
            kind = "steps" if name == "during" else name
            if kind in STAND_INS:
                found, inside = (items, part, kind), ""
            at = items[part]
        elif isinstance(at, dict) and part in at:
            inside = inside or str(part)
            name, at = str(part), cast("dict[str, Any]", at)[str(part)]
    return None if found is None else (*found, inside)


def _stand_in(kind: str, item: Any, index: int, inside: str) -> dict[str, Any]:
    named = cast("dict[str, Any]", item) if isinstance(item, dict) else {}
    kept = {key: named[key] for key in KEPT[kind] if key in named and key != inside}
    if kind == "objects" and not (isinstance(kept.get("name"), str) and kept["name"]):
        kept["name"] = f"object {index + 1}"
    return {**STAND_INS[kind], **kept}


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, item in cast("dict[str, Any]", value).items():
            yield key
            yield from _texts(item)
    elif isinstance(value, list):
        for item in cast("list[Any]", value):
            yield from _texts(item)
