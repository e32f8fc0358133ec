"""Floods, slow clients, frames that are too large and strangers at the studio and a live page."""

from __future__ import annotations

import json
import os
import random
import re
import signal
import socket
import struct
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from tests.campaigns.attacks import trial
from tests.waiting import wait_for

SERVERS = (
    "studio a.scenario.yaml --no-open --port 0",
    "studio open_manipulator_x --no-open --port 0",
)
ACTIONS = 40  # of one try
GROWTH = 300.0  # most that a server may grow by while it is attacked [MB]
PATIENCE = 60.0  # for an answer of a server that is attacked [s]
UPGRADE = (
    "GET /studio/ws HTTP/1.1\r\nHost: {host}\r\n{origin}Upgrade: websocket\r\n"
    "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{more}\r\n"
)
VERBS = ("page", "do", "save", "run", "hover", "reset", "open", "edit", "load", "undo", "move")
ODD = ("", "x" * 100_000, "../../etc/passwd", "/etc/passwd", 1e308, -1, None, [], {}, True, "\0")


class Strangers:
    """Programs that talk to a server, and keep some of their connections."""

    def __init__(self, rng: random.Random, port: int) -> None:
        self._rng, self._port = rng, port
        self._kept: list[socket.socket] = []

    def act(self) -> str:
        """Do one thing; what it was."""
        kind = self._rng.choice(
            (self.bytes, self.strange_request, self.half_request, self.socket_messages,
             self.large_frame, self.broken_frames, self.flood, self.leave, self.slow_reader)
        )  # fmt: skip
        with suppress(OSError):
            kind()
        return kind.__name__

    def _open(self) -> socket.socket:
        return socket.create_connection(("127.0.0.1", self._port), timeout=2.0)

    def bytes(self) -> None:
        """Something that is no HTTP."""
        with self._open() as stream:
            stream.sendall(self._rng.randbytes(self._rng.choice((1, 100, 20_000))))

    def strange_request(self) -> None:
        """A request with strange headers, or the start of a WebSocket with them."""
        rng, own = self._rng, f"127.0.0.1:{self._port}"
        host = rng.choice((own, "evil.example", f"127.0.0.1:{self._port}.evil", "", "x" * 9000))
        origin = rng.choice(("", f"Origin: http://{own}\r\n", "Origin: null\r\n", "Origin: x\r\n"))
        more = rng.choice(("", "Cookie: " + "a=b;" * 3000 + "\r\n", "X: y\r\n" * 500, "\0: \r\n"))
        text = UPGRADE.format(host=host, origin=origin, more=more)
        if rng.random() < 0.5:
            path = rng.choice(("/", "/..%2f..%2fetc/passwd", "/" + "a" * 20_000, "//", "/%00", "*"))
            method = rng.choice(("GET", "POST", "PUT", "CONNECT", "HEAD", "get"))
            text = f"{method} {path} HTTP/1.1\r\nHost: {host}\r\n{origin}{more}\r\n"
        with self._open() as stream:
            stream.sendall(text.encode("latin-1"))
            answer = stream.recv(4096)
            is_own = host == own and origin in ("", f"Origin: http://{own}\r\n")
            assert is_own or (b" 101 " not in answer[:20] and b" 200 " not in answer[:20]), text[
                :200
            ]

    def half_request(self) -> None:
        """A request that never ends, of a connection that stays."""
        stream = self._open()
        stream.sendall(b"GET / HTTP/1.1\r\nHost: 127" + b"X: y\r\n" * self._rng.choice((0, 10)))
        self._keep(stream)

    def _socket(self) -> socket.socket:
        stream = self._open()
        own = f"127.0.0.1:{self._port}"
        text = UPGRADE.format(host=own, origin=f"Origin: http://{own}\r\n", more="")
        stream.sendall(text.encode())
        stream.recv(4096)
        return stream

    def socket_messages(self) -> None:
        """Messages that mean nothing, or half of something."""
        rng, stream = self._rng, self._socket()
        stream.sendall(frame(json.dumps({"page": "stranger"}).encode()))
        for _ in range(rng.choice((1, 5, 100))):
            keys = rng.sample((*VERBS, "name", "text", "number", "line", "column"), 4)
            document = {key: rng.choice((*ODD, *VERBS)) for key in keys}
            document["do"] = rng.choice((*VERBS, *ODD))
            document.pop("page", None)
            if document["do"] in ("save", "run"):
                document["do"] = "hover"
            stream.sendall(frame(json.dumps(document).encode()))
        self._keep(stream)

    def large_frame(self) -> None:
        """A frame that states, or has, more than a message may have."""
        stream = self._socket()
        size = self._rng.choice((2**22 + 1, 2**31, 2**62))
        stream.sendall(struct.pack(">BBQ", 0x81, 0xFF, size) + b"mask" + bytes(2**16))
        self._keep(stream)

    def broken_frames(self) -> None:
        """Frames that the protocol does not allow."""
        stream = self._socket()
        stream.sendall(self._rng.randbytes(self._rng.choice((2, 50, 5000))))
        stream.close()

    def flood(self) -> None:
        """Many connections at once."""
        for _ in range(self._rng.choice((10, 60))):
            self._keep(self._socket() if self._rng.random() < 0.5 else self._open())

    def slow_reader(self) -> None:
        """A page that reads nothing of what it is sent."""
        stream = self._socket()
        stream.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
        stream.sendall(frame(b'{"page": "slow"}') + frame(b'{"do": "reset", "number": 1}') * 200)
        self._keep(stream)

    def leave(self) -> None:
        """Close some connections."""
        self._rng.shuffle(self._kept)
        for stream in self._kept[::2]:
            stream.close()
        del self._kept[::2]

    def _keep(self, stream: socket.socket) -> None:
        self._kept.append(stream)
        if len(self._kept) > 300:
            self.leave()

    def end(self) -> None:
        """Close all."""
        for stream in self._kept:
            stream.close()


