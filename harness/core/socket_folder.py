"""Temporary folders for the addresses of Unix sockets."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

LONGEST_PARENT = 68  # [bytes]; macOS has 103 for an address, of which prefix and name take 35


def socket_parent() -> Path:
    """The folder for temporary folders, or `/tmp` where addresses in it would be too long."""
    parent = tempfile.gettempdir()
    return Path(parent if len(os.fsencode(parent)) <= LONGEST_PARENT else "/tmp")


def socket_folder(prefix: str) -> tempfile.TemporaryDirectory[str]:
    """Make a temporary folder that only this user can enter, for sockets of short names."""
    return tempfile.TemporaryDirectory(prefix=prefix, dir=socket_parent())
