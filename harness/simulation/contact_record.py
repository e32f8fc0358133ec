"""Every contact of every sample: which geoms touched, where, and how hard."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np

from harness.core.types import FloatArray
from harness.simulation.model import PhysicsModel

ROWS = 4096
"""Samples by which the arrays grow."""

CONTACTS_PER_ROW = 24
"""Contacts that fit into the first arrays for each sample; more make them grow sooner."""

BYTES = 40
"""Of a contact in the arrays."""

BodyPair = tuple[str, str]
Array = np.ndarray[Any, Any]


class ContactRecord:
    """Contacts one sample behind the other; sums of them by pair of bodies."""

    def __init__(self, physics: PhysicsModel) -> None:
        size = ROWS * CONTACTS_PER_ROW
        self._physics = physics
        self._end = np.zeros(ROWS, dtype=np.int64)
        self._geoms = np.empty((size, 2), dtype=np.int32)
        self._forces = np.empty(size)
        self._normals = np.empty((size, 3), dtype=np.float32)
        self._points = np.empty((size, 3), dtype=np.float32)
        self.count = 0

    def reserve(self, rows: int) -> None:
        """Make room for so many samples."""
        if rows > len(self._end):
            more = max(len(self._end), rows - len(self._end))
            self._end = np.concatenate([self._end, np.zeros(more, dtype=np.int64)])

    def keep(self, data: mujoco.MjData, row: int) -> None:
        """Copy the contacts of the state that the physics is in, as those of a sample."""
        begin = self.count
        self.count = end = begin + data.ncon
        self._end[row] = end
        if end > len(self._forces):
            self._geoms = _doubled(self._geoms)
            self._forces = _doubled(self._forces)
            self._normals = _doubled(self._normals)
            self._points = _doubled(self._points)
        if end > begin:
            contact = data.contact
            self._geoms[begin:end] = contact.geom
            self._normals[begin:end] = contact.frame[:, :3]
            self._points[begin:end] = contact.pos
            _normal_forces(data, self._forces[begin:end])

    def forces(self, first: int, last: int) -> dict[BodyPair, FloatArray]:
        """Normal force [N] of pairs that touch in samples first to last - 1, (samples,) each."""
        found: dict[BodyPair, FloatArray] = {}
        for numbers, rows, contacts in self._by_pair(first, last):
            sums = np.bincount(rows, self._forces[contacts], minlength=last - first)
            found[self._pair(*numbers)] = sums.astype(np.float64, copy=False)
        return {pair: found[pair] for pair in sorted(found)}

    def presses(self, count: int) -> dict[BodyPair, FloatArray]:
        """Where a link of the robot presses on something else, and how.

        Args:
            count: Samples, from the first on.

        Returns:
            By link and other body, shape (count, 6): the mean of the contact points, weighted by
            their normal forces, in the world; then the sum of these forces on the other body, in
            world axes [N]. NaN where there is no force.
        """
        robot = self._physics.robot_bodies
        found: dict[BodyPair, FloatArray] = {}
        for (first, second), rows, contacts in self._by_pair(0, count):
            if (first in robot) == (second in robot):
                continue
            link = first if first in robot else second
            force = self._forces[contacts]
            signed = self._signs(contacts, link) * force
            total = np.bincount(rows, force, minlength=count)
            weighted = [*(self._points[contacts] * force[:, None]).T]
            vectors = [*(self._normals[contacts] * signed[:, None]).T]
            sums = [np.bincount(rows, values, minlength=count) for values in (*weighted, *vectors)]
            pressed = np.full((count, 6), np.nan)
            there = total > 0
            pressed[there] = np.stack(sums, axis=1)[there]
            pressed[there, :3] /= total[there, None]
            found[self._pair(first, second)] = pressed
        return {pair: found[pair] for pair in sorted(found)}

    def support_forces(self, count: int) -> dict[BodyPair, FloatArray]:
        """Upward part of the normal force [N] of one object on another, shape (count,) each.

        Args:
            count: Samples, from the first on.
        """
        names, robot = self._physics.body_names, self._physics.robot_bodies
        found: dict[BodyPair, FloatArray] = {}
        for numbers, rows, contacts in self._by_pair(0, count):
            if not robot.isdisjoint(numbers):
                continue
            pair = self._pair(*numbers)
            below = next(number for number in numbers if names[number] == pair[0])
            upward = self._forces[contacts] * self._normals[contacts, 2]
            sums = np.bincount(rows, self._signs(contacts, below) * upward, minlength=count)
            found[pair] = sums.astype(np.float64, copy=False)
        return {pair: found[pair] for pair in sorted(found)}

    def _by_pair(self, first: int, last: int) -> Iterator[tuple[tuple[int, int], Array, Array]]:
        """Contacts of each pair of bodies in samples first to last - 1.

        Contacts are sorted by pair once, so that the time is linear in their number however many
        pairs there are.

        Yields:
            Numbers of two bodies, the smaller first; of each of their contacts, in the order of
            recording, the sample counted from `first`, and its index.
        """
        begin, end = int(self._end[first - 1]) if first else 0, int(self._end[last - 1])
        if begin == end:
            return
        size, body_of = self._physics.model.nbody, self._physics.model.geom_bodyid
        one, other = (body_of[self._geoms[begin:end, side]] for side in (0, 1))
        codes = np.minimum(one, other) * size + np.maximum(one, other)
        counts = np.bincount(codes, minlength=size * size)
        pairs = np.flatnonzero(counts)
        places = np.zeros(size * size, dtype=np.uint16 if len(pairs) < 2**16 else np.int64)
        places[pairs] = np.arange(len(pairs))
        order = np.argsort(places[codes], kind="stable")  # of 16 bits: a radix sort
        del one, other, codes
        ends = self._end[first:last]
        for code, part in zip(
            pairs.tolist(), np.split(order, np.cumsum(counts[pairs])[:-1]), strict=True
        ):
            contacts = part + begin
            yield divmod(code, size), np.searchsorted(ends, contacts, side="right"), contacts

    def _signs(self, contacts: Array, body: int) -> Array:
        """1 where a contact's normal, from its first geom to its second, leaves a body; else -1."""
        return np.where(
            self._physics.model.geom_bodyid[self._geoms[contacts, 0]] == body, 1.0, -1.0
        )

    def _pair(self, first: int, second: int) -> BodyPair:
        """Names of two bodies: a robot's link first, else sorted."""
        names, robot = self._physics.body_names, self._physics.robot_bodies
        if (first in robot) != (second in robot):
            return (
                (names[first], names[second]) if first in robot else (names[second], names[first])
            )
        a, b = sorted((names[first], names[second]))
        return a, b


def _doubled(values: Array) -> Array:
    """The values in an array of twice the length, whose second half takes no memory until used."""
    larger = np.empty((2 * len(values), *values.shape[1:]), values.dtype)
    larger[: len(values)] = values
    return larger


def _normal_forces(data: mujoco.MjData, forces: FloatArray) -> None:
    """Write the normal force [N] of every contact; one that only touches has no force.

    Such a contact has no row among the constraints, which MuJoCo says with an address of -1; where
    nothing else is constrained, as with an arm without a gripper, there are no rows at all.
    """
    if not data.nefc:
        forces[:] = 0.0
        return
    address = data.contact.efc_address
    data.efc_force.take(address, 0, forces, "clip")
    forces[address < 0] = 0.0
