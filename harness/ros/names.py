"""Names that other nodes use and that no node serves: misspelt topics and actions."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

IGNORED = {"/rosout", "/parameter_events", "/clock"}
"""Topics that every node of rclpy has."""


@dataclass(frozen=True)
class Names:
    """Topics by what is done with them.

    Attributes:
        published: The topics that are published.
        subscribed: The topics that are subscribed to.
    """

    published: frozenset[str]
    subscribed: frozenset[str]

    @classmethod
    def of(cls, published: Iterable[str], subscribed: Iterable[str]) -> Names:
        """The names in two collections."""
        return cls(frozenset(published), frozenset(subscribed))

    @property
    def actions(self) -> list[str]:
        """The actions that are served: their feedback is published."""
        return sorted(filter(None, map(_action, self.published)))


def unserved(own: Names, others: Names) -> list[str]:
    """A sentence on each name of other nodes that neither they nor this one serves.

    Args:
        own: What this node publishes and subscribes to.
        others: What all other nodes publish and subscribe to.
    """
    lost = others.published - others.subscribed - own.subscribed - IGNORED
    missing = others.subscribed - others.published - own.published - IGNORED
    calls = {action for name in missing if (action := _action(name))}
    found = [
        *((action, "calls the action", "is not served", own.actions) for action in sorted(calls)),
        *(
            (name, "publishes", "has no subscriber", own.subscribed)
            for name in sorted(lost)
            if "/_action/" not in name
        ),
        *(
            (name, "subscribes to", "is not published", own.published)
            for name in sorted(missing)
            if "/_action/" not in name
        ),
    ]
    return [
        f"a node {does} {name}, which {why}{_nearest(name, known)}"
        for name, does, why, known in found
    ]


def _action(topic: str) -> str:
    """The action whose feedback a topic carries; empty for other topics."""
    found = re.fullmatch(r"(.+)/_action/feedback", topic)
    return found[1] if found else ""


def _nearest(name: str, known: Iterable[str]) -> str:
    close = get_close_matches(name, sorted(known), 1)
    return f"; did you mean {close[0]}?" if close else ""
