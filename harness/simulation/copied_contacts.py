"""Copies contacts as they are in MuJoCo's memory, and decodes those of many samples at a time."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.lib.stride_tricks import as_strided

from harness.core.types import FloatArray

MOST_UNRESOLVED = 1024
"""Contacts that are decoded at a time; their copies stay in the processor's cache."""

Array = np.ndarray[Any, Any]


@dataclass(frozen=True, eq=False)
class SampleContacts:
    """Contacts of one sample.

    Attributes:
        geoms: The two geoms of each contact, shape (C, 2).
        forces: Normal forces [N], shape (C,).
        normals: Directions from the first geom to the second, shape (C, 3).
        points: Where they are [m], shape (C, 3).
        frictions: Friction forces [N], shape (C, 3).
    """

    geoms: Array
    forces: FloatArray
    normals: Array
    points: Array
    frictions: Array

    @property
    def values(self) -> tuple[Array, ...]:
        """All of them, in order."""
        return self.geoms, self.forces, self.normals, self.points, self.frictions


class CopiedContacts:
    """Contacts and constraint forces of some samples, as they are in MuJoCo's memory.

    MuJoCo gives an inactive contact no constraint row and the address -1. Without any other
    constraint, as for an arm without a gripper, there are no rows at all. Every contact has
    `CONTACT_DIMENSIONS`: its first row is the normal force, the next two are friction along the
    second and third axis of its frame.

    Attributes:
        asleep: Contacts of bodies asleep, which each sample has in addition to those copied.
    """

    def __init__(self, data: mujoco.MjData) -> None:
        self._data = data
        self._memory: tuple[Array, ...] = (np.empty((0, 0)),)
        self._fields = np.dtype([])
        self._contacts = np.empty((0, 0))
        self._forces = np.empty(8 * MOST_UNRESOLVED)
        self.asleep = SampleContacts(*(np.empty(0) for _ in range(5)))
        self._clear()

    def _clear(self) -> None:
        self._count = self._rows = 0
        self._samples: list[tuple[int, int]] = []  # contacts and first constraint row of each

    def keep(self, count: int) -> bool:
        """Copy all `count` contacts of the current state; False where others leave no room."""
        if len(self._samples) == MOST_UNRESOLVED:
            return False
        if not count:
            self._samples.append((0, 0))
            return True
        forces = self._data.efc_force
        begin, row = self._count, self._rows
        end, last = begin + count, row + len(forces)
        if count > len(self._memory[0]):
            self._find_memory(count)
        if end > len(self._contacts) or last > len(self._forces):
            if self._samples:
                return False
            self._contacts = np.empty((max(end, MOST_UNRESOLVED), self._fields.itemsize // 8))
            self._forces = np.empty(max(last, len(self._forces)))
        head, tail = self._memory
        self._contacts[begin:end, : head.shape[1]] = head[:count]
        self._contacts[begin:end, head.shape[1] :] = tail[:count]
        self._forces[row:last] = forces
        self._samples.append((count, row))
        self._count, self._rows = end, last
        return True

    def _find_memory(self, count: int) -> None:
        """Look up where MuJoCo keeps contacts, one after the other from the same place on.

        Copying their first and last fields at once takes a fifth of the time of copying each.
        """
        contact = self._data.contact
        (size,) = contact.dist.strides
        memory = as_strided(contact.dist, (count, size // 8), (size, 8))
        parts = {name: getattr(contact, name) for name in ("pos", "frame", "geom", "efc_address")}
        at = {name: _address(part) - _address(contact.dist) for name, part in parts.items()}
        head, tail = at["frame"] // 8 + 9, min(at["geom"], at["efc_address"]) // 8
        self._memory = memory[:, :head], memory[:, tail:]
        moved = 8 * (tail - head)
        self._fields = np.dtype(
            {
                "names": list(parts),
                "formats": [(part.dtype, part.shape[1:]) for part in parts.values()],
                "offsets": [each if each < 8 * head else each - moved for each in at.values()],
                "itemsize": size - moved,
            }
        )

    def resolve(
        self, geoms: Array, forces: FloatArray, normals: Array, points: Array, frictions: Array
    ) -> None:
        """Write what is recorded of every contact [N, m]; an inactive one has no forces."""
        if not self._samples:
            return
        counts, rows = np.array(self._samples, dtype=np.int64).T
        arrays = geoms, forces, normals, points, frictions
        if not self._count:
            for values, asleep in zip(arrays, self.asleep.values, strict=True):
                values.reshape(len(counts), *asleep.shape)[:] = asleep
            self._clear()
            return
        computed: slice | Array = slice(None)
        if size := len(self.asleep.forces):  # they follow the computed ones of each sample
            following = np.cumsum(counts + size)[:, None] - np.arange(size, 0, -1)
            for values, asleep in zip(arrays, self.asleep.values, strict=True):
                values[following] = asleep
            computed = np.ones(len(forces), dtype=bool)
            computed[following] = False
        contacts = self._contacts[: self._count].view(self._fields)[:, 0]
        axes = np.ascontiguousarray(contacts["frame"].T)  # (9, C)
        addresses = contacts["efc_address"].astype(np.int64)
        is_inactive = addresses < 0
        addresses += np.repeat(rows, counts)
        values = [self._forces.take(addresses + row, mode="clip") for row in range(3)]
        for each in values:
            each[is_inactive] = 0.0
        geoms[computed], points[computed] = contacts["geom"], contacts["pos"]
        normals[computed], forces[computed] = axes[:3].T, values[0]
        frictions[computed] = (values[1] * axes[3:6] + values[2] * axes[6:]).T
        self._clear()


def _address(values: Array) -> int:
    """Where an array begins in memory."""
    return values.__array_interface__["data"][0]
