"""What remains of a broken file, so that the mistakes in the rest of it are found as well."""

from __future__ import annotations

from collections.abc import Iterable
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any, Literal, cast

from harness.language.base import SpecModel
from harness.language.expectation import CHECK, KIND
from harness.language.language import PLACEHOLDER_VERB, PLACEHOLDER_WORD
from harness.language.reading.partial import partial_model, partial_plugin, texts
from harness.language.step import TAG, Step
from harness.language.variation import VARIATION_KEYS
from harness.language.world import ObjectSpec

STAND_INS: dict[str, dict[str, Any]] = {
    "steps": {TAG: PLACEHOLDER_VERB},
    "expect": {CHECK: PLACEHOLDER_WORD},
}
"""Lists of a scenario, and what stands in for an item whose word is unknown."""

STAND_IN_ROBOT = "open_manipulator_x"
"""In place of a robot that cannot be known, so that what does not depend on it is checked."""

ROBOT_DETAILS = ("base", "start_state", "joint_limits", "named_states", "moveit", "args")
"""Keys of `robot` without which it is the same arm."""

KEPT = {"steps": ("id", "planning", "expect"), "expect": ()}
"""Keys of such an item that are kept unless they are what is broken."""


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
        if not isinstance(items[index], SpecModel):  # of the item's other mistakes nothing is left
            partial = _partial(kind, items[index], index, found.words)
            items[index] = partial or _stand_in(kind, items[index], inside)
        return
    value = data.get(key)
    part = str(place[1]) if len(place) > 1 else ""
    is_detail = key != "robot" or part in ROBOT_DETAILS
    if isinstance(value, dict) and part in value and is_detail and key != "world":
        found.words.update(texts(cast("dict[str, Any]", value).pop(part)))
        return
    found.words.update(texts(data.pop(key, None)))
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
            if kind in (*STAND_INS, "objects"):
                found, inside = (items, part, kind), ""
            at = items[part]
        elif isinstance(at, dict) and part in at:
            inside = inside or str(part)
            name, at = str(part), cast("dict[str, Any]", at)[str(part)]
    return None if found is None else (*found, inside)


def _partial(kind: str, item: Any, index: int, words: set[str]) -> SpecModel | None:
    """The model of what is valid of a step, an expectation or an object."""
    if kind == "steps":
        return partial_plugin(Step.plugin_kind, TAG, item, words)
    if kind == "expect":
        return partial_plugin(KIND, CHECK, item, words)
    named = cast("dict[str, Any]", item) if isinstance(item, dict) else {}
    if not (isinstance(named.get("name"), str) and named["name"]):
        named = {**named, "name": f"object {index + 1}"}
    return partial_model(ObjectSpec, named, words)


def _stand_in(kind: str, item: Any, inside: str) -> dict[str, Any]:
    """An item in place of one whose word is unknown."""
    named = cast("dict[str, Any]", item) if isinstance(item, dict) else {}
    kept = {key: named[key] for key in KEPT[kind] if key in named and key != inside}
    return {**STAND_INS[kind], **kept}
