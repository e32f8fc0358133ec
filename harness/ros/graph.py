"""The port to ROS 2: topics and services of a domain, whoever speaks its protocol."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from harness.ros.names import Names

Reply = Callable[[Any], None]
"""Sends the response of a service; at once or later."""


class Publisher(Protocol):
    """Publishes messages of one topic."""

    @property
    def subscribers(self) -> int:
        """Number of matched subscribers."""
        ...

    def publish(self, message: Any) -> None:
        """Send a message of the topic's type to every subscriber."""
        ...


class ServiceClient(Protocol):
    """Calls one service."""

    @property
    def is_ready(self) -> bool:
        """Whether a server is there."""
        ...

    def call(self, request: Any, on_response: Callable[[Any], None]) -> None:
        """Send a request; the response arrives during a later `spin`."""
        ...


class Graph(Protocol):
    """A node of a ROS 2 domain. Every callback is called inside `spin`, never from a thread.

    Messages are those of `harness.ros.interfaces`, services are named without `Request`, and
    actions are made of services and topics by `harness.ros.action_server`.
    """

    def advertise(
        self,
        topic: str,
        kind: str,
        *,
        latched: bool = False,
        reliable: bool = True,
        depth: int = 10,
    ) -> Publisher:
        """A publisher of a topic."""
        ...

    def subscribe(
        self,
        topic: str,
        kind: str,
        on_message: Callable[[Any], None],
        *,
        latched: bool = False,
        reliable: bool = True,
    ) -> None:
        """Receive the messages of a topic; what cannot be read is ignored."""
        ...

    def serve(self, name: str, kind: str, on_request: Callable[[Any, Reply], None]) -> None:
        """Answer requests of a service; `kind` is its type, such as action_msgs/srv/CancelGoal."""
        ...

    def client(self, name: str, kind: str) -> ServiceClient:
        """A client of a service."""
        ...

    def names(self) -> tuple[Names, Names]:
        """The topics of this node, and those of all other nodes that are known."""
        ...

    def spin(self, until: float) -> None:
        """Receive until a moment of `time.monotonic`, and answer."""
        ...

    def close(self) -> None:
        """Leave the domain."""
        ...
