"""Submessages and parameter lists of DDSI-RTPS as bytes (OMG formal/2019-04-03, 8.3 and 9)."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

VERSION = b"\x02\x03"
VENDOR = b"\x01\x7a"  # a vendor that is not registered: peers use no private extension with it
FAST_DDS = b"\x01\x0f"  # its vendor, at the start of a GUID

NO_ENTITY, PARTICIPANT, SPDP_WRITER = bytes(4), b"\x00\x00\x01\xc1", b"\x00\x01\x00\xc2"
PUBLICATIONS_WRITER, PUBLICATIONS_READER = b"\x00\x00\x03\xc2", b"\x00\x00\x03\xc7"
SUBSCRIPTIONS_WRITER, SUBSCRIPTIONS_READER = b"\x00\x00\x04\xc2", b"\x00\x00\x04\xc7"

ACKNACK, HEARTBEAT, GAP, INFO_TS, INFO_DST = 0x06, 0x07, 0x08, 0x09, 0x0E
NACK_FRAG, DATA, DATA_FRAG = 0x12, 0x15, 0x16

PID_SENTINEL, PID_LEASE, PID_TOPIC, PID_TYPE = 0x01, 0x02, 0x05, 0x07
PID_DOMAIN, PID_VERSION, PID_VENDOR = 0x0F, 0x15, 0x16
PID_RELIABILITY, PID_DURABILITY, PID_USER_DATA = 0x1A, 0x1D, 0x2C
PID_UNICAST, PID_DEFAULT_UNICAST, PID_META_UNICAST = 0x2F, 0x31, 0x32
PID_PARTICIPANT, PID_BUILTIN, PID_ENDPOINT = 0x50, 0x58, 0x5A
PID_NAME, PID_KEY_HASH, PID_STATUS, PID_RELATED = 0x62, 0x70, 0x71, 0x83
PID_RELATED_OLD = 0x800F  # Fast DDS's related sample identity before the standard's
FRAGMENT = 57_344  # bytes of a sample in one datagram; UDP carries at most 65,507
MOST_BITS = 256  # sequence numbers in one set

Address = tuple[str, int]
Parameters = dict[int, list[bytes]]


@dataclass(frozen=True)
class Submessage:
    """One submessage of a datagram; the body is what follows its header."""

    kind: int
    flags: int
    body: bytes

    @property
    def order(self) -> str:
        """The byte order, for `struct`."""
        return "<" if self.flags & 1 else ">"

    def unpack(self, form: str, place: int) -> tuple[int, ...]:
        """The numbers at a place of the body, in a form of `struct`."""
        return struct.unpack_from(f"{self.order}{form}", self.body, place)

    def number(self, place: int) -> int:
        """The sequence number at a place."""
        high, low = self.unpack("iI", place)
        return (high << 32) + low

    def numbers(self, place: int) -> tuple[int, list[int]]:
        """The base and the members of the set of sequence numbers at a place."""
        base, bits = self.number(place), min(self.unpack("I", place + 8)[0], MOST_BITS)
        words = self.unpack(f"{-(-bits // 32)}I", place + 12)
        marks = "".join(f"{word:032b}" for word in words)
        return base, [base + bit for bit in range(bits) if marks[bit] == "1"]


@dataclass(frozen=True)
class Sample:
    """A sample or a part of one, as DATA and DATA_FRAG carry it.

    Attributes:
        reader: The entity of the reader; zeros for all readers.
        payload: The encapsulation header and the content, or fragments of them.
        first: The number of the first fragment, from 1; 0 for a whole sample.
        fragment_size: Bytes of each fragment but the last.
        size: Bytes of the whole sample.
    """

    reader: bytes
    writer: bytes
    number: int
    inline: dict[int, bytes]
    payload: bytes
    first: int = 0
    fragment_size: int = 0
    size: int = 0


def header(prefix: bytes) -> bytes:
    """The header of a message of a participant."""
    return b"RTPS" + VERSION + VENDOR + prefix


def submessage(kind: int, body: bytes, flags: int = 0) -> bytes:
    """A little-endian submessage; a length of zero says `up to the end` of a long one."""
    length = len(body) if len(body) < 2**16 else 0
    return struct.pack("<BBH", kind, flags | 1, length) + body


def submessages(datagram: bytes) -> Iterator[Submessage]:
    """The submessages of a datagram; what is cut off is left out."""
    place = 20
    while place + 4 <= len(datagram):
        kind, flags = datagram[place], datagram[place + 1]
        (length,) = struct.unpack_from("<H" if flags & 1 else ">H", datagram, place + 2)
        if length == 0 and kind not in (INFO_TS, 0x01):
            length = len(datagram) - place - 4
        yield Submessage(kind, flags, datagram[place + 4 : place + 4 + length])
        place += 4 + length


def sequence_number(number: int) -> bytes:
    """A sequence number in its two words."""
    return struct.pack("<iI", number >> 32, number & 0xFFFFFFFF)


def number_set(base: int, numbers: Sequence[int]) -> bytes:
    """A set of sequence numbers from a base on."""
    places = {number - base for number in numbers if base <= number < base + MOST_BITS}
    bits = max(places, default=-1) + 1
    words = [0] * -(-bits // 32)
    for place in places:
        words[place // 32] |= 1 << (31 - place % 32)
    return sequence_number(base) + struct.pack(f"<I{len(words)}I", bits, *words)


def parameters(*values: tuple[int, bytes]) -> bytes:
    """A parameter list, each value padded to four bytes."""
    made = b""
    for key, value in values:
        padded = value + bytes(-len(value) % 4)
        made += struct.pack("<HH", key, len(padded)) + padded
    return made + struct.pack("<HH", PID_SENTINEL, 0)


def parsed_parameters(body: bytes, place: int, order: str) -> tuple[Parameters, int]:
    """The values of a parameter list by their keys, and where it ends."""
    found: Parameters = {}
    while True:
        key, length = struct.unpack_from(f"{order}HH", body, place)
        place += 4
        if key == PID_SENTINEL:
            return found, place
        found.setdefault(key, []).append(body[place : place + length])
        place += length


def parameters_of(payload: bytes) -> Parameters:
    """The parameters of a discovery sample, after its encapsulation header."""
    return parsed_parameters(payload, 4, "<" if payload[1] & 1 else ">")[0]


def text(value: str) -> bytes:
    """A string of CDR."""
    content = value.encode() + b"\0"
    return struct.pack("<I", len(content)) + content


def text_of(value: bytes) -> str:
    """What a string of CDR says."""
    (length,) = struct.unpack_from("<I", value)
    return value[4 : 4 + length].rstrip(b"\0").decode("utf-8", "replace")


def locator(address: Address) -> bytes:
    """A UDPv4 locator."""
    return struct.pack("<iI", 1, address[1]) + bytes(12) + bytes(map(int, address[0].split(".")))


def address_of(value: bytes) -> Address | None:
    """Address and port of a UDPv4 locator; None for other kinds."""
    kind, port = struct.unpack_from("<iI", value)
    if kind != 1 or len(value) < 24 or not 0 < port < 2**16:
        return None
    return ".".join(map(str, value[20:24])), port


def data(reader: bytes, writer: bytes, number: int, payload: bytes, inline: bytes = b"") -> bytes:
    """A whole sample; one without a payload is the end of what its parameters name."""
    flags = (0x04 if payload else 0) | (0x02 if inline else 0)
    head = struct.pack("<HH", 0, 16) + reader + writer + sequence_number(number)
    return submessage(DATA, head + inline + payload, flags)


def fragments(
    reader: bytes, writer: bytes, number: int, payload: bytes, inline: bytes = b""
) -> list[bytes]:
    """A sample in submessages that fit into one datagram each: DATA, or every DATA_FRAG."""
    if len(payload) <= FRAGMENT:
        return [data(reader, writer, number, payload, inline)]
    head = struct.pack("<HH", 0, 28) + reader + writer + sequence_number(number)
    made: list[bytes] = []
    for place, begin in enumerate(range(0, len(payload), FRAGMENT), 1):
        body = head + struct.pack("<IHHI", place, 1, FRAGMENT, len(payload)) + inline
        body += payload[begin : begin + FRAGMENT]
        made.append(submessage(DATA_FRAG, body, 0x02 if inline else 0))
    return made


def sample_of(source: bytes, message: Submessage) -> Sample:
    """What DATA or DATA_FRAG of a participant carries."""
    number, place = message.number(12), 4 + message.unpack("H", 2)[0]
    inline: dict[int, bytes] = {}
    if message.flags & 0x02:
        listed, place = parsed_parameters(message.body, place, message.order)
        inline = {key: values[0] for key, values in listed.items()}
    body = message.body
    rest = body[4:8], source + body[8:12], number, inline, body[place:]
    if message.kind == DATA:
        return Sample(*rest)
    first, _, fragment_size, size = message.unpack("IHHI", 20)
    return Sample(*rest, first, fragment_size, size)