def frame(content: bytes) -> bytes:
    """A masked text frame of a WebSocket, whose mask is 0."""
    size = len(content)
    head = struct.pack(">BBQ", 0x81, 0xFF, size) if size > 125 else bytes((0x81, 0x80 | size))
    return head + bytes(4) + content


def attack(rng: random.Random, master: Path, folder: Path) -> tuple[str, list[str]]:
    """Strangers at one server; what they did, and the findings."""
    place = trial.workplace(master, folder / "place")
    before = sorted(path.name for path in place.iterdir())
    command = rng.choice(SERVERS)
    pid, said = trial.start(command.split(), place), place / ".said"
    port = int(
        wait_for(
            lambda: re.search(r"127\.0\.0\.1:(\d+)", said.read_text()) if said.exists() else None
        )[1]
    )
    own_answer(port)
    memory, done, found = megabytes(pid), list[str](), list[str]()
    strangers = Strangers(rng, port)
    try:
        done = [strangers.act() for _ in range(ACTIONS)]
    except AssertionError as error:
        found.append(f"answered a stranger: {error}")
    if not answers(port):
        found.append("its own user gets no answer while strangers are there")
    strangers.end()
    if not wait_quietly(lambda: answers(port)):
        found.append("its own user gets no answer")
    if (grown := megabytes(pid) - memory) > GROWTH:
        found.append(f"it has grown by {grown:.0f} MB")
    with suppress(OSError):
        os.kill(pid, signal.SIGTERM)
    ended = trial.finish(pid, place)
    found += trial.complaints(ended, codes=(0, 130)) + trial.leftovers(place, pid)
    new = {p.name for p in place.iterdir()} - {*before, ".said", ".said.stdin"}
    found += [f"a stranger wrote {name}" for name in new if not name.startswith(".")]
    return f"{command} [{', '.join(sorted(set(done)))}]", [
        f"{each}\n{ended.said[-1500:]}" for each in found
    ]


def own_answer(port: int) -> bytes:
    """The first line that the server's own user gets."""
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as stream:
        head = f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n"
        stream.sendall(head.encode())
        return stream.recv(100).partition(b"\r\n")[0]


def answers(port: int) -> bool:
    """Whether the server's own user gets the page."""
    try:
        return b" 200 " in own_answer(port)
    except OSError:
        return False


def wait_quietly(condition: Callable[[], bool]) -> bool:
    """Whether something becomes true within a minute."""
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.1)
    return True


def megabytes(pid: int) -> float:
    """Memory of a process [MB]."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6
