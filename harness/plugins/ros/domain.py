"""Domains of ROS 2: the user's, or one that no other program uses."""

from __future__ import annotations

import fcntl
import os
import socket
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from harness.core.errors import Problem, SpecError
from harness.plugins.ros.rtps.sockets import NetworkError

VARIABLE = "ROS_DOMAIN_ID"
MOST_DOMAINS = 232  # the highest whose ports are below 65536
CHOICES = range(20, 101)  # their ports are below those that Linux gives to clients


def domain_of_user(given: int | None) -> int:
    """The domain that an option names, else that of ROS_DOMAIN_ID, else 0.

    Raises:
        SpecError: It is not the number of a domain.
    """
    text = str(given) if given is not None else os.environ.get(VARIABLE, "").strip() or "0"
    if not text.isdecimal() or int(text) > MOST_DOMAINS:
        where = VARIABLE if given is None else "--domain"
        reason = f"'{text}' is no domain; they are 0 to {MOST_DOMAINS}"
        raise SpecError([Problem(where, 0, 0, reason)])
    return int(text)


@contextmanager
def free_domain() -> Generator[int]:
    """A domain of its own for the time of the block, on this machine.

    Raises:
        NetworkError: All are taken.
    """
    own = os.getpid() % len(CHOICES)
    for domain in (*CHOICES[own:], *CHOICES[:own]):
        path = Path(tempfile.gettempdir()) / f"armharness-{os.getuid()}-domain-{domain}.lock"
        descriptor = os.open(path, os.O_CREAT | os.O_RDWR, 0o600)
        with os.fdopen(descriptor) as lock, socket.socket(type=socket.SOCK_DGRAM) as probe:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                probe.bind(("", 7410 + 250 * domain))  # the port of its first participant
            except OSError:
                continue
            probe.close()
            yield domain
            return
    raise NetworkError("no ROS domain is free on this machine")
