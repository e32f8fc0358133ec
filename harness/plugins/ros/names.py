"""Notes on topics and actions of other nodes that do not reach this one, and what to do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches

from harness.plugins.ros.endpoints import SERVICE, Use

IGNORED = {"/rosout", "/parameter_events", "/clock"}  # topics that every node of rclpy has

HIDDEN, FEEDBACK, MESSAGE = "/_action/", "/_action/feedback", "_FeedbackMessage"
"""Parts of the topics of actions, of those with feedback, and of their types."""

WHY = {
    "calls the action": "is not served",
    "calls the service": "is not served",
    "publishes": "has no subscriber",
    "subscribes to": "is not published",
}
"""What a node does with a name, and why nothing comes of it."""


def actions(uses: Iterable[Use]) -> list[str]:
    """The actions that are served: their feedback is published."""
    return sorted({_name(use) for use in uses if use.publishes and _is_action(use)})


def unserved(own: Sequence[Use], others: Sequence[Use], *, with_topics: bool = True) -> list[str]:
    """A sentence on each name of other nodes that neither they nor this one serves.

    Args:
        with_topics: Whether topics count; else only services and actions, whose clients wait.
    """
    used = {(use.topic, use.publishes) for use in (*own, *others)}
    notes: set[str] = set()
    for use in others:
        name, does = _name(use), _does(use)
        if not with_topics and _kind_of(use) == "topic":
            continue
        is_lost = (use.topic, not use.publishes) not in used and use.topic not in IGNORED
        is_server = use.publishes is _is_action(use) and _kind_of(use) != "topic"
        if is_lost and name and not is_server:
            fits = [mine for mine in own if mine.publishes is not use.publishes]
            known = [_name(mine) for mine in fits if _kind_of(mine) == _kind_of(use)]
            close = get_close_matches(name, known, 1)
            hint = f"; did you mean {close[0]}?" if close else ""
            notes.add(f"a node {does} {name}, which {WHY[does]}{hint}")
    return sorted(notes)


def mismatched(own: Sequence[Use], others: Sequence[Use]) -> list[str]:
    """A sentence on each use by another node that does not fit this node's, and what to change."""
    ends = [
        (mine, use)
        for use in others
        for mine in own
        if (mine.topic, mine.publishes) == (use.topic, not use.publishes) and _name(use)
    ]
    return sorted({note for mine, use in ends if (note := _mismatch(mine, use))})


def _mismatch(mine: Use, use: Use) -> str:
    """What does not fit between two uses of a topic; empty where nothing is lost."""
    start = f"a node {_does(use)} {_name(use)} with"
    if mine.kind != use.kind:
        kind, right = (each.kind.removesuffix(MESSAGE) for each in (use, mine))
        *package, name = right.split("/")
        return (
            f"{start} the type {kind}, but its type is {right}: no message arrives; import {name}"
            f" from {'.'.join(package)} in the node"
        )
    writer, reader = (use.qos, mine.qos) if use.publishes else (mine.qos, use.qos)
    lost = "which does not fit the other end: no message arrives"
    if _is_action(use):
        return ""
    if reader.is_reliable and not writer.is_reliable:
        how, setting = "best-effort reliability", "reliability=ReliabilityPolicy.RELIABLE"
    elif reader.is_latched and not writer.is_latched:
        how, setting = "transient-local durability", "durability=DurabilityPolicy.VOLATILE"
    elif writer.is_latched and not reader.is_latched and not use.publishes:
        how, setting = "volatile durability", "durability=DurabilityPolicy.TRANSIENT_LOCAL"
        lost = "so what was published before it came does not arrive"
    else:
        return ""
    return f"{start} {how}, {lost}; set {setting} in its QoSProfile"


def _is_action(use: Use) -> bool:
    return use.topic.endswith(FEEDBACK)


def _name(use: Use) -> str:
    """The topic or the action of its feedback; empty for what else belongs to an action."""
    name = use.topic.removesuffix(FEEDBACK).removesuffix(SERVICE)
    return "" if HIDDEN in name else name


def _does(use: Use) -> str:
    topic = "publishes" if use.publishes else "subscribes to"
    kind = _kind_of(use)
    return topic if kind == "topic" else f"calls the {kind}"


def _kind_of(use: Use) -> str:
    is_service = use.topic.endswith(SERVICE)
    return "action" if _is_action(use) else "service" if is_service else "topic"
