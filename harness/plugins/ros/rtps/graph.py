"""The port to ROS 2 over RTPS: names and types as rmw_fastrtps writes them."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.endpoints import (
    DEFAULT,
    LATCHED,
    SERVICE,
    Client,
    OnMessage,
    Publisher,
    Qos,
    Reply,
    Use,
)
from harness.plugins.ros.interfaces import INTRODUCTIONS, decoded, encoded, prepare
from harness.plugins.ros.rtps import wire
from harness.plugins.ros.rtps.discovery import Endpoint
from harness.plugins.ros.rtps.participant import Participant
from harness.plugins.ros.rtps.reader import Reader
from harness.plugins.ros.rtps.wire import Sample
from harness.plugins.ros.rtps.writer import Writer

Convert = Callable[[Any], Any]
SERVICE_QOS = Qos(depth=100)
DISCOVERY = "ros_discovery_info"
INFO = "rmw_dds_common/msg/ParticipantEntitiesInfo"  # the type, whatever its identifiers
Take = Callable[[Any, bytes, bool], object]
"""Takes a message, the identity of its request, and whether it is of ROS 2 Humble."""

CYCLONE = b"\x01\x10"
"""Vendor at the start of a GUID. Its ROS middleware carries what identifies a request in the
content, between the encapsulation header and the message of requests and responses."""
CYCLONE_IDENTITY = 16


def dds_type(kind: str) -> str:
    """`std_msgs/msg/String` as `std_msgs::msg::dds_::String_`."""
    package, folder, name = kind.split("/")
    return f"{package}::{folder}::dds_::{name}_"


class Graph:
    """A node of a ROS 2 domain. Every callback is called inside `spin`, never from a thread.

    Messages are those of `harness.plugins.ros.interfaces`, services are named without `Request`,
    and actions are made of services and topics by `harness.plugins.ros.actions`.

    Attributes:
        outward: Makes of a message what other nodes read.
        inward: Makes of a message of other nodes what this one reads.
    """

    def __init__(self, domain: int, *, node: str, is_local: bool = True) -> None:
        """Join a domain.

        Args:
            is_local: Whether the node communicates with this machine alone.

        Raises:
            NetworkError: The domain cannot be joined.
        """
        self.participant = Participant(domain, name=node, is_local=is_local)
        self.close = self.participant.close
        self.outward: Convert = lambda content: content
        self.inward: Convert = lambda content: content
        self._node = node
        self._introductions = [
            self.participant.writer(DISCOVERY, dds_type(INFO), LATCHED, serves)
            for serves in (_is_later_than_humble, _is_of_humble)
        ]
        self._introduce()

    def spin(self, until: float, is_enough: Callable[[], bool] = lambda: False) -> None:
        """Receive until a moment of `time.monotonic`, or until it is enough, and answer."""
        self.participant.spin(until, is_enough)

    def spin_until(self, holds: Callable[[], bool], timeout: float) -> bool:
        """Spin until something holds; whether it did within the wall time [s]."""
        deadline = time.monotonic() + timeout
        while not holds():
            if time.monotonic() > deadline:
                return False
            self.spin(min(deadline, time.monotonic() + 0.005))
        return True

    def advertise(self, topic: str, kind: str, qos: Qos = DEFAULT) -> Publisher:
        """A publisher of a topic."""
        made = self._writer(f"rt{topic}", kind, qos)
        count = lambda: len(made.matched)  # noqa: E731
        return Publisher(kind, made.write, count, qos.is_latched, lambda m: self.outward(m))

    def subscribe(self, topic: str, kind: str, on_message: OnMessage, qos: Qos = DEFAULT) -> None:
        """Receive the messages of a topic; what cannot be read is ignored."""
        self._reader(f"rt{topic}", kind, lambda content, *_: on_message(content), qos)

    def serve(self, name: str, kind: str, on_request: Callable[[Any, Reply], None]) -> None:
        """Answer requests of a service; `kind` is its type, such as action_msgs/srv/CancelGoal."""
        writer = self._writer(f"rr{name}Reply", f"{kind}_Response", SERVICE_QOS)

        def take(request: Any, identity: bytes, is_humble: bool) -> None:
            def answer(response: Any) -> None:
                sent = self.outward(response)
                payload = encoded(sent, f"{kind}_Response", for_humble=is_humble)
                writer.write(*_framed(payload, identity))

            on_request(request, answer)

        self._reader(f"rq{name}Request", f"{kind}_Request", take)

    def client(self, name: str, kind: str) -> Client:
        """A client of a service."""
        waiting: dict[bytes, OnMessage] = {}

        def take(response: Any, identity: bytes, _: bool) -> None:
            waiting.pop(identity, lambda _: None)(response)

        def call(request: Any, on_response: OnMessage) -> None:
            number, guid = writer.last + 1, reader.endpoint.guid
            identity = guid + wire.sequence_number(number)
            if any(server.startswith(CYCLONE) for server in writer.matched):
                identity = guid[8:] + number.to_bytes(8, "little")
            waiting[identity] = on_response
            payload = encoded(self.outward(request), f"{kind}_Request")
            writer.write(*_framed(payload, identity))

        reader = self._reader(f"rr{name}Reply", f"{kind}_Response", take)
        writer = self._writer(f"rq{name}Request", f"{kind}_Request", SERVICE_QOS)
        return Client(lambda: bool(writer.matched and reader.matched), call)

    def uses(self) -> tuple[list[Use], list[Use]]:
        """How this node uses topics, and how all other nodes that are known do."""
        own, others = self.participant.own_endpoints(), self.participant.known_endpoints()
        return [*_uses(own)], [*_uses(others)]

    def _writer(self, topic: str, kind: str, qos: Qos) -> Writer:
        prepare(kind)
        made = self.participant.writer(topic, dds_type(kind), qos)
        self._introduce()
        return made

    def _reader(self, topic: str, kind: str, take: Take, qos: Qos = SERVICE_QOS) -> Reader:
        def deliver(sample: Sample) -> None:
            payload, identity = _unframed(sample, topic)
            writer = self.participant.known_endpoint(sample.writer)
            is_humble = writer is not None and _is_of_humble(writer)
            content = decoded(payload, kind, of_humble=is_humble)
            if content is not None:
                take(self.inward(content), identity, is_humble)

        prepare(kind)
        made = self.participant.reader(topic, dds_type(kind), qos, deliver)
        self._introduce()
        return made

    def _introduce(self) -> None:
        """Say which endpoints belong to the node: `ros2 node info` reads it."""
        own = [each for each in self.participant.own_endpoints() if each.topic != DISCOVERY]
        for writer, package in zip(self._introductions, INTRODUCTIONS, strict=True):
            info = self._introduction(own, f"{package}/msg", INTRODUCTIONS[package])
            writer.write(encoded(info, f"{package}/msg/ParticipantEntitiesInfo"))

    def _introduction(self, own: Sequence[Endpoint], package: str, size: int) -> Any:
        """The node and its endpoints, by identifiers of a number of bytes."""

        def gid(guid: bytes) -> Any:
            return message(f"{package}/Gid", data=np.frombuffer(guid.ljust(size, b"\0"), np.uint8))

        node = message(
            f"{package}/NodeEntitiesInfo",
            node_namespace="/",
            node_name=self._node,
            reader_gid_seq=[gid(each.guid) for each in own if not each.is_writer],
            writer_gid_seq=[gid(each.guid) for each in own if each.is_writer],
        )
        kind = f"{package}/ParticipantEntitiesInfo"
        return message(kind, gid=gid(self.participant.guid), node_entities_info_seq=[node])


def _is_of_humble(endpoint: Endpoint) -> bool:
    """Whether an endpoint is of ROS 2 Humble: one of Fast DDS that has no type hash."""
    return endpoint.guid.startswith(wire.FAST_DDS) and not endpoint.has_type_hash


def _is_later_than_humble(endpoint: Endpoint) -> bool:
    return not _is_of_humble(endpoint)


def _uses(endpoints: Iterable[Endpoint]) -> Iterator[Use]:
    """What endpoints are in ROS; of a service its requests."""
    for each in endpoints:
        kind = each.type_name.replace("::dds_::", "::").replace("::", "/").removesuffix("_")
        if each.topic.startswith("rt/"):
            yield Use(each.topic[2:], kind, each.is_writer, each.qos)
        elif each.topic.startswith("rq/"):
            name = each.topic[2:].removesuffix("Request") + SERVICE
            yield Use(name, kind.removesuffix("_Request"), each.is_writer, each.qos)


def _framed(payload: bytes, identity: bytes) -> tuple[bytes, bytes]:
    """The payload and the inline parameters of a request or a response.

    What identifies a request is its reader and its number in 24 bytes, or 16 bytes of Cyclone DDS.
    """
    if len(identity) == CYCLONE_IDENTITY:
        return payload[:4] + identity + payload[4:], b""
    keys = wire.PID_RELATED, wire.PID_RELATED_OLD
    return payload, wire.parameters(*((key, identity) for key in keys))


def _unframed(sample: Sample, topic: str) -> tuple[bytes, bytes]:
    """The serialised message, and the identity of the request that it is or answers."""
    if topic.startswith("rt"):
        return sample.payload, b""
    if sample.writer.startswith(CYCLONE):
        return sample.payload[:4] + sample.payload[20:], sample.payload[4:20]
    named = (sample.inline.get(key, b"")[:24] for key in (wire.PID_RELATED, wire.PID_RELATED_OLD))
    related = next((each for each in named if len(each) == 24 and any(each[:12])), b"")
    if topic.startswith("rq"):
        related = (related[:16] or sample.writer) + wire.sequence_number(sample.number)
    return sample.payload, related
