"""The nearest valid name to one that is not known."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import Any, cast

SYNONYMS = {
    "name": ("id",),
    "mass": ("weight",),
    "size": ("dimensions", "extents"),
    "xyz": ("position", "translation", "point", "x", "y", "z", "at", "to"),
    "quat_xyzw": ("orientation", "quaternion", "quat"),
    "rpy": ("rotation", "euler", "angles"),
    "pose": ("location", "origin", "position", "xyz", "translation", "at", "to", "target_pose"),
    "frame": ("frame_id", "reference_frame", "parent"),
    "static": ("fixed", "immovable"),
    "length": ("height",),
    "above": ("height", "by_at_least", "min_height"),
    "object": ("target", "item", "body", "obj"),
    "max_rotation": ("max_angle", "max_turn"),
    "max_velocity": ("max_speed", "speed"),
    "at_most": ("max", "maximum", "below"),
    "at_least": ("min", "minimum"),
    "scenario": ("name", "title"),
    "world": ("name", "title"),
    "model": ("ur_type",),
}
"""Keys of this language, and what other programs call them; verbs and predicates state theirs."""

LONGEST_LIST = 40  # words that a message lists
SURELY_MISSPELT = 0.8  # similarity, from 0 to 1, above which a word is a slip of the pen


def nearest(word: str, valid: Iterable[str]) -> str | None:
    """The valid word most like the one written, if any is like it.

    Args:
        valid: The valid words; in a mapping to classes, with the `synonyms` that these state.
    """
    words = _by_word(valid)
    folded = {each.lower().replace("-", "_"): each for each in reversed(list(words))}
    plain = word.lower().replace("-", "_").replace(" ", "_")
    if plain in folded:
        return folded[plain]
    synonyms = {word: getattr(kind, "synonyms", ()) for word, kind in words.items()} | SYNONYMS
    for keyword in words:
        if plain in synonyms.get(keyword, ()):
            return keyword
    near = difflib.get_close_matches(plain, folded, 1, 0.6)
    return folded[near[0]] if near else None


def is_slip(word: str, near: str) -> bool:
    """Whether a word is nearly the same as the nearest valid one."""
    plain = word.lower().replace("-", "_")
    return difflib.SequenceMatcher(None, plain, near).ratio() > SURELY_MISSPELT


def did_you_mean(word: str, valid: Iterable[str], what: str) -> str:
    """``did you mean `arm`? groups: arm, gripper``, as much of it as there is to say."""
    classes = _by_word(valid)
    words, near = list(classes), nearest(word, classes)
    start = f"did you mean `{near}`? " if near else ""
    more = f", and {len(words) - LONGEST_LIST} more" if len(words) > LONGEST_LIST else ""
    rest = f"{what}: {', '.join(words[:LONGEST_LIST])}{more}" if words else f"there are no {what}"
    return start + rest


def _by_word(valid: Iterable[str]) -> Mapping[str, Any]:
    """What each valid word stands for; None where that is not known."""
    return cast("Mapping[str, Any]", valid) if isinstance(valid, Mapping) else dict.fromkeys(valid)
