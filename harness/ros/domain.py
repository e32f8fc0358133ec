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
from harness.ros.rtps.sockets import NetworkError

VARIABLE = "ROS_DOMAIN_ID"
MOST_DOMAINS = 232
CHOICES = range(20, 101)
"""Domains that are chosen from: their ports are below those that Linux gives to clients."""


def domain_of_user(given: int | None) -> int:
    """The domain that an option names, else that of ROS_DOMAIN_ID, else 0.

    Raises:
        SpecError: It is not the number of a domain.
    """
    text = str(given) if given is not None else os.environ.get(VARIABLE, "").strip() or "0"
    if not text.isdecimal() or int(text) > MOST_DOMAINS:
        where = VARIABLE if given is None else "--domain"
        raise SpecError(
            [Problem(where, 0, 0, f"'{text}' is no domain; they are 0 to {MOST_DOMAINS}")]
        )
    return int(text)


@contextmanager
def free_domain() -> Generator[int]:
    """A domain of its own for the time of the block, on this machine.

    Raises:
        NetworkError: All are taken.
    """
    count = len(CHOICES)
    folder = Path(tempfile.gettempdir())
    for offset in range(count):
        domain = CHOICES[(os.getpid() + offset) % count]
        path = folder / f"armharness-{os.getuid()}-domain-{domain}.lock"
        descriptor = os.open(path, os.O_CREAT | os.O_RDWR, 0o600)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_unused(domain):
                yield domain
                return
        except BlockingIOError:
            continue
        finally:
            os.close(descriptor)
    raise NetworkError("no ROS domain is free on this machine")


def _is_unused(domain: int) -> bool:
    """Whether no participant has the first port of a domain."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("", 7410 + 250 * domain))
        except OSError:
            return False
    return True
