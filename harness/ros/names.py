"""Notes on topics and actions of other nodes that do not reach this one, and what to do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

IGNORED = {"/rosout", "/parameter_events", "/clock"}
"""Topics that every node of rclpy has."""

HIDDEN, FEEDBACK, MESSAGE = "/_action/", "/_action/feedback", "_FeedbackMessage"
"""Parts of the topics of actions, of those with feedback, and of their types."""


@dataclass(frozen=True)
class Use:
    """A publisher or a subscription of a topic.

    Attributes:
        topic: The name of the topic.
        kind: The type of its messages, such as std_msgs/msg/String.
        publishes: Whether it is a publisher.
        is_reliable: Whether it offers or requests that lost messages are sent again.
        is_latched: Whether it offers or requests kept messages (transient local).
    """

    topic: str
    kind: str
    publishes: bool
    is_reliable: bool = True
    is_latched: bool = False


def actions(uses: Iterable[Use]) -> list[str]:
    """The actions that are served: their feedback is published."""
    return sorted(_topics(uses, FEEDBACK, publishes=True))


def unserved(own: Sequence[Use], others: Sequence[Use]) -> list[str]:
    """A sentence on each name of other nodes that neither they nor this one serves."""
    every = [*own, *others]
    used = {(use.topic, use.publishes) for use in every}
    lost = [use for use in others if (use.topic, not use.publishes) not in used]
    found = [
        *(
            (name, "calls the action", "is not served", actions(own))
            for name in _topics(lost, FEEDBACK, publishes=False)
        ),
        *(
            (name, does, why, _topics(own, publishes=not publishes))
            for publishes, does, why in (
                (True, "publishes", "has no subscriber"),
                (False, "subscribes to", "is not published"),
            )
            for name in _topics(lost, publishes=publishes)
        ),
    ]
    return [
        f"a node {does} {name}, which {why}{_nearest(name, known)}"
        for name, does, why, known in found
    ]


def mismatched(own: Sequence[Use], others: Sequence[Use]) -> list[str]:
    """A sentence on each use by another node that does not fit this node's, and what to change."""
    notes = (
        _mismatch(mine, use)
        for use in others
        for mine in own
        if (mine.topic, mine.publishes) == (use.topic, not use.publishes)
        and (HIDDEN not in use.topic or use.topic.endswith(FEEDBACK))
    )
    return sorted(set(filter(None, notes)))


def _mismatch(mine: Use, use: Use) -> str:
    """What does not fit between two uses of a topic; empty where nothing is lost."""
    does = "publishes" if use.publishes else "subscribes to"
    if mine.kind != use.kind:
        topic, kind, right = use.topic, use.kind, mine.kind
        if topic.endswith(FEEDBACK):
            topic, does = topic.removesuffix(FEEDBACK), "calls the action"
            kind, right = kind.removesuffix(MESSAGE), right.removesuffix(MESSAGE)
        return (
            f"a node {does} {topic} with the type {kind}, but its type is {right}: no message"
            f" arrives; import {right.rpartition('/')[2]} from"
            f" {'.'.join(right.split('/')[:-1])} in the node"
        )
    if HIDDEN in use.topic:
        return ""
    writer, reader = (use, mine) if use.publishes else (mine, use)
    if reader.is_reliable and not writer.is_reliable:
        how, setting = "with best-effort reliability", "reliability=ReliabilityPolicy.RELIABLE"
    elif reader.is_latched and not writer.is_latched:
        how, setting = "with transient-local durability", "durability=DurabilityPolicy.VOLATILE"
    elif writer.is_latched and not reader.is_latched and reader is use:
        return (
            f"a node subscribes to {use.topic} with volatile durability, so what was published"
            " before it came does not arrive; set durability=DurabilityPolicy.TRANSIENT_LOCAL in"
            " its QoSProfile"
        )
    else:
        return ""
    return (
        f"a node {does} {use.topic} {how}, which does not fit the other end: no message arrives;"
        f" set {setting} in its QoSProfile"
    )


def _topics(uses: Iterable[Use], ending: str = "", *, publishes: bool) -> list[str]:
    """Names of the topics that are published or subscribed to, or of actions by their ending."""
    return sorted(
        {
            use.topic.removesuffix(ending)
            for use in uses
            if use.publishes is publishes
            and use.topic not in IGNORED
            and (use.topic.endswith(ending) if ending else HIDDEN not in use.topic)
        }
    )


def _nearest(name: str, known: Sequence[str]) -> str:
    close = get_close_matches(name, known, 1)
    return f"; did you mean {close[0]}?" if close else ""
