"""Pairs of bodies that can never touch in the physics: `never` would show nothing."""

from __future__ import annotations

from itertools import product

from harness.cell.scope import Scope
from harness.language.files.source import Loc
from harness.robot.tree import excluded_contacts

HINT = "no contact of them is ever recorded, so that nothing can be expected of it"


def check_contact(
    scope: Scope, first: str, second: str, loc: Loc, *, overlaps_count: bool = False
) -> None:
    """Refuse two bodies of an expectation of which no pair can ever touch.

    Args:
        first: A link, an object, `robot`, `gripper` or `any`; unknown names are left to others.
        overlaps_count: Whether the overlap of links whose contact is excluded is judged as well.
    """
    reason = why_never_in_contact(scope, first, second, overlaps_count=overlaps_count)
    if reason:
        scope.problems.add(loc, reason, HINT)


def why_never_in_contact(
    scope: Scope, first: str, second: str, *, overlaps_count: bool = False
) -> str:
    """Why no pair of two bodies can ever touch; empty where one can, or where a name is unknown."""
    reasons = set[str]()
    for pair in product(_bodies(scope, first), _bodies(scope, second)):
        reason = _why_apart(scope, *pair, overlaps_count=overlaps_count)
        if not reason:
            return ""
        reasons.add(reason)
    if not reasons:
        return ""
    reason = reasons.pop() if len(reasons) == 1 else "the physics excludes every contact of them"
    return f"'{first}' and '{second}' can never touch: {reason}"


def _bodies(scope: Scope, word: str) -> tuple[str, ...]:
    robot = scope.description
    match word:
        case "robot":
            return robot.link_names
        case "gripper":
            return () if robot.gripper is None else (*robot.gripper.links, robot.gripper.palm_link)
        case "any":
            return (*robot.link_names, *scope.objects)
        case _ if word in robot.link_names or word in scope.objects:
            return (word,)
        case _:
            return tuple(link for link, arm in robot.arm_of_link.items() if arm == word)


def _why_apart(scope: Scope, first: str, second: str, *, overlaps_count: bool) -> str:
    """Why two bodies can never touch in the physics; empty where they can."""
    shapeless = {link.name for link in scope.description.links if not link.collisions}
    if first == second:
        return "they are one body"
    for name in (first, second):
        if name in shapeless:
            return f"the link '{name}' has no collision shape"
    if all(_is_fixed(scope, name) for name in (first, second)):
        return "neither of them can move"
    if not overlaps_count and frozenset((first, second)) in excluded_contacts(scope.description):
        return "the SRDF excludes their contact, or a joint connects them"
    return ""


def _is_fixed(scope: Scope, name: str) -> bool:
    if name in scope.description.link_names:
        return name in scope.description.static_links
    return scope.objects[name].is_static
