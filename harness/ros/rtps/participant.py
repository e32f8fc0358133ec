"""A participant of a DDS domain: sockets, discovery, and its writers and readers."""

from __future__ import annotations

import fcntl
import os
import select
import socket
import struct
import time
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field

from harness.core.errors import HarnessError, Problem, SpecError
from harness.ros.rtps import wire
from harness.ros.rtps.reader import Reader, Received
from harness.ros.rtps.writer import Address, Qos, Writer

GROUP = "239.255.0.1"
LOOPBACK = "127.0.0.1"
MOST_PARTICIPANTS = 120
MOST_DOMAINS = 232
NEIGHBOURS = 32
"""Participants of this machine that are announced to one by one: some listen to no multicast."""
ANNOUNCE_EVERY = 1.0
REMIND_EVERY = 0.1
LEASE = 100.0
"""Seconds of silence after which peers forget this participant."""

BUILTIN = 0x3F
"""Participant discovery and endpoint discovery, both directions."""

_SIOCGIFADDR = 0x8915


class NetworkError(HarnessError):
    """The domain cannot be joined."""


@dataclass
class _Peer:
    """Another participant."""

    meta: Address
    user: Address
    lease: float
    seen: float
    knows_us: bool = False
    endpoints: dict[bytes, tuple[str, str, Qos, Address]] = field(
        default_factory=dict[bytes, tuple[str, str, Qos, Address]]
    )


