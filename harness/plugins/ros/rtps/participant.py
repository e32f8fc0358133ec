"""A participant of a DDS domain: discovery, and its writers and readers."""

from __future__ import annotations

import os
import struct
import time
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress

from harness.core.limits import RTPS_ENDPOINTS, RTPS_PEERS
from harness.plugins.ros.endpoints import Qos
from harness.plugins.ros.rtps import wire
from harness.plugins.ros.rtps.discovery import Endpoint, Peer, announcement, farewell, is_gone
from harness.plugins.ros.rtps.reader import Reader
from harness.plugins.ros.rtps.sockets import Sockets
from harness.plugins.ros.rtps.wire import Address, Sample
from harness.plugins.ros.rtps.writer import Serves, Writer, serves_all

ANNOUNCE_EVERY = 1.0  # [s], of a participant to others
REMIND_EVERY = 0.1  # [s], heartbeats of a writer until all is acknowledged
DISCOVERY_PAIRS = (
    (wire.PUBLICATIONS_WRITER, wire.PUBLICATIONS_READER),
    (wire.SUBSCRIPTIONS_WRITER, wire.SUBSCRIPTIONS_READER),
)
"""Entities with which participants announce their writers and their readers."""


class Participant:
    """Writers and readers of this process in a domain; everything happens inside `spin`."""

    def __init__(self, domain: int, *, name: str, is_local: bool = True) -> None:
        """Join a domain, 0 to 232, under a name for tools.

        Raises:
            NetworkError: It has no free port.
        """
        self.domain = domain
        self.prefix = wire.VENDOR + os.urandom(10)
        self.guid = self.prefix + wire.PARTICIPANT
        self._sockets = Sockets(domain, is_local=is_local)
        self._announcement = announcement(self.guid, domain, name, self._sockets.unicast)
        self._peers: dict[bytes, Peer] = {}
        self._writers: dict[bytes, Writer] = {}
        self._readers: dict[bytes, Reader] = {}
        self._arrived: deque[tuple[Callable[[Sample], None], Sample]] = deque()
        self._next_announcement = self._next_reminder = 0.0
        builtin = Qos(is_latched=True, depth=1000)
        for writer, reader in DISCOVERY_PAIRS:
            written, read = (Endpoint(self.prefix + e, "", "", builtin) for e in (writer, reader))
            self._writers[writer] = Writer(written, self._send)
            self._readers[reader] = Reader(read, self._send, self._take_endpoint)

    def writer(self, topic: str, type_name: str, qos: Qos, serves: Serves = serves_all) -> Writer:
        """A writer of a topic for some of its readers, known to the peers from now on."""
        made = Writer(self._endpoint(0x03, topic, type_name, qos), self._send, serves)
        self._writers[made.endpoint.guid[12:]] = made
        self._publish(wire.PUBLICATIONS_WRITER, made)
        return made

    def reader(
        self, topic: str, type_name: str, qos: Qos, deliver: Callable[[Sample], None]
    ) -> Reader:
        """A reader of a topic, known to the peers from now on."""
        endpoint = self._endpoint(0x04, topic, type_name, qos)
        made = Reader(endpoint, self._send, lambda sample: self._arrived.append((deliver, sample)))
        self._readers[made.endpoint.guid[12:]] = made
        self._publish(wire.SUBSCRIPTIONS_WRITER, made)
        return made

    def own_endpoints(self) -> list[Endpoint]:
        """The writers and readers of this participant."""
        return [each.endpoint for each in self._all() if each.endpoint.topic]

    def known_endpoints(self) -> list[Endpoint]:
        """The writers and readers of all peers."""
        return [each for peer in self._peers.values() for each in peer.endpoints.values()]

    def known_endpoint(self, guid: bytes) -> Endpoint | None:
        """A writer or reader of a peer; None where it is not known (any more)."""
        peer = self._peers.get(guid[:12])
        return peer.endpoints.get(guid) if peer is not None else None

    @property
    def is_first(self) -> bool:
        """Whether it has the first port of its domain, which others had if they were earlier."""
        return self._sockets.is_first

    def endpoint_counts(self) -> list[int]:
        """The numbers of endpoints that are known of each peer."""
        return [len(peer.endpoints) for peer in self._peers.values()]

    def spin(self, until: float, is_enough: Callable[[], bool] = lambda: False) -> None:
        """Receive, answer and announce; at least once.

        Args:
            until: The moment of `time.monotonic` at which it ends.
            is_enough: Whether to end earlier, after what was received.
        """
        while True:
            self._tend()
            left = until - time.monotonic()
            due = min(self._next_announcement, self._next_reminder) - time.monotonic()
            datagrams = list(self._sockets.receive(max(0.0, min(left, due))))
            for datagram in datagrams:
                self._receive(datagram)
            if is_enough():
                return
            if left <= 0 and (not datagrams or left < -0.05):  # the latter under a flood of them
                return

    def close(self) -> None:
        """Leave the domain, and let the peers know."""
        for prefix, peer in self._peers.items():
            self._send(prefix, farewell(self.guid), peer.meta)
        self._sockets.close()

    def _tend(self) -> None:
        now = time.monotonic()
        if now >= self._next_reminder:
            self._next_reminder = now + REMIND_EVERY
            for writer in self._writers.values():
                writer.remind()
        if now >= self._next_announcement:
            self._next_announcement = now + ANNOUNCE_EVERY
            for prefix, peer in list(self._peers.items()):
                if now - peer.seen > peer.lease:
                    self._forget(prefix)
            known = {peer.meta for peer in self._peers.values()}
            self._announce(*(self._sockets.announced | known))

    def _send(self, prefix: bytes, content: bytes, address: Address) -> None:
        target = wire.submessage(wire.INFO_DST, prefix) if prefix else b""
        self._sockets.send(wire.header(self.prefix) + target + content, address)

    def _receive(self, datagram: bytes) -> None:
        if datagram[:4] == b"RTPS" and datagram[8:20] != self.prefix:
            # garbage is no message
            with suppress(struct.error, IndexError, KeyError, ValueError):
                self._take(datagram)
        while self._arrived:
            deliver, sample = self._arrived.popleft()
            deliver(sample)

    def _take(self, datagram: bytes) -> None:
        source, is_for_us = datagram[8:20], True
        if source in self._peers:
            self._peers[source].seen = time.monotonic()
        for message in wire.submessages(datagram):
            if message.kind == wire.INFO_DST:
                is_for_us = message.body[:12] in (self.prefix, bytes(12))
            elif is_for_us and message.kind in (wire.DATA, wire.DATA_FRAG):
                self._take_sample(source, wire.sample_of(source, message))
            elif is_for_us:
                self._take_status(source, message)

    def _take_status(self, source: bytes, message: wire.Submessage) -> None:
        """What a peer's writer has, or what its reader lacks."""
        first, second = message.body[:4], message.body[4:8]
        if message.kind == wire.HEARTBEAT:
            oldest, last = message.number(8), message.number(16)
            for reader in self._addressed(first, source + second):
                reader.heartbeat(source + second, oldest, last, is_final=bool(message.flags & 2))
        elif message.kind == wire.GAP:
            for reader in self._addressed(first, source + second):
                reader.gap(source + second, message.number(8), *message.numbers(16))
        elif message.kind == wire.ACKNACK and second in self._writers:
            self._writers[second].acknowledge(source + first, *message.numbers(8))
        elif message.kind == wire.NACK_FRAG and second in self._writers:  # it lacks fragments of it
            self._writers[second].acknowledge(source + first, 0, [message.number(8)])

    def _take_sample(self, source: bytes, sample: Sample) -> None:
        if sample.writer[12:] == wire.SPDP_WRITER:
            self._take_participant(source, sample)
            return
        if source in self._peers:
            self._peers[source].knows_us = True
        for reader in self._addressed(sample.reader, sample.writer):
            reader.take(sample)

    def _addressed(self, entity: bytes, writer: bytes) -> Iterable[Reader]:
        if entity != wire.NO_ENTITY:
            return (self._readers[entity],) if entity in self._readers else ()
        return [reader for reader in self._readers.values() if writer in reader.matched]

    def _announce(self, *addresses: Address) -> None:
        for address in addresses:
            self._send(b"", self._announcement, address)

    def _endpoint(self, kind: int, topic: str, type_name: str, qos: Qos) -> Endpoint:
        entity = (len(self._writers) + len(self._readers)).to_bytes(3, "big") + bytes([kind])
        return Endpoint(self.prefix + entity, topic, type_name, qos)

    def _publish(self, announcer: bytes, made: Writer | Reader) -> None:
        self._writers[announcer].write(made.endpoint.payload())
        for peer in self._peers.values():
            for other in peer.endpoints.values():
                self._match(made, other, peer)

    def _take_participant(self, source: bytes, sample: Sample) -> None:
        if is_gone(sample.inline):
            self._forget(source)
            return
        known = Peer.parsed(sample.payload, self._sockets.reachable)
        if known is None or known.domain not in (None, self.domain):
            return
        if source not in self._peers and len(self._peers) >= RTPS_PEERS:
            return
        peer = self._peers.setdefault(source, known)
        if not peer.knows_us:  # it may not have listened yet when the last announcement came
            self._announce(peer.meta)
            latched = Qos(is_latched=True)
            for writer, reader in DISCOVERY_PAIRS:
                self._writers[writer].match(Endpoint(source + reader, "", "", latched), peer.meta)
                self._readers[reader].match(Endpoint(source + writer, "", "", latched), peer.meta)

    def _take_endpoint(self, sample: Sample) -> None:
        """A peer made or removed a writer or a reader."""
        if is_gone(sample.inline):
            key = sample.inline.get(wire.PID_KEY_HASH)
            self._forget(key or wire.parameters_of(sample.payload)[wire.PID_ENDPOINT][0][:16])
            return
        endpoint = Endpoint.parsed(sample.payload)
        peer = self._peers.get(endpoint.guid[:12])
        if peer is not None and len(peer.endpoints) < RTPS_ENDPOINTS:
            peer.endpoints[endpoint.guid] = endpoint
            for mine in self._all():
                self._match(mine, endpoint, peer)

    def _match(self, mine: Writer | Reader, other: Endpoint, peer: Peer) -> None:
        """Connect two endpoints where they fit."""
        if mine.endpoint.matches(other):
            mine.match(other, self._sockets.reachable(other.addresses) or peer.user)

    def _forget(self, gone: bytes) -> None:
        """Remove an endpoint, or a participant with all endpoints, by GUID or prefix."""
        self._peers.pop(gone, None)
        if gone[:12] in self._peers:
            self._peers[gone[:12]].endpoints.pop(gone, None)
        for mine in self._all():
            for guid in [guid for guid in mine.matched if guid.startswith(gone)]:
                del mine.matched[guid]

    def _all(self) -> list[Writer | Reader]:
        return [*self._writers.values(), *self._readers.values()]
