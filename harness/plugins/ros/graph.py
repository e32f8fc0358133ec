"""The port to ROS 2: topics and services of a domain, whatever implements its protocol."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from harness.plugins.ros.interfaces import encoded

Reply = Callable[[Any], None]
"""Sends the response of a service; at once or later."""

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
BEST_EFFORT = Qos(is_reliable=False)
"""Of a subscription that takes messages of all publishers."""
LATCHED = Qos(is_latched=True, depth=1)


@dataclass(frozen=True)
class Use:
    """A publisher or a subscription of a topic; `kind` is a type such as std_msgs/msg/String."""

    topic: str
    kind: str
    publishes: bool
    qos: Qos = DEFAULT


@dataclass(frozen=True)
class Publisher:
    """Publishes messages of one topic, by a function that sends them serialised."""

    kind: str
    send: Callable[[bytes], object]
    count: Callable[[], int]
    is_latched: bool = False

    @property
    def subscribers(self) -> int:
        """The number of matched subscribers."""
        return self.count()

    def publish(self, message: Any) -> None:
        """Send a message of the topic's type to every subscriber."""
        if self.is_latched or self.subscribers:
            self.send(encoded(message, self.kind))


@dataclass(frozen=True)
class Client:
    """Calls one service.

    Attributes:
        is_ready: Whether a server is there.
        call: Sends a request; its response is passed on during a later `spin`.
    """

    is_ready: Callable[[], bool]
    call: Callable[[Any, OnMessage], None]


class Graph(Protocol):
    """A node of a ROS 2 domain. Every callback is called inside `spin`, never from a thread.

    Messages are those of `harness.plugins.ros.interfaces`, services are named without `Request`,
    and actions are made of services and topics by `harness.plugins.ros.actions`.
    """

    def advertise(self, topic: str, kind: str, qos: Qos = DEFAULT) -> Publisher:
        """A publisher of a topic."""
        ...

    def subscribe(self, topic: str, kind: str, on_message: OnMessage, qos: Qos = DEFAULT) -> None:
        """Receive the messages of a topic; what cannot be read is ignored."""
        ...

    def serve(self, name: str, kind: str, on_request: Callable[[Any, Reply], None]) -> None:
        """Answer requests of a service; `kind` is its type, such as action_msgs/srv/CancelGoal."""
        ...

    def client(self, name: str, kind: str) -> Client:
        """A client of a service."""
        ...

    def uses(self) -> tuple[Sequence[Use], Sequence[Use]]:
        """How this node uses topics, and how all other nodes that are known do."""
        ...

    def spin(self, until: float) -> None:
        """Receive until a moment of `time.monotonic`, and answer."""
        ...

    def close(self) -> None:
        """Leave the domain."""
        ...


def spin_until(graph: Graph, holds: Callable[[], bool], timeout: float) -> bool:
    """Spin until something holds; whether it did within the wall time [s]."""
    deadline = time.monotonic() + timeout
    while not holds():
        if time.monotonic() > deadline:
            return False
        graph.spin(min(deadline, time.monotonic() + 0.005))
    return True
