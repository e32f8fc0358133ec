"""A reader: samples of each writer in order, and what it lacks of them."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from harness.core.limits import RTPS_MEMORY, RTPS_PARTIAL, RTPS_SAMPLE, RTPS_WAITING
from harness.plugins.ros.rtps import wire
from harness.plugins.ros.rtps.discovery import Endpoint
from harness.plugins.ros.rtps.wire import Address, Sample
from harness.plugins.ros.rtps.writer import Send


@dataclass
class _Writer:
    """A matched writer of another participant.

    Attributes:
        expected: The number of the next sample; 0 before anything is known.
        waiting: Samples that wait for an earlier one, by number.
        partial: The fragments of samples that are not whole, by the numbers of both.
        count: The number of acknowledgements so far.
    """

    address: Address
    is_reliable: bool
    expected: int = 0
    waiting: dict[int, Sample] = field(default_factory=dict[int, Sample])
    partial: dict[int, dict[int, bytes]] = field(default_factory=dict[int, dict[int, bytes]])
    count: int = 0

    def bytes_waiting(self) -> int:
        """The bytes of whole samples that wait."""
        return sum(len(sample.payload) for sample in self.waiting.values())


class Reader:
    """A reader of one topic; `matched` has the writers of other participants, by GUID."""

    def __init__(self, endpoint: Endpoint, send: Send, deliver: Callable[[Sample], None]) -> None:
        """Call `deliver` with every whole sample, those of a writer in order."""
        self.endpoint, self._send, self._deliver = endpoint, send, deliver
        self.matched: dict[bytes, _Writer] = {}

    def match(self, other: Endpoint, address: Address) -> None:
        """Listen to a writer from now on."""
        is_reliable = self.endpoint.qos.is_reliable and other.qos.is_reliable
        proxy = self.matched.setdefault(other.guid, _Writer(address, is_reliable))
        proxy.address = address
        if is_reliable:
            self._request_heartbeat(other.guid, proxy)

    def take(self, sample: Sample) -> None:
        """A sample or a fragment of a matched writer arrived."""
        proxy = self.matched.get(sample.writer)
        if proxy is None or sample.number < proxy.expected:  # a copy through another address
            return
        whole = _assembled(proxy, sample) if sample.first else sample
        if whole is None:
            return
        if not proxy.is_reliable:  # none before this one is waited for
            proxy.expected = sample.number
        elif not proxy.expected:  # whether there is one before it, a heartbeat says
            self._request_heartbeat(sample.writer, proxy)
        proxy.waiting[sample.number] = whole
        while len(proxy.waiting) > RTPS_WAITING or proxy.bytes_waiting() > RTPS_MEMORY:
            del proxy.waiting[max(proxy.waiting)]  # it is requested again
        self._drain(proxy)

    def heartbeat(self, guid: bytes, first: int, last: int, *, is_final: bool) -> None:
        """A writer has samples `first` to `last`; request what is missing."""
        proxy = self.matched.get(guid)
        if proxy is None or not proxy.is_reliable:
            return
        proxy.expected = max(proxy.expected, first)
        self._drain(proxy)
        end = min(last, proxy.expected + wire.MOST_BITS - 1)
        missing = [n for n in range(proxy.expected, end + 1) if n not in proxy.waiting]
        if missing or not is_final:
            self._acknowledge(guid, proxy, proxy.expected, missing)

    def gap(self, guid: bytes, first: int, base: int, numbers: list[int]) -> None:
        """Samples `first` to `base` - 1, and some more, will never come."""
        proxy = self.matched.get(guid)
        if proxy is None:
            return
        if first <= max(proxy.expected, 1):
            proxy.expected = max(proxy.expected, base)
        while proxy.expected in numbers:
            proxy.expected += 1
        self._drain(proxy)

    def _request_heartbeat(self, guid: bytes, proxy: _Writer) -> None:
        """Fast DDS answers a base of 0 at once, and 1 with its next heartbeat, 3 s later."""
        self._acknowledge(guid, proxy, 0 if guid.startswith(wire.FAST_DDS) else 1, [])

    def _drain(self, proxy: _Writer) -> None:
        for passed in (proxy.waiting, proxy.partial):
            for number in [number for number in passed if number < proxy.expected]:
                del passed[number]
        while proxy.expected in proxy.waiting:
            sample = proxy.waiting.pop(proxy.expected)
            proxy.expected += 1
            self._deliver(sample)

    def _acknowledge(self, guid: bytes, proxy: _Writer, base: int, missing: list[int]) -> None:
        proxy.count += 1
        body = self.endpoint.guid[12:] + guid[12:] + wire.number_set(base, missing)
        body += struct.pack("<I", proxy.count)
        self._send(guid[:12], wire.submessage(wire.ACKNACK, body), proxy.address)


def _assembled(proxy: _Writer, sample: Sample) -> Sample | None:
    """The whole sample when this fragment was its last; None before."""
    size, step = sample.size, sample.fragment_size
    if size > RTPS_SAMPLE or step == 0:
        return None
    count = -(-size // step)
    if sample.number not in proxy.partial and len(proxy.partial) >= RTPS_PARTIAL:
        return None  # it is sent again when those before it are whole
    parts = proxy.partial.setdefault(sample.number, {})
    for place, begin in enumerate(range(0, len(sample.payload), step), sample.first):
        if place <= count:
            parts[place] = sample.payload[begin : begin + step]
    if len(parts) < count:
        return None
    del proxy.partial[sample.number]
    return replace(sample, payload=b"".join(parts[place] for place in sorted(parts))[:size])
