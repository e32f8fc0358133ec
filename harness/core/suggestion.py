"""The nearest valid name to one that is not known."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

SYNONYMS = {
    "mass": ("weight",),
    "size": ("dimensions", "extents"),
    "xyz": ("position", "translation", "point"),
    "quat_xyzw": ("orientation", "quaternion", "quat"),
    "rpy": ("rotation", "euler", "angles"),
    "pose": ("location", "origin"),
    "frame": ("frame_id", "reference_frame", "parent"),
    "static": ("fixed", "immovable"),
    "length": ("height",),
    "move_to": ("move", "goto", "go_to", "movej", "set_named_target", "set_pose_target"),
    "lin": ("movel", "move_linear", "line"),
    "circ": ("movec", "arc"),
    "wait": ("sleep", "delay", "pause"),
    "gripper": ("open_gripper", "close_gripper", "hand"),
    "capture": ("photo", "take_picture", "snapshot"),
}
"""Words of this language, and what other programs call them."""

LONGEST_LIST = 40


def nearest(word: str, valid: Iterable[str]) -> str | None:
    """The valid word most like the one written, if any is like it."""
    words = list(valid)
    folded = {each.lower().replace("-", "_"): each for each in reversed(words)}
    plain = word.lower().replace("-", "_").replace(" ", "_")
    if plain in folded:
        return folded[plain]
    known = next((keyword for keyword, others in SYNONYMS.items() if plain in others), None)
    if known in words:
        return known
    near = difflib.get_close_matches(plain, folded, 1, 0.6)
    return folded[near[0]] if near else None


def did_you_mean(word: str, valid: Iterable[str], what: str) -> str:
    """``did you mean `arm`? groups: arm, gripper``, as much of it as there is to say."""
    words = list(dict.fromkeys(valid))
    near = nearest(word, words)
    start = f"did you mean `{near}`? " if near else ""
    more = f", and {len(words) - LONGEST_LIST} more" if len(words) > LONGEST_LIST else ""
    rest = f"{what}: {', '.join(words[:LONGEST_LIST])}{more}" if words else f"there are no {what}"
    return start + rest
