"""A writer: its history, the readers it serves, and what they lack."""

from __future__ import annotations

import struct
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from harness.plugins.ros.rtps import wire
from harness.plugins.ros.rtps.discovery import Endpoint
from harness.plugins.ros.rtps.wire import Address

Serves = Callable[[Endpoint], bool]  # whether a reader gets samples
Send = Callable[[bytes, bytes, Address], None]  # to a prefix, the submessages, at an address


@dataclass
class _Reader:
    """A matched reader of another participant; `first` is the first sample that it gets."""

    address: Address
    is_reliable: bool
    first: int
    acknowledged: int


@dataclass(frozen=True)
class _Kept:
    """A sample of the history."""

    number: int
    payload: bytes
    inline: bytes


def serves_all(_: Endpoint) -> bool:
    """Whether a reader gets samples: every one does."""
    return True


class Writer:
    """A reliable writer of one topic.

    Attributes:
        matched: The readers of other participants, by GUID.
        last: The sequence number of the last sample.
    """

    def __init__(self, endpoint: Endpoint, send: Send, serves: Serves = serves_all) -> None:
        self.endpoint, self._entity, self._send = endpoint, endpoint.guid[12:], send
        self.matched: dict[bytes, _Reader] = {}
        self._serves = serves
        self.last = self._count = 0
        self._history: deque[_Kept] = deque(maxlen=endpoint.qos.depth)

    def write(self, payload: bytes, inline: bytes = b"") -> None:
        """Write a sample, once for all readers of a participant."""
        self.last += 1
        kept = _Kept(self.last, _padded(payload), inline)
        self._history.append(kept)
        for prefix, proxy in {guid[:12]: proxy for guid, proxy in self.matched.items()}.items():
            self._send_sample(prefix + wire.NO_ENTITY, proxy, kept, heartbeat=proxy.is_reliable)

    def match(self, other: Endpoint, address: Address) -> None:
        """Serve a reader from now on, with the kept samples where it requests them."""
        if not self._serves(other):
            return
        guid, qos = other.guid, other.qos
        if guid in self.matched:
            self.matched[guid].address = address
            return
        gets_kept = self.endpoint.qos.is_latched and qos.is_latched
        first = self._first if gets_kept else self.last + 1
        proxy = self.matched[guid] = _Reader(address, qos.is_reliable, first, first - 1)
        if gets_kept:
            for kept in self._history:
                self._send_sample(guid, proxy, kept, heartbeat=qos.is_reliable)
        elif qos.is_reliable and self.last:
            self._send_gap(guid, proxy, [1])

    def acknowledge(self, guid: bytes, base: int, missing: list[int]) -> None:
        """A reader has everything before `base`, and lacks some samples."""
        proxy = self.matched.get(guid)
        if proxy is None:
            return
        proxy.acknowledged = max(proxy.acknowledged, min(base - 1, self.last))
        kept = {each.number: each for each in self._history if each.number >= proxy.first}
        for number in sorted(kept.keys() & missing):
            self._send_sample(guid, proxy, kept[number], heartbeat=False)
        lost = [number for number in missing if number not in kept and number <= self.last]
        if lost:
            self._send_gap(guid, proxy, lost)
        if missing or base <= self.last:
            self._send(guid[:12], self._heartbeat(guid, proxy), proxy.address)

    def remind(self) -> None:
        """Send a heartbeat to every reader that has not acknowledged everything."""
        for guid, proxy in self.matched.items():
            if proxy.is_reliable and proxy.acknowledged < self.last:
                self._send(guid[:12], self._heartbeat(guid, proxy), proxy.address)

    @property
    def _first(self) -> int:
        return self._history[0].number if self._history else self.last + 1

    def _send_sample(self, guid: bytes, proxy: _Reader, kept: _Kept, *, heartbeat: bool) -> None:
        whole = guid[12:], self._entity, kept.number, kept.payload, kept.inline
        *parts, end = wire.fragments(*whole)
        for part in parts:
            self._send(guid[:12], part, proxy.address)
        after = self._heartbeat(guid, proxy) if heartbeat else b""
        self._send(guid[:12], end + after, proxy.address)

    def _heartbeat(self, guid: bytes, proxy: _Reader) -> bytes:
        self._count += 1
        first = max(self._first, min(proxy.first, self.last + 1))
        body = guid[12:] + self._entity + wire.sequence_number(first)
        body += wire.sequence_number(self.last) + struct.pack("<I", self._count)
        return wire.submessage(wire.HEARTBEAT, body)

    def _send_gap(self, guid: bytes, proxy: _Reader, lost: list[int]) -> None:
        """Report samples that will not come: the named ones, and all before the kept ones."""
        base = max(lost[0], self._first, proxy.first)
        body = guid[12:] + self._entity + wire.sequence_number(lost[0])
        body += wire.number_set(base, lost)
        self._send(guid[:12], wire.submessage(wire.GAP, body), proxy.address)


def _padded(payload: bytes) -> bytes:
    """The payload in whole words, with the count of added bytes where XTypes has it.

    Cyclone DDS drops submessages of other lengths.
    """
    missing = -len(payload) % 4
    return payload[:3] + bytes([payload[3] | missing]) + payload[4:] + bytes(missing)
