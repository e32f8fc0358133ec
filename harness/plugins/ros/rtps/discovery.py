"""What participants announce of themselves and of their endpoints (DDSI-RTPS 2.3, 8.5 and 9.6)."""

from __future__ import annotations

import struct
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from harness.plugins.ros.endpoints import Qos
from harness.plugins.ros.rtps import wire
from harness.plugins.ros.rtps.wire import Address, Parameters

T = TypeVar("T")

Reachable = Callable[[Sequence[Address]], Address | None]
"""The one of some addresses under which they are reached; None for none."""

LEASE = 100.0  # seconds of silence after which peers forget this participant
PEER_LEASE = 20.0  # seconds of silence after which a peer that announces no lease is forgotten
BUILTIN = 0x3F  # participant discovery and endpoint discovery, both directions

_HEAD = b"\0\3\0\0"
_VERSION = [(wire.PID_VERSION, wire.VERSION), (wire.PID_VENDOR, wire.VENDOR)]


@dataclass(frozen=True)
class Endpoint:
    """A writer or a reader as its participant announces it.

    Attributes:
        topic: The name of its topic in DDS, such as `rt/joint_states`.
        addresses: Where it is reached; empty for its participant's addresses.
        has_type_hash: Whether it says of which definition its type is, as all ROS 2 since Iron.
    """

    guid: bytes
    topic: str
    type_name: str
    qos: Qos
    addresses: Sequence[Address] = ()
    has_type_hash: bool = False

    @property
    def is_writer(self) -> bool:
        """Whether it writes, with a key or without."""
        return _is_writer(self.guid)

    def matches(self, other: Endpoint) -> bool:
        """Whether direction, topic, type and quality allow a connection with another endpoint."""
        offered, requested = (self, other) if self.is_writer else (other, self)
        return (
            offered.is_writer > requested.is_writer
            and (offered.topic, offered.type_name) == (requested.topic, requested.type_name)
            and offered.qos.is_reliable >= requested.qos.is_reliable
            and offered.qos.is_latched >= requested.qos.is_latched
        )

    @classmethod
    def parsed(cls, payload: bytes) -> Endpoint:
        """The content of an announcement.

        Raises:
            KeyError: It has no topic or no type.
        """
        known = wire.parameters_of(payload)
        guid = known[wire.PID_ENDPOINT][0][:16]
        reliability = _number(known, wire.PID_RELIABILITY, 2 if _is_writer(guid) else 1)
        return cls(
            guid,
            wire.text_of(known[wire.PID_TOPIC][0]),
            wire.text_of(known[wire.PID_TYPE][0]),
            Qos(reliability == 2, _number(known, wire.PID_DURABILITY, 0) >= 1),
            _addresses(known, wire.PID_UNICAST),
            any(b"typehash=" in each for each in known.get(wire.PID_USER_DATA, ())),
        )

    def payload(self) -> bytes:
        """Its announcement."""
        reliability = struct.pack("<IiI", 2 if self.qos.is_reliable else 1, 0, 429496730)
        return _HEAD + wire.parameters(
            *_VERSION,
            (wire.PID_ENDPOINT, self.guid),
            (wire.PID_PARTICIPANT, self.guid[:12] + wire.PARTICIPANT),
            (wire.PID_KEY_HASH, self.guid),
            (wire.PID_TOPIC, wire.text(self.topic)),
            (wire.PID_TYPE, wire.text(self.type_name)),
            (wire.PID_RELIABILITY, reliability),
            (wire.PID_DURABILITY, struct.pack("<I", int(self.qos.is_latched))),
        )


@dataclass
class Peer:
    """Another participant.

    Attributes:
        domain: The number of its domain; None where it does not say.
        meta: The address for discovery.
        user: The address for samples, where endpoints have none of their own.
        lease: The silence after which it is gone [s].
        seen: The moment of `time.monotonic` of its last message.
        knows_us: Whether it has sent anything to this participant's endpoints.
        endpoints: Its writers and readers, by GUID.
    """

    domain: int | None
    meta: Address
    user: Address
    lease: float
    seen: float = field(default_factory=time.monotonic)
    knows_us: bool = False
    endpoints: dict[bytes, Endpoint] = field(default_factory=dict[bytes, Endpoint])

    @classmethod
    def parsed(cls, payload: bytes, reachable: Reachable) -> Peer | None:
        """The content of an announcement; None where the participant cannot be reached."""
        known = wire.parameters_of(payload)
        meta = reachable(_addresses(known, wire.PID_META_UNICAST))
        if meta is None:
            return None
        user = reachable(_addresses(known, wire.PID_DEFAULT_UNICAST)) or meta
        lease = _number(known, wire.PID_LEASE, PEER_LEASE)
        return cls(_number(known, wire.PID_DOMAIN, None), meta, user, lease)


def announcement(guid: bytes, domain: int, name: str, addresses: Sequence[Address]) -> bytes:
    """The submessage with which a participant announces itself."""
    locators = [wire.locator(each) for each in addresses]
    payload = _HEAD + wire.parameters(
        *_VERSION,
        (wire.PID_PARTICIPANT, guid),
        (wire.PID_DOMAIN, struct.pack("<I", domain)),
        *((wire.PID_META_UNICAST, each) for each in locators),
        *((wire.PID_DEFAULT_UNICAST, each) for each in locators),
        (wire.PID_LEASE, struct.pack("<iI", int(LEASE), 0)),
        (wire.PID_BUILTIN, struct.pack("<I", BUILTIN)),
        (wire.PID_NAME, wire.text(name)),
        (wire.PID_USER_DATA, struct.pack("<I", 10) + b"enclave=/;"),
    )
    return wire.data(wire.NO_ENTITY, wire.SPDP_WRITER, 1, payload)


def farewell(guid: bytes) -> bytes:
    """The submessage with which a participant leaves."""
    status = wire.PID_STATUS, struct.pack(">I", 3)
    inline = wire.parameters((wire.PID_KEY_HASH, guid), status)
    return wire.data(wire.NO_ENTITY, wire.SPDP_WRITER, 2, b"", inline)


def is_gone(inline: dict[int, bytes]) -> bool:
    """Whether a sample says that its participant or endpoint is disposed of."""
    return bool(inline.get(wire.PID_STATUS, b"\0")[-1] & 3)


def _is_writer(guid: bytes) -> bool:
    return guid[15] & 0x0F in (0x02, 0x03)


def _addresses(known: Parameters, key: int) -> list[Address]:
    found = map(wire.address_of, known.get(key, []))
    return [address for address in found if address is not None]


def _number(known: Parameters, key: int, default: T) -> int | T:
    return struct.unpack_from("<I", known[key][0])[0] if key in known else default
