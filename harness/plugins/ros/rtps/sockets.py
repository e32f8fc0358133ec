"""The UDP sockets of a participant: its ports, and the addresses that reach it and its peers."""

from __future__ import annotations

import fcntl
import select
import socket
import struct
from collections.abc import Iterator, Sequence
from contextlib import suppress

from harness.core.errors import HarnessError
from harness.plugins.ros.rtps.wire import Address

GROUP = "239.255.0.1"
LOOPBACK = "127.0.0.1"
MOST_PARTICIPANTS = 120  # of a domain: more ports would be those of the next one
NEIGHBOURS = 32  # participants here that are announced to one by one: some hear no multicast
BUFFER = 2**22  # bytes that the kernel keeps of what is sent and received
MOST_AT_ONCE = 256  # datagrams of a socket that are read before the other socket has its turn

_SIOCGIFADDR = 0x8915


class NetworkError(HarnessError):
    """The domain cannot be joined."""


class Sockets:
    """One socket for what is sent to all participants of a domain, and one of its own.

    Attributes:
        is_local: Whether packets from other machines are dropped, and none are sent to them.
        is_first: Whether no other program on this machine had the first port of the domain.
        unicast: The addresses under which this participant is reached.
        announced: The addresses that hear of this participant.
    """

    def __init__(self, domain: int, *, is_local: bool) -> None:
        """Open the ports of a domain.

        Raises:
            NetworkError: There is no free port.
        """
        self.is_local = is_local
        self._own = {*_interface_addresses(), LOOPBACK}
        outward = next((each for each in sorted(self._own) if each[:4] != "127."), LOOPBACK)
        base = 7400 + 250 * domain
        self._multicast = self._join(base)
        self._unicast, port = self._bind(base + 10, LOOPBACK if is_local else outward)
        self.is_first = port == base + 10
        own = (outward, LOOPBACK) if is_local else (outward,)
        self.unicast = [(each, port) for each in dict.fromkeys(own)]
        first, last = base + 10, base + 10 + 2 * NEIGHBOURS
        self.announced = {(GROUP, base), *((outward, each) for each in range(first, last, 2))}

    def send(self, datagram: bytes, address: Address) -> None:
        """Send a datagram; what cannot be sent counts as lost."""
        with suppress(OSError):
            self._unicast.sendto(datagram, address)

    def receive(self, timeout: float) -> Iterator[bytes]:
        """The datagrams that arrived, after at most some wall time [s]."""
        for source in select.select([self._unicast, self._multicast], [], [], timeout)[0]:
            for _ in range(MOST_AT_ONCE):
                try:
                    datagram, (host, _) = source.recvfrom(2**16)
                except OSError:
                    break
                if host in self._own or not self.is_local:
                    yield datagram

    def reachable(self, addresses: Sequence[Address]) -> Address | None:
        """The address under which a peer is reached, on this machine where it is here.

        Cyclone DDS takes only packets to the address of the interface that it has chosen.
        """
        here = [address for address in addresses if address[0] in self._own]
        usable = here or ([] if self.is_local else addresses)
        return min(usable, key=lambda each: each[0] != LOOPBACK, default=None)

    def close(self) -> None:
        """Close both sockets."""
        self._unicast.close()
        self._multicast.close()

    def _join(self, port: int) -> socket.socket:
        made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            made.bind(("", port))
        except OSError as error:
            raise NetworkError(f"UDP port {port} cannot be used: {error.strerror}") from error
        for address in self._own:
            with suppress(OSError):
                group = socket.inet_aton(GROUP) + socket.inet_aton(address)
                made.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
        made.setblocking(False)
        return made

    @staticmethod
    def _bind(first: int, outgoing: str) -> tuple[socket.socket, int]:
        made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        for option in (socket.SO_RCVBUF, socket.SO_SNDBUF):
            made.setsockopt(socket.SOL_SOCKET, option, BUFFER)
        made.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(outgoing))
        made.setblocking(False)
        for port in range(first, min(first + 2 * MOST_PARTICIPANTS, 2**16), 2):
            with suppress(OSError):
                made.bind(("", port))
                return made, port
        raise NetworkError(f"no UDP port from {first} on is free on this machine")


def _interface_addresses() -> Iterator[str]:
    """The IPv4 address of every network interface that has one."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        for _, name in socket.if_nameindex():
            with suppress(OSError):
                request = struct.pack("256s", name.encode()[:15])
                yield socket.inet_ntoa(fcntl.ioctl(probe.fileno(), _SIOCGIFADDR, request)[20:24])
