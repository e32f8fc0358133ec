"""What remains of a broken file, so that the mistakes in the rest of it are found as well."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, cast

STAND_INS: dict[str, dict[str, Any]] = {
    "steps": {"do": "settle"},
    "expect": {"check": "within_limits"},
    "objects": {"static": True, "sphere": {"radius": 1e-3}, "in": "planning"},
}
"""Lists of a scenario, and what stands in for an item that cannot be read."""

NEEDED = frozenset({"scenario", "robot", "world"})
"""Without these nothing else can be checked."""


def mended(
    data: dict[str, Any], places: Iterable[tuple[str | int, ...]]
) -> tuple[dict[str, Any], frozenset[str]] | None:
    """The data without what is broken, items of lists keeping their places.

    Args:
        data: A scenario in the model's shape.
        places: Where pydantic found mistakes.

    Returns:
        Data that may be valid, and every word of what was taken out: mistakes that speak of one of
        them may follow from it. None when too little is left.
    """
    whole = dict(data)
    words: set[str] = set()
    for place in places:
        key = str(place[0]) if place else ""
        if not key or key in NEEDED:
            return None
        items = whole.get(key)
        if key in STAND_INS and len(place) > 1 and isinstance(items, list):
            index = int(place[1])
            listed = list(cast("list[Any]", items))
            words.update(_texts(listed[index]))
            listed[index] = _stand_in(key, listed[index], index)
            whole[key] = listed
        elif key in whole:
            words.update(_texts(whole.pop(key)))
    return whole, frozenset(words)


def _stand_in(key: str, item: Any, index: int) -> dict[str, Any]:
    named = cast("dict[str, Any]", item) if isinstance(item, dict) else {}
    kept = {name: named[name] for name in ("id",) if isinstance(named.get(name), str)}
    if key == "objects":
        name = named.get("name")
        kept = {"name": name if isinstance(name, str) and name else f"object {index + 1}"}
    return {**STAND_INS[key], **(kept if key != "expect" else {})}


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
