"""A participant of a DDS domain: discovery, and its writers and readers."""

from __future__ import annotations

import os
import struct
import time
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field

from harness.core.errors import Problem, SpecError
from harness.ros.rtps import wire
from harness.ros.rtps.discovery import Endpoint, ParticipantData, announcement, farewell, is_gone
from harness.ros.rtps.reader import Reader, Received
from harness.ros.rtps.sockets import Sockets
from harness.ros.rtps.writer import Address, Qos, Writer

MOST_DOMAINS = 232
ANNOUNCE_EVERY = 1.0
REMIND_EVERY = 0.1


@dataclass
class _Peer:
    """Another participant."""

    meta: Address
    user: Address
    lease: float
    seen: float
    knows_us: bool = False
    endpoints: dict[bytes, Endpoint] = field(default_factory=dict[bytes, Endpoint])


class Participant:
    """Writers and readers of this process in a domain; everything happens inside `spin`."""

    def __init__(self, domain: int, *, name: str, is_local: bool = True) -> None:
        """Join a domain.

        Args:
            domain: Its number, 0 to 232.
            name: What tools call this participant.
            is_local: Whether it talks to this machine alone.

        Raises:
            SpecError: There is no such domain.
            NetworkError: It has no free port.
        """
        if not 0 <= domain <= MOST_DOMAINS:
            said = f"domains are 0 to {MOST_DOMAINS}"
            raise SpecError([Problem(f"ROS domain {domain}", 0, 0, said)])
        self.domain, self.name = domain, name
        self.prefix = wire.VENDOR + os.urandom(10)
        self._sockets = Sockets(domain, is_local=is_local)
        self._peers: dict[bytes, _Peer] = {}
        self._writers: dict[bytes, Writer] = {}
        self._readers: dict[bytes, Reader] = {}
        self._arrived: deque[tuple[Callable[[Received], None], Received]] = deque()
        self._entities = 0
        self._next_announcement = self._next_reminder = 0.0
        self._publications = self._builtin_writer(wire.PUBLICATIONS_WRITER)
        self._subscriptions = self._builtin_writer(wire.SUBSCRIPTIONS_WRITER)
        self._builtin_reader(wire.PUBLICATIONS_READER)
        self._builtin_reader(wire.SUBSCRIPTIONS_READER)

    # -- endpoints ----------------------------------------------------------------------------

    def writer(self, topic: str, type_name: str, qos: Qos) -> Writer:
        """A writer of a topic, known to the peers from now on."""
        entity = self._entity(0x03)
        made = Writer(entity, topic, type_name, qos, self._send)
        self._writers[entity] = made
        self._announce_endpoint(self._publications, made)
        return made

    def reader(
        self, topic: str, type_name: str, qos: Qos, deliver: Callable[[Received], None]
    ) -> Reader:
        """A reader of a topic, known to the peers from now on."""
        entity = self._entity(0x04)

        def arrive(received: Received) -> None:
            self._arrived.append((deliver, received))

        made = Reader(entity, topic, type_name, qos, self._send, arrive)
        self._readers[entity] = made
        self._announce_endpoint(self._subscriptions, made)
        return made

    def guid(self, entity: bytes) -> bytes:
        """The GUID of an endpoint of this participant."""
        return self.prefix + entity

    def own_topics(self) -> tuple[set[str], set[str]]:
        """Names in DDS of the topics that are written and read here."""
        written = {each.topic for each in self._writers.values()}
        return written, {each.topic for each in self._readers.values()}

    def known_topics(self) -> tuple[set[str], set[str]]:
        """Names in DDS of the topics that peers write and read."""
        written: set[str] = set()
        read: set[str] = set()
        for peer in self._peers.values():
            for endpoint in peer.endpoints.values():
                (written if endpoint.is_writer else read).add(endpoint.topic)
        return written, read

    # -- time ---------------------------------------------------------------------------------

    def spin(self, until: float) -> None:
        """Receive, answer and announce until a moment of `time.monotonic`; at least once."""
        while True:
            self._tend()
            left = until - time.monotonic()
            due = min(self._next_announcement, self._next_reminder) - time.monotonic()
            is_quiet = True
            for datagram in self._sockets.receive(max(0.0, min(left, due))):
                is_quiet = False
                self._receive(datagram)
            if (left <= 0 and is_quiet) or left < -0.05:  # the latter under a flood of messages
                return

    def close(self) -> None:
        """Leave the domain, and let the peers know."""
        for prefix, peer in self._peers.items():
            self._send(prefix, farewell(self.guid(wire.PARTICIPANT)), peer.meta)
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

    # -- messages -----------------------------------------------------------------------------

    def _send(self, prefix: bytes, content: bytes, address: Address) -> None:
        target = wire.submessage(wire.INFO_DST, prefix) if prefix else b""
        self._sockets.send(wire.header(self.prefix) + target + content, address)

    def _receive(self, datagram: bytes) -> None:
        if datagram[:4] == b"RTPS" and datagram[8:20] != self.prefix:
            # garbage is no message
            with suppress(struct.error, IndexError, KeyError, ValueError):
                self._take(datagram)
        while self._arrived:
            deliver, received = self._arrived.popleft()
            deliver(received)

    def _take(self, datagram: bytes) -> None:
        source, is_for_us = datagram[8:20], True
        if source in self._peers:
            self._peers[source].seen = time.monotonic()
        for message in wire.submessages(datagram):
            if message.kind == wire.INFO_DST:
                is_for_us = message.body[:12] in (self.prefix, bytes(12))
            elif is_for_us:
                self._take_submessage(source, message)

    def _take_submessage(self, source: bytes, message: wire.Submessage) -> None:
        body, order = message.body, message.order
        if message.kind in (wire.DATA, wire.DATA_FRAG):
            self._take_sample(source, message)
        elif message.kind == wire.HEARTBEAT:
            first, last = wire.number_at(body, 8, order), wire.number_at(body, 16, order)
            for reader in self._addressed(body[:4], source + body[4:8]):
                reader.heartbeat(source + body[4:8], first, last, is_final=bool(message.flags & 2))
        elif message.kind == wire.GAP:
            base, numbers = wire.numbers_of(body, 16, order)
            for reader in self._addressed(body[:4], source + body[4:8]):
                reader.gap(source + body[4:8], wire.number_at(body, 8, order), base, numbers)
        elif message.kind == wire.ACKNACK and body[4:8] in self._writers:
            base, numbers = wire.numbers_of(body, 8, order)
            self._writers[body[4:8]].acknowledge(source + body[:4], base, numbers)
        elif message.kind == wire.NACK_FRAG and body[4:8] in self._writers:
            number, places = wire.number_at(body, 8, order), wire.fragments_of(body, 16, order)
            self._writers[body[4:8]].resend_fragments(source + body[:4], number, places)

    def _take_sample(self, source: bytes, message: wire.Submessage) -> None:
        sample = wire.sample_of(message)
        if sample.writer == wire.SPDP_WRITER:
            self._take_participant(source, sample)
            return
        if source in self._peers:
            self._peers[source].knows_us = True
        for reader in self._addressed(sample.reader, source + sample.writer):
            reader.take(source + sample.writer, sample)

    def _addressed(self, entity: bytes, writer: bytes) -> Iterable[Reader]:
        if entity != wire.NO_ENTITY:
            return (self._readers[entity],) if entity in self._readers else ()
        return [reader for reader in self._readers.values() if writer in reader.writers]

    # -- discovery ----------------------------------------------------------------------------

    def _announce(self, *addresses: Address) -> None:
        guid, own = self.guid(wire.PARTICIPANT), self._sockets.unicast
        payload = announcement(guid, self.domain, self.name, own)
        sample = wire.data(wire.NO_ENTITY, wire.SPDP_WRITER, 1, payload)
        for address in addresses:
            self._send(b"", sample, address)

    def _announce_endpoint(self, publisher: Writer, made: Writer | Reader) -> None:
        guid, own = self.guid(made.entity), self._sockets.unicast[-1:]
        publisher.write(Endpoint(guid, made.topic, made.type_name, made.qos, own).payload())
        for peer in self._peers.values():
            for endpoint in peer.endpoints.values():
                self._match(made, endpoint, peer)

    def _take_participant(self, source: bytes, sample: wire.Sample) -> None:
        if is_gone(sample.inline):
            self._forget(source)
            return
        known = ParticipantData.parsed(sample.payload)
        meta = self._sockets.reachable(known.meta)
        if meta is None or known.domain not in (None, self.domain):
            return
        is_new = source not in self._peers
        user = self._sockets.reachable(known.user) or meta
        peer = self._peers.setdefault(source, _Peer(meta, user, known.lease, time.monotonic()))
        peer.lease = known.lease
        if not peer.knows_us:  # it may not have listened yet when the last announcement came
            self._announce(meta)
        if is_new:
            latched = Qos(is_latched=True)
            for writer, reader in (
                (wire.PUBLICATIONS_WRITER, wire.PUBLICATIONS_READER),
                (wire.SUBSCRIPTIONS_WRITER, wire.SUBSCRIPTIONS_READER),
            ):
                self._writers[writer].match(source + reader, meta, latched)
                self._readers[reader].match(source + writer, meta, latched)

    def _forget(self, prefix: bytes) -> None:
        self._peers.pop(prefix, None)
        for writer in self._writers.values():
            for guid in [guid for guid in writer.readers if guid[:12] == prefix]:
                del writer.readers[guid]
        for reader in self._readers.values():
            for guid in [guid for guid in reader.writers if guid[:12] == prefix]:
                del reader.writers[guid]

    def _take_endpoint(self, received: Received) -> None:
        """A peer made or removed a writer or a reader."""
        if is_gone(received.inline):
            self._remove_endpoint(received)
            return
        endpoint = Endpoint.parsed(received.payload)
        peer = self._peers.get(endpoint.guid[:12])
        if peer is not None:
            peer.endpoints[endpoint.guid] = endpoint
            for mine in (self._readers if endpoint.is_writer else self._writers).values():
                self._match(mine, endpoint, peer)

    def _match(self, mine: Writer | Reader, other: Endpoint, peer: _Peer) -> None:
        """Connect two endpoints where direction, topic, type and quality allow it."""
        is_same = (other.topic, other.type_name) == (mine.topic, mine.type_name)
        is_writer = isinstance(mine, Writer)
        offered, requested = (mine.qos, other.qos) if is_writer else (other.qos, mine.qos)
        if is_same and other.is_writer != is_writer and offered.serves(requested):
            address = self._sockets.reachable(other.addresses) or peer.user
            mine.match(other.guid, address, other.qos)

    def _remove_endpoint(self, received: Received) -> None:
        guid = received.inline.get(wire.PID_KEY_HASH)
        if guid is None and len(received.payload) > 4:
            guid = wire.parameters_of(received.payload)[wire.PID_ENDPOINT][0][:16]
        if guid is None:
            return
        if guid[:12] in self._peers:
            self._peers[guid[:12]].endpoints.pop(guid, None)
        for writer in self._writers.values():
            writer.readers.pop(guid, None)
        for reader in self._readers.values():
            reader.writers.pop(guid, None)

    def _builtin_writer(self, entity: bytes) -> Writer:
        made = Writer(entity, "", "", Qos(is_latched=True, depth=1000), self._send)
        self._writers[entity] = made
        return made

    def _builtin_reader(self, entity: bytes) -> None:
        qos = Qos(is_latched=True)
        self._readers[entity] = Reader(entity, "", "", qos, self._send, self._take_endpoint)

    def _entity(self, kind: int) -> bytes:
        self._entities += 1
        return self._entities.to_bytes(3, "big") + bytes([kind])
