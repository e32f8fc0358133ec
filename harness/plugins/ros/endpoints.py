"""Publishers, clients and their quality of service in a ROS domain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from harness.plugins.ros.interfaces import encoded

Reply = Callable[[Any], None]  # sends the response of a service; at once or later

OnMessage = Callable[[Any], object]


@dataclass(frozen=True)
class Qos:
    """What decides whether a publisher and a subscriber match.

    Attributes:
        is_reliable: Lost messages are sent again.
        is_latched: Subscribers that come later get the kept messages too (transient local).
    """

    is_reliable: bool = True
    is_latched: bool = False
    depth: int = 10


DEFAULT = Qos()
BEST_EFFORT = Qos(is_reliable=False)  # of a subscription that takes messages of all publishers
LATCHED = Qos(is_latched=True, depth=1)


SERVICE = "/_service"
"""The end of the topic of a `Use` that is a service: its client publishes requests there."""


@dataclass(frozen=True)
class Use:
    """A publisher or a subscription of a topic; `kind` is a type such as std_msgs/msg/String."""

    topic: str
    kind: str
    publishes: bool
    qos: Qos = DEFAULT


@dataclass(frozen=True)
class Publisher:
    """Publishes messages of one topic, by a function that sends them serialised.

    Attributes:
        outward: Makes of a message what other nodes read.
    """

    kind: str
    send: Callable[[bytes], object]
    count: Callable[[], int]
    is_latched: bool = False
    outward: Callable[[Any], Any] = lambda content: content

    @property
    def subscribers(self) -> int:
        """The number of matched subscribers."""
        return self.count()

    def publish(self, message: Any) -> None:
        """Send a message of the topic's type to every subscriber."""
        if self.is_latched or self.subscribers:
            self.send(encoded(self.outward(message), self.kind))


@dataclass(frozen=True)
class Client:
    """Calls one service.

    Attributes:
        is_ready: Whether a server is there.
        call: Sends a request; its response is passed on during a later `spin`.
    """

    is_ready: Callable[[], bool]
    call: Callable[[Any, OnMessage], None]
