"""The port to ROS 2: topics and services of a domain, whoever speaks its protocol."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from harness.ros.interfaces import encoded
from harness.ros.names import Use

Reply = Callable[[Any], None]
"""Sends the response of a service; at once or later."""

OnMessage = Callable[[Any], None]


@dataclass(frozen=True)
class Publisher:
    """Publishes messages of one topic.

    Attributes:
        kind: The type of its messages.
        send: Sends a serialised message.
        count: The number of matched subscribers.
        is_latched: Whether subscribers that come later get the last message.
    """

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


class ServiceClient(Protocol):
    """Calls one service."""

    @property
    def is_ready(self) -> bool:
        """Whether a server is there."""
        ...

    def call(self, request: Any, on_response: OnMessage) -> None:
        """Send a request; the response arrives during a later `spin`."""
        ...


class Graph(Protocol):
    """A node of a ROS 2 domain. Every callback is called inside `spin`, never from a thread.

    Messages are those of `harness.ros.interfaces`, services are named without `Request`, and
    actions are made of services and topics by `harness.ros.actions`.
    """

    def advertise(
        self, topic: str, kind: str, *, latched: bool = False, depth: int = 10
    ) -> Publisher:
        """A publisher of a topic; lost messages are sent again."""
        ...

    def subscribe(
        self,
        topic: str,
        kind: str,
        on_message: OnMessage,
        *,
        latched: bool = False,
        reliable: bool = True,
    ) -> None:
        """Receive the messages of a topic; what cannot be read is ignored.

        Only what is subscribed to without `reliable` comes from publishers of both kinds.
        """
        ...

    def serve(self, name: str, kind: str, on_request: Callable[[Any, Reply], None]) -> None:
        """Answer requests of a service; `kind` is its type, such as action_msgs/srv/CancelGoal."""
        ...

    def client(self, name: str, kind: str) -> ServiceClient:
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
