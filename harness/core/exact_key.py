"""Keys of computations: a hash of every byte that a result follows from."""

from __future__ import annotations

import hashlib
import struct
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import lru_cache
from pathlib import Path
from typing import Any, cast

import numpy as np

from harness.core.geometry import Mesh


class NoKeyError(Exception):
    """An input has no exact bytes, so that equal inputs cannot be recognised."""


def exact_key(*inputs: object) -> str:
    """SHA-256 in hex of values: numbers bit by bit, with their types, names and shapes.

    Different inputs have different keys. Of a mesh, the content of the file counts too.

    Raises:
        NoKeyError: A value is neither plain data, nor an array, nor a dataclass of those.
    """
    hasher = hashlib.sha256()
    for value in inputs:
        _feed(hasher, value)
    return hasher.hexdigest()


def _feed(hasher: Any, value: object) -> None:
    match value:
        case np.ndarray():
            array = cast("np.ndarray[Any, Any]", value)
            if array.dtype.hasobject:
                raise NoKeyError(f"an array of {array.dtype}")
            _put(hasher, b"array", f"{array.dtype.str}{array.shape}".encode())
            hasher.update(np.ascontiguousarray(array).data)
        case float():
            _put(hasher, b"float", struct.pack("<d", value))
        case str():
            _put(hasher, b"str", value.encode())
        case tuple() | list():
            items = cast("tuple[object, ...] | list[object]", value)
            _put(hasher, b"sequence", str(len(items)).encode())
            for member in items:
                _feed(hasher, member)
        case dict():
            mapping = cast("dict[object, object]", value)
            _put(hasher, b"mapping", str(len(mapping)).encode())
            for item in mapping.items():
                _feed(hasher, item)
        case set() | frozenset():
            members = sorted(exact_key(member) for member in cast("frozenset[object]", value))
            _put(hasher, b"set", " ".join(members).encode())
        case bytes():
            _put(hasher, b"bytes", value)
        case None | bool() | int() | Path() | Enum():
            _put(hasher, type(value).__qualname__.encode(), repr(value).encode())
        case _:
            _feed_dataclass(hasher, value)


def _feed_dataclass(hasher: Any, value: object) -> None:
    if not is_dataclass(value) or isinstance(value, type):
        raise NoKeyError(f"a {type(value).__qualname__}")
    kind = type(value)
    _put(hasher, b"dataclass", f"{kind.__module__}.{kind.__qualname__}".encode())
    for entry in fields(value):
        _put(hasher, b"field", entry.name.encode())
        _feed(hasher, getattr(value, entry.name))
    if isinstance(value, Mesh):
        _put(hasher, b"file", _content(value.path))


@lru_cache(maxsize=512)
def _content(path: Path) -> bytes:
    """Hash of a file; empty where it cannot be read, which whoever uses it reports."""
    try:
        return hashlib.sha256(path.read_bytes()).digest()
    except OSError:
        return b""


def _put(hasher: Any, kind: bytes, data: bytes) -> None:
    """Add a value so that no other sequence of values has the same bytes."""
    hasher.update(kind + struct.pack("<Q", len(data)) + data)
