"""A writer: its history, the readers it serves, and what they lack."""

from __future__ import annotations

import struct
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from harness.ros.rtps import wire

Address = tuple[str, int]
Send = Callable[[bytes, bytes, Address], None]
"""Sends submessages to a participant: its prefix, the submessages, the address."""


@dataclass(frozen=True)
class Qos:
    """What decides whether a writer and a reader match.

    Attributes:
        is_reliable: Lost samples are sent again.
        is_latched: Readers that come later get the kept samples too (transient local).
        depth: Samples that a writer keeps.
    """

    is_reliable: bool = True
    is_latched: bool = False
    depth: int = 10

    def serves(self, reader: Qos) -> bool:
        """Whether a writer of this quality offers what a reader requests."""
        return self.is_reliable >= reader.is_reliable and self.is_latched >= reader.is_latched


@dataclass
class _Reader:
    """A matched reader of another participant."""

    address: Address
    qos: Qos
    first: int
    acknowledged: int


@dataclass(frozen=True)
class _Kept:
    number: int
    payload: bytes
    inline: bytes
    target: bytes
    """Prefix of the participant that it is for; empty for all."""


@dataclass
class Writer:
    """A writer of one topic.

    Attributes:
        entity: The entity identifier of the writer.
        topic: The name of the topic in DDS, such as `rt/joint_states`.
        type_name: The name of its type in DDS.
        qos: The quality that it offers.
        send: Sends submessages to another participant.
    """

    entity: bytes
    topic: str
    type_name: str
    qos: Qos
    send: Send
    readers: dict[bytes, _Reader] = field(default_factory=dict[bytes, _Reader])
    last: int = 0
    _history: deque[_Kept] = field(default_factory=deque[_Kept])
    _count: int = 0

    def __post_init__(self) -> None:
        self._history = deque(maxlen=self.qos.depth)

    def write(self, payload: bytes, inline: bytes = b"", target: bytes = b"") -> int:
        """Write a sample for all participants or for one of them; its sequence number."""
        self.last += 1
        kept = _Kept(self.last, _padded(payload), inline, target)
        self._history.append(kept)
        for prefix, proxy in {guid[:12]: proxy for guid, proxy in self.readers.items()}.items():
            if prefix.startswith(target):
                self._send_sample(prefix, wire.NO_ENTITY, proxy, kept)
            else:
                self._send_gap(prefix + wire.NO_ENTITY, proxy, [self.last])
        return self.last

    def match(self, guid: bytes, address: Address, qos: Qos) -> None:
        """Serve a reader from now on, with the kept samples where it requests them."""
        if guid in self.readers:
            self.readers[guid].address = address
            return
        gets_kept = self.qos.is_latched and qos.is_latched
        first = self._first if gets_kept else self.last + 1
        proxy = self.readers[guid] = _Reader(address, qos, first, first - 1)
        if gets_kept:
            for kept in self._history:
                self._send_sample(guid[:12], guid[12:], proxy, kept)
        elif qos.is_reliable and self.last:
            self._send_gap(guid, proxy, [1])

    def acknowledge(self, guid: bytes, base: int, missing: list[int]) -> None:
        """A reader has everything before `base`, and lacks some samples."""
        proxy = self.readers.get(guid)
        if proxy is None:
            return
        proxy.acknowledged = max(proxy.acknowledged, min(base - 1, self.last))
        kept = {each.number: each for each in self._history}
        lost: list[int] = []
        for number in missing:
            is_kept = number in kept and number >= proxy.first
            if is_kept and guid.startswith(kept[number].target):
                self._send_sample(guid[:12], guid[12:], proxy, kept[number], heartbeat=False)
            elif number <= self.last:
                lost.append(number)
        if lost:
            self._send_gap(guid, proxy, lost)
        if missing or base <= self.last:
            self.send(guid[:12], self._heartbeat(guid[12:], proxy), proxy.address)

    def resend_fragments(self, guid: bytes, number: int, places: list[int]) -> None:
        """Send fragments that a reader lacks."""
        proxy = self.readers.get(guid)
        kept = next((each for each in self._history if each.number == number), None)
        if proxy is None or kept is None:
            return
        for place in places:
            if 0 < place <= -(-len(kept.payload) // wire.FRAGMENT):
                part = wire.fragment(
                    guid[12:], self.entity, number, kept.payload, place, kept.inline
                )
                self.send(guid[:12], part, proxy.address)

    def remind(self) -> None:
        """Send a heartbeat to every reader that has not acknowledged everything."""
        for guid, proxy in self.readers.items():
            if proxy.qos.is_reliable and proxy.acknowledged < self.last:
                self.send(guid[:12], self._heartbeat(guid[12:], proxy), proxy.address)

    @property
    def _first(self) -> int:
        return self._history[0].number if self._history else self.last + 1

    def _send_sample(
        self, prefix: bytes, reader: bytes, proxy: _Reader, kept: _Kept, *, heartbeat: bool = True
    ) -> None:
        is_reliable = self.qos.is_reliable and proxy.qos.is_reliable
        after = self._heartbeat(reader, proxy) if heartbeat and is_reliable else b""
        if len(kept.payload) <= wire.FRAGMENT:
            sample = wire.data(reader, self.entity, kept.number, kept.payload, kept.inline)
            self.send(prefix, sample + after, proxy.address)
            return
        count = -(-len(kept.payload) // wire.FRAGMENT)
        for place in range(1, count + 1):
            part = wire.fragment(reader, self.entity, kept.number, kept.payload, place, kept.inline)
            self.send(prefix, part, proxy.address)
        if after:
            self.send(prefix, after, proxy.address)

    def _heartbeat(self, reader: bytes, proxy: _Reader) -> bytes:
        self._count += 1
        first = max(self._first, min(proxy.first, self.last + 1))
        body = reader + self.entity + wire.sequence_number(first)
        body += wire.sequence_number(self.last) + struct.pack("<I", self._count)
        return wire.submessage(wire.HEARTBEAT, body)

    def _send_gap(self, guid: bytes, proxy: _Reader, lost: list[int]) -> None:
        """Report samples that will not come: the named ones, and all before the kept ones."""
        base = max(lost[0], self._first, proxy.first)
        body = guid[12:] + self.entity + wire.sequence_number(lost[0])
        body += wire.number_set(base, lost)
        self.send(guid[:12], wire.submessage(wire.GAP, body), proxy.address)


def _padded(payload: bytes) -> bytes:
    """The payload in whole words, with the count of added bytes where XTypes has it.

    Cyclone DDS drops submessages of other lengths.
    """
    missing = -len(payload) % 4
    if not missing:
        return payload
    return payload[:3] + bytes([payload[3] | missing]) + payload[4:] + bytes(missing)
