"""A reader: samples of each writer in order, and what it lacks of them."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass, field

from harness.ros.rtps import wire
from harness.ros.rtps.writer import Address, Qos, Send

FAST_DDS = b"\x01\x0f"
"""Vendor at the start of a GUID."""

MOST_WAITING = 4096
"""Samples of one writer that wait for an earlier one."""


@dataclass(frozen=True)
class Received:
    """A sample that arrived.

    Attributes:
        writer: GUID of its writer.
        number: The sequence number of the sample.
        payload: Encapsulation header and content.
        inline: Parameters that came with it.
    """

    writer: bytes
    number: int
    payload: bytes
    inline: dict[int, bytes]


@dataclass
class _Partial:
    """A sample of which fragments are missing."""

    content: bytearray
    missing: set[int]


@dataclass
class _Writer:
    """A matched writer of another participant."""

    address: Address
    qos: Qos
    expected: int = 0
    """Number of the next sample; 0 before anything is known."""
    waiting: dict[int, Received] = field(default_factory=dict[int, Received])
    partial: dict[int, _Partial] = field(default_factory=dict[int, _Partial])
    count: int = 0


@dataclass
class Reader:
    """A reader of one topic.

    Attributes:
        entity: The entity identifier of the reader.
        topic: The name of the topic in DDS.
        type_name: The name of its type in DDS.
        qos: The quality that it requests.
        send: Sends submessages to another participant.
        deliver: Called with every sample, those of a writer in order.
    """

    entity: bytes
    topic: str
    type_name: str
    qos: Qos
    send: Send
    deliver: Callable[[Received], None]
    writers: dict[bytes, _Writer] = field(default_factory=dict[bytes, _Writer])

    def match(self, guid: bytes, address: Address, qos: Qos) -> None:
        """Listen to a writer from now on."""
        proxy = self.writers.setdefault(guid, _Writer(address, qos))
        proxy.address = address
        if self.qos.is_reliable and qos.is_reliable:
            # what was sent before comes again: Fast DDS answers a base of 0 at once, and one of 1
            # with its next heartbeat, three seconds later
            self._acknowledge(guid, proxy, 0 if guid.startswith(FAST_DDS) else 1, [])

    def take(self, guid: bytes, sample: wire.Sample) -> None:
        """A sample or a fragment of a matched writer arrived."""
        proxy = self.writers.get(guid)
        if proxy is None:
            return
        whole = self._assembled(proxy, sample) if sample.first else sample.payload
        if whole is None:
            return
        received = Received(guid, sample.number, whole, sample.inline)
        if not (self.qos.is_reliable and proxy.qos.is_reliable):
            if sample.number >= proxy.expected:
                proxy.expected = sample.number + 1
                self.deliver(received)
            return
        proxy.expected = proxy.expected or sample.number
        if sample.number >= proxy.expected and len(proxy.waiting) < MOST_WAITING:
            proxy.waiting[sample.number] = received
            self._drain(proxy)

    def heartbeat(self, guid: bytes, first: int, last: int, *, is_final: bool) -> None:
        """A writer has samples `first` to `last`; request what is missing."""
        proxy = self.writers.get(guid)
        if proxy is None or not self.qos.is_reliable:
            return
        proxy.expected = max(proxy.expected, first)
        self._drain(proxy)
        end = min(last, proxy.expected + wire.MOST_BITS - 1)
        missing = [n for n in range(proxy.expected, end + 1) if n not in proxy.waiting]
        if missing or not is_final:
            self._acknowledge(guid, proxy, proxy.expected, missing)

    def gap(self, guid: bytes, first: int, base: int, numbers: list[int]) -> None:
        """Samples `first` to `base` - 1, and some more, will never come."""
        proxy = self.writers.get(guid)
        if proxy is None:
            return
        if first <= (proxy.expected or first):
            proxy.expected = max(proxy.expected, base)
        while proxy.expected in numbers:
            proxy.expected += 1
        self._drain(proxy)

    def _drain(self, proxy: _Writer) -> None:
        for number in [n for n in proxy.waiting if n < proxy.expected]:
            del proxy.waiting[number]
        for number in [n for n in proxy.partial if n < proxy.expected]:
            del proxy.partial[number]
        while proxy.expected in proxy.waiting:
            received = proxy.waiting.pop(proxy.expected)
            proxy.expected += 1
            self.deliver(received)

    def _acknowledge(self, guid: bytes, proxy: _Writer, base: int, missing: list[int]) -> None:
        proxy.count += 1
        body = self.entity + guid[12:] + wire.number_set(base, missing)
        body += struct.pack("<I", proxy.count)
        self.send(guid[:12], wire.submessage(wire.ACKNACK, body), proxy.address)

    def _assembled(self, proxy: _Writer, sample: wire.Sample) -> bytes | None:
        """The whole sample when this fragment was its last; None before."""
        if sample.size > wire.LARGEST_SAMPLE or sample.fragment_size == 0:
            return None
        count = -(-sample.size // sample.fragment_size)
        partial = proxy.partial.get(sample.number)
        if partial is None:
            partial = _Partial(bytearray(sample.size), set(range(1, count + 1)))
            proxy.partial[sample.number] = partial
        place, rest = sample.first, memoryview(sample.payload)
        while len(rest) and place <= count and len(partial.content) == sample.size:
            begin = (place - 1) * sample.fragment_size
            part = rest[: min(sample.fragment_size, sample.size - begin)]
            partial.content[begin : begin + len(part)] = part
            partial.missing.discard(place)
            place, rest = place + 1, rest[sample.fragment_size :]
        if partial.missing:
            return None
        del proxy.partial[sample.number]
        return bytes(partial.content)
