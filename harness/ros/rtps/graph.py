"""The port to ROS 2 over RTPS: names and types as rmw_fastrtps writes them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from harness.ros.graph import Reply
from harness.ros.interfaces import CANCEL, decoded, message, typestore
from harness.ros.names import Names
from harness.ros.rtps import wire
from harness.ros.rtps.participant import Participant
from harness.ros.rtps.reader import Received
from harness.ros.rtps.writer import Qos, Writer

SERVICE_DEPTH = 100
DISCOVERY = "ros_discovery_info"
CYCLONE = b"\x01\x10"
"""Vendor at the start of a GUID. Its ROS middleware carries what identifies a request in the
content: 16 bytes between the encapsulation header and the message, in requests and responses."""
GID = 16
"""Bytes of a GUID in rmw_dds_common/msg/Gid since Jazzy."""


def dds_type(kind: str) -> str:
    """`std_msgs/msg/String` as `std_msgs::msg::dds_::String_`."""
    kind = kind.replace(CANCEL, "action_msgs/srv/CancelGoal")
    package, folder, name = kind.split("/")
    return f"{package}::{folder}::dds_::{name}_"


@dataclass
class _Publisher:
    writer: Writer
    kind: str

    @property
    def subscribers(self) -> int:
        return len(self.writer.readers)

    def publish(self, message: Any) -> None:
        if self.writer.readers or self.writer.qos.is_latched:
            self.writer.write(bytes(typestore().serialize_cdr(message, self.kind)))


@dataclass
class _Client:
    writer: Writer
    kind: str
    own_reader: bytes
    """GUID of the reader of the responses."""
    replies: set[bytes]
    """Writers of responses that were discovered; shared with the reader."""
    waiting: dict[int, Callable[[Any], None]] = field(
        default_factory=dict[int, Callable[[Any], None]]
    )

    @property
    def is_ready(self) -> bool:
        return bool(self.writer.readers) and bool(self.replies)

    def call(self, request: Any, on_response: Callable[[Any], None]) -> None:
        payload = bytes(typestore().serialize_cdr(request, f"{self.kind}_Request"))
        number = self.writer.last + 1
        self.waiting[number] = on_response
        if any(guid.startswith(CYCLONE) for guid in self.writer.readers):
            self.writer.write(_with_identity(payload, self.own_reader[8:] + _little(number)))
            return
        identity = self.own_reader + wire.sequence_number(number)
        self.writer.write(payload, wire.parameters([(wire.PID_RELATED, identity)]))

    def take(self, response: Any, received: Received) -> None:
        """Hand a response to the request that it answers."""
        if received.writer.startswith(CYCLONE):
            own, number = received.payload[4:12], received.payload[12:20]
            is_own = own == self.own_reader[8:]
            key = int.from_bytes(number, "little", signed=True)
        else:
            related = _related(received)
            is_own = related[:16] == self.own_reader
            key = wire.number_at(related, 16, "<") if is_own else 0
        waiting = self.waiting.pop(key, None) if is_own else None
        if waiting is not None:
            waiting(response)


class RtpsGraph:
    """A node in a domain, with a participant of its own."""

    def __init__(self, domain: int, *, node: str, is_local: bool = True) -> None:
        """Join a domain.

        Args:
            domain: The number of the ROS domain.
            node: The name of the node.
            is_local: Whether it talks to this machine alone.

        Raises:
            NetworkError: There is no such domain, or no free port.
        """
        self.participant = Participant(domain, name=node, is_local=is_local)
        self.unreadable = 0
        self._node = node
        self._entities: tuple[list[bytes], list[bytes]] = ([], [])
        info = "rmw_dds_common/msg/ParticipantEntitiesInfo"
        self._discovery = self.participant.writer(
            DISCOVERY, dds_type(info), Qos(is_latched=True, depth=1)
        )
        self._introduce()

    def advertise(
        self,
        topic: str,
        kind: str,
        *,
        latched: bool = False,
        reliable: bool = True,
        depth: int = 10,
    ) -> _Publisher:
        self._prepare(kind)
        qos = Qos(is_reliable=reliable, is_latched=latched, depth=depth)
        return _Publisher(self._writer(f"rt{topic}", dds_type(kind), qos), kind)

    def subscribe(
        self,
        topic: str,
        kind: str,
        on_message: Callable[[Any], None],
        *,
        latched: bool = False,
        reliable: bool = True,
    ) -> None:
        qos = Qos(is_reliable=reliable, is_latched=latched)
        self._reader(f"rt{topic}", kind, qos, lambda content, _: on_message(content))

    def serve(self, name: str, kind: str, on_request: Callable[[Any, Reply], None]) -> None:
        self._prepare(f"{kind}_Response")
        qos = Qos(depth=SERVICE_DEPTH)
        writer = self._writer(f"rr{name}Reply", dds_type(f"{kind}_Response"), qos)

        def answer(received: Received, response: Any) -> None:
            payload = bytes(typestore().serialize_cdr(response, f"{kind}_Response"))
            if received.writer.startswith(CYCLONE):
                payload = _with_identity(payload, received.payload[4:20])
                writer.write(payload, target=received.writer[:12])
                return
            client = _related(received)[:16] or received.writer
            identity = client + wire.sequence_number(received.number)
            related = [(wire.PID_RELATED, identity), (wire.PID_RELATED_OLD, identity)]
            writer.write(payload, wire.parameters(related), target=client[:12])

        def take(request: Any, received: Received) -> None:
            on_request(request, partial(answer, received))

        self._reader(f"rq{name}Request", f"{kind}_Request", qos, take)

    def client(self, name: str, kind: str) -> _Client:
        qos = Qos(depth=SERVICE_DEPTH)

        def take(response: Any, received: Received) -> None:
            client.take(response, received)

        reader = self._reader(f"rr{name}Reply", f"{kind}_Response", qos, take)
        writer = self._writer(f"rq{name}Request", dds_type(f"{kind}_Request"), qos)
        own = self.participant.guid(reader.entity)
        client = _Client(writer, kind, own, reader.writers.keys())  # pyright: ignore[reportArgumentType]
        return client

    def names(self) -> tuple[Names, Names]:
        own, others = self.participant.own_topics(), self.participant.known_topics()
        return _names(*own), _names(*others)

    def spin(self, until: float) -> None:
        self.participant.spin(until)

    def close(self) -> None:
        self.participant.close()

    @staticmethod
    def _prepare(kind: str) -> None:
        """Let rosbags write the code of a type now, which takes some milliseconds."""
        payload = typestore().serialize_cdr(message(kind), kind)
        typestore().deserialize_cdr(payload, kind)

    def _writer(self, topic: str, type_name: str, qos: Qos) -> Writer:
        made = self.participant.writer(topic, type_name, qos)
        self._entities[1].append(self.participant.guid(made.entity))
        self._introduce()
        return made

    def _reader(
        self, topic: str, kind: str, qos: Qos, take: Callable[[Any, Received], None]
    ) -> Any:
        is_service = not topic.startswith("rt")

        def deliver(received: Received) -> None:
            payload = received.payload
            if is_service and received.writer.startswith(CYCLONE):
                payload = payload[:4] + payload[20:]
            try:
                content = decoded(payload, kind)
            except Exception:  # noqa: BLE001 - bytes of another program; no content of them is certain
                self.unreadable += 1
                return
            take(content, received)

        self._prepare(kind)
        made = self.participant.reader(topic, dds_type(kind), qos, deliver)
        self._entities[0].append(self.participant.guid(made.entity))
        self._introduce()
        return made

    def _introduce(self) -> None:
        """Say which endpoints belong to the node: `ros2 node info` reads it."""
        import numpy as np

        def gid(guid: bytes) -> Any:
            padded = np.frombuffer(guid.ljust(GID, b"\0"), np.uint8)
            return message("rmw_dds_common/msg/Gid", data=padded)

        readers, writers = ([gid(guid) for guid in guids] for guids in self._entities)
        node = message(
            "rmw_dds_common/msg/NodeEntitiesInfo",
            node_namespace="/",
            node_name=self._node,
            reader_gid_seq=readers,
            writer_gid_seq=writers,
        )
        kind = "rmw_dds_common/msg/ParticipantEntitiesInfo"
        own = gid(self.participant.guid(wire.PARTICIPANT))
        info = message(kind, gid=own, node_entities_info_seq=[node])
        self._discovery.write(bytes(typestore().serialize_cdr(info, kind)))


def _names(*topics: set[str]) -> Names:
    """Names in ROS of what is written and what is read in DDS; services are left out."""
    return Names.of(*({name[2:] for name in each if name.startswith("rt/")} for each in topics))


def _related(received: Received) -> bytes:
    """The reader and the number of a request that a sample names; empty where it names none."""
    for key in (wire.PID_RELATED, wire.PID_RELATED_OLD):
        related = received.inline.get(key, b"")
        if len(related) >= 24 and any(related[:12]):
            return related[:24]
    return b""


def _with_identity(payload: bytes, identity: bytes) -> bytes:
    return payload[:4] + identity + payload[4:]


def _little(number: int) -> bytes:
    return number.to_bytes(8, "little", signed=True)