def local_addresses() -> dict[str, str]:
    """IPv4 address of every network interface, by its name."""
    found: dict[str, str] = {}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        for _, name in socket.if_nameindex():
            with suppress(OSError):
                request = struct.pack("256s", name.encode()[:15])
                answer = fcntl.ioctl(probe.fileno(), _SIOCGIFADDR, request)
                found[name] = socket.inet_ntoa(answer[20:24])
    return found


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
        self.domain, self.name, self.is_local = domain, name, is_local
        self.prefix = wire.VENDOR + os.urandom(10)
        self._addresses = set(local_addresses().values()) | {LOOPBACK}
        self._address = LOOPBACK if is_local else _outward(self._addresses)
        self._base = 7400 + 250 * domain
        self._multicast = self._join()
        self._unicast, self.port = self._bind()
        own, first = _outward(self._addresses), self._base + 10
        self._neighbours = [(own, first + 2 * number) for number in range(NEIGHBOURS)]
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
        self._publications.write(self._endpoint(entity, topic, type_name, qos))
        self._match_known(made)
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
        self._subscriptions.write(self._endpoint(entity, topic, type_name, qos))
        self._match_known(made)
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
            for guid, endpoint in peer.endpoints.items():
                (written if _is_writer(guid) else read).add(endpoint[0])
        return written, read

    # -- time ---------------------------------------------------------------------------------

    def spin(self, until: float) -> None:
        """Receive, answer and announce until a moment of `time.monotonic`; at least once."""
        while True:
            self._tend()
            left = until - time.monotonic()
            due = min(self._next_announcement, self._next_reminder) - time.monotonic()
            wait = max(0.0, min(left, due))
            ready, _, _ = select.select([self._unicast, self._multicast], [], [], wait)
            for each in ready:
                self._receive(each)
            if left <= 0 and not ready:
                return
            if left < -0.05:  # under a flood of messages
                return

    def close(self) -> None:
        """Leave the domain, and let the peers know."""
        inline = self._inline(PARTICIPANT_GUID=self.guid(wire.PARTICIPANT))
        head = struct.pack("<HH", 0, 16) + wire.NO_ENTITY + wire.SPDP_WRITER
        body = head + wire.sequence_number(2) + inline
        leaving = wire.submessage(wire.DATA, body, 0x02)
        for prefix, peer in self._peers.items():
            self._send(prefix, leaving, peer.meta)
        self._unicast.close()
        self._multicast.close()

    def _inline(self, PARTICIPANT_GUID: bytes) -> bytes:
        status = struct.pack(">I", 3)
        return wire.parameters([(wire.PID_KEY_HASH, PARTICIPANT_GUID), (wire.PID_STATUS, status)])

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
            for address in {(GROUP, self._base), *self._neighbours, *known}:
                self._announce(address)

    # -- sockets ------------------------------------------------------------------------------

    def _join(self) -> socket.socket:
        made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            made.bind(("", self._base))
        except OSError as error:
            raise NetworkError(f"UDP port {self._base} cannot be used: {error.strerror}") from error
        for address in self._addresses:
            with suppress(OSError):
                group = socket.inet_aton(GROUP) + socket.inet_aton(address)
                made.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
        made.setblocking(False)
        return made

    def _bind(self) -> tuple[socket.socket, int]:
        made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2**22)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 2**22)
        made.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(self._address))
        made.setblocking(False)
        for number in range(MOST_PARTICIPANTS):
            port = self._base + 10 + 2 * number
            with suppress(OSError):
                made.bind(("", port))
                return made, port
        raise NetworkError(f"ROS domain {self.domain} has no free port on this machine")

    def _send(self, prefix: bytes, content: bytes, address: Address) -> None:
        target = wire.submessage(wire.INFO_DST, prefix) if prefix else b""
        with suppress(OSError):  # like a datagram that is lost
            self._unicast.sendto(wire.header(self.prefix) + target + content, address)

    def _receive(self, source: socket.socket) -> None:
        for _ in range(256):
            try:
                datagram, (host, _) = source.recvfrom(2**16)
            except OSError:
                return
            if self.is_local and host not in self._addresses:
                continue
            if datagram[:4] == b"RTPS" and datagram[8:20] != self.prefix:
                with suppress(struct.error, IndexError, ValueError):  # garbage is no message
                    self._take(datagram)
            while self._arrived:
                deliver, received = self._arrived.popleft()
                deliver(received)

    # -- messages -----------------------------------------------------------------------------

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

    def _announce(self, address: Address) -> None:
        own = dict.fromkeys((_outward(self._addresses), LOOPBACK))
        here = [wire.locator(each, self.port) for each in own]
        payload = b"\0\3\0\0" + wire.parameters(
            [
                (wire.PID_VERSION, wire.VERSION),
                (wire.PID_VENDOR, wire.VENDOR),
                (wire.PID_PARTICIPANT, self.guid(wire.PARTICIPANT)),
                (wire.PID_DOMAIN, struct.pack("<I", self.domain)),
                *((wire.PID_META_UNICAST, each) for each in here),
                *((wire.PID_DEFAULT_UNICAST, each) for each in here),
                (wire.PID_LEASE, struct.pack("<iI", int(LEASE), 0)),
                (wire.PID_BUILTIN, struct.pack("<I", BUILTIN)),
                (wire.PID_NAME, wire.text(self.name)),
                (wire.PID_USER_DATA, struct.pack("<I", 10) + b"enclave=/;"),
            ]
        )
        self._send(b"", wire.data(wire.NO_ENTITY, wire.SPDP_WRITER, 1, payload), address)

    def _take_participant(self, source: bytes, sample: wire.Sample) -> None:
        if wire.PID_STATUS in sample.inline and sample.inline[wire.PID_STATUS][-1] & 3:
            self._forget(source)
            return
        known = wire.parameters_of(sample.payload)
        domain = known.get(wire.PID_DOMAIN)
        if domain and struct.unpack("<I", domain[0])[0] != self.domain:
            return
        meta = self._reachable(known.get(wire.PID_META_UNICAST, []))
        user = self._reachable(known.get(wire.PID_DEFAULT_UNICAST, [])) or meta
        if meta is None or user is None:
            return
        seconds = (
            struct.unpack("<iI", known[wire.PID_LEASE][0])[0] if wire.PID_LEASE in known else 20
        )
        is_new = source not in self._peers
        peer = self._peers.setdefault(source, _Peer(meta, user, 20.0, time.monotonic()))
        peer.lease = float(seconds)
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

    def _reachable(self, locators: Iterable[bytes]) -> Address | None:
        """The address under which a peer is reached, on this machine where it is here.

        Cyclone DDS takes only packets to the address of the interface that it has chosen.
        """
        found = [address for each in locators if (address := wire.address_of(each)) is not None]
        here = [address for address in found if address[0] in self._addresses]
        usable = here or ([] if self.is_local else found)
        return min(usable, key=lambda each: each[0] != LOOPBACK, default=None)

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
        status = received.inline.get(wire.PID_STATUS)
        if status and status[-1] & 3:
            self._remove_endpoint(received)
            return
        known = wire.parameters_of(received.payload)
        guid = known[wire.PID_ENDPOINT][0][:16]
        peer = self._peers.get(guid[:12])
        if peer is None or wire.PID_TOPIC not in known or wire.PID_TYPE not in known:
            return
        reliable, latched = known.get(wire.PID_RELIABILITY), known.get(wire.PID_DURABILITY)
        is_writer = _is_writer(guid)
        qos = Qos(
            is_reliable=struct.unpack_from("<I", reliable[0])[0] == 2 if reliable else is_writer,
            is_latched=bool(latched) and struct.unpack_from("<I", latched[0])[0] >= 1,
        )
        address = self._reachable(known.get(wire.PID_UNICAST, [])) or peer.user
        topic, type_name = (
            wire.text_of(known[wire.PID_TOPIC][0]),
            wire.text_of(known[wire.PID_TYPE][0]),
        )
        peer.endpoints[guid] = (topic, type_name, qos, address)
        for mine in (self._readers if is_writer else self._writers).values():
            _match(mine, guid, peer.endpoints[guid])

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

    def _match_known(self, mine: Writer | Reader) -> None:
        for peer in self._peers.values():
            for guid, endpoint in peer.endpoints.items():
                if _is_writer(guid) != isinstance(mine, Writer):
                    _match(mine, guid, endpoint)

    def _endpoint(self, entity: bytes, topic: str, type_name: str, qos: Qos) -> bytes:
        guid = self.guid(entity)
        reliability = struct.pack("<IiI", 2 if qos.is_reliable else 1, 0, 429496730)
        return b"\0\3\0\0" + wire.parameters(
            [
                (wire.PID_ENDPOINT, guid),
                (wire.PID_PARTICIPANT, self.guid(wire.PARTICIPANT)),
                (wire.PID_VERSION, wire.VERSION),
                (wire.PID_VENDOR, wire.VENDOR),
                (wire.PID_KEY_HASH, guid),
                (wire.PID_UNICAST, wire.locator(self._address, self.port)),
                (wire.PID_TOPIC, wire.text(topic)),
                (wire.PID_TYPE, wire.text(type_name)),
                (wire.PID_RELIABILITY, reliability),
                (wire.PID_DURABILITY, struct.pack("<I", int(qos.is_latched))),
            ]
        )

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


def _is_writer(guid: bytes) -> bool:
    """Whether an endpoint is a writer, with a key or without."""
    return guid[15] & 0x0F in (0x02, 0x03)


def _match(mine: Writer | Reader, guid: bytes, endpoint: tuple[str, str, Qos, Address]) -> None:
    topic, type_name, qos, address = endpoint
    if (topic, type_name) != (mine.topic, mine.type_name):
        return
    offered, requested = (mine.qos, qos) if isinstance(mine, Writer) else (qos, mine.qos)
    if offered.serves(requested):
        mine.match(guid, address, qos)


def _outward(addresses: Iterable[str]) -> str:
    """The first address that other machines can reach."""
    return next((each for each in sorted(addresses) if not each.startswith("127.")), LOOPBACK)
