"""Records every contact of every sample: the geoms, the point, the normal, force and friction."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from typing import Any

import mujoco
import numpy as np

from harness.core.pose_arrays import conjugate, rotate
from harness.core.types import FloatArray
from harness.simulation.model import PhysicsModel

ROWS = 2**16  # Samples for which the first arrays have room; what is not used takes no memory
CONTACTS_PER_ROW = 24  # Contacts for which there is room first; more make arrays grow sooner
BLOCK = 2**17  # Contacts that are sorted at a time
BYTES = 52  # Memory that one contact takes in the arrays

BodyPair = tuple[str, str]
Array = np.ndarray[Any, Any]

_ROWS = np.arange(3)  # of a contact's forces: normal, then friction along the other two axes
_NOTHING = np.zeros(3)


class ContactRecord:
    """The contacts of consecutive samples, and sums of them for each pair of bodies.

    MuJoCo computes no contacts of bodies that are asleep: as nothing
    moves there, they are those of the last sample in which the bodies were awake.
    """

    def __init__(self, physics: PhysicsModel, data: mujoco.MjData) -> None:
        size = ROWS * CONTACTS_PER_ROW
        self._physics = physics
        self._data = data
        self._end = np.zeros(ROWS, dtype=np.int64)
        self._geoms = np.empty((size, 2), dtype=np.int32)
        self._forces = np.empty(size)
        self._normals = np.empty((size, 3), dtype=np.float32)
        self._points = np.empty((size, 3), dtype=np.float32)
        self._frictions = np.empty((size, 3), dtype=np.float32)
        self._sleep = b""  # the state of sleep for which contacts of bodies asleep are known
        self._asleep = tuple(values[:0] for values in self._values)
        self.count = 0

    def reserve(self, rows: int) -> None:
        """Make room for so many samples."""
        if rows > len(self._end):
            self._end = doubled(self._end, rows)

    def rewind(self, rows: int) -> None:
        """Forget the contacts of all samples after the first `rows`."""
        self.count = int(self._end[rows - 1]) if rows else 0
        self._sleep = b""

    def keep(self, row: int) -> None:
        """Copy the contacts of the current physics state as those of one sample."""
        if self._data.tree_asleep.tobytes() != self._sleep:
            self._find_asleep(row)
        begin, count, asleep = self.count, self._data.ncon, self._asleep
        middle = begin + count
        self._end[row] = self.count = end = middle + len(asleep[0])
        if end > len(self._forces):
            self._grow()
        if end > middle:
            for values, of_asleep in zip(self._values, asleep, strict=True):
                values[middle:end] = of_asleep
        if not count:
            return
        contact = self._data.contact
        axes, addresses = contact.frame, contact.efc_address
        self._geoms[begin:middle] = contact.geom
        self._points[begin:middle] = contact.pos
        self._normals[begin:middle] = axes[:, :3]
        # An inactive contact has no constraint rows and the address -1; it has no forces.
        padded = np.concatenate([self._data.efc_force, _NOTHING])
        pressed = padded.take(np.where(addresses < 0, len(padded) - 3, addresses)[:, None] + _ROWS)
        self._forces[begin:middle] = pressed[:, 0]
        friction = pressed[:, 1:2] * axes[:, 3:6]
        friction += pressed[:, 2:] * axes[:, 6:]
        self._frictions[begin:middle] = friction

    def _find_asleep(self, row: int) -> None:
        """Take the contacts of bodies asleep from the sample before."""
        model, data = self._physics.model, self._data
        self._sleep = data.tree_asleep.tobytes()
        is_asleep = np.append(data.tree_asleep, -1) >= 0
        trees = model.body_treeid[model.geom_bodyid]  # -1, the last, for a static body
        before = slice(self._begin(max(0, row - 1)), self._begin(row))
        chosen = is_asleep[trees[self._geoms[before]]].any(axis=1)
        self._asleep = tuple(values[before][chosen] for values in self._values)

    @property
    def _values(self) -> tuple[Array, ...]:
        return self._geoms, self._forces, self._normals, self._points, self._frictions

    def _begin(self, row: int) -> int:
        """The first contact of a sample."""
        return int(self._end[row - 1]) if row else 0

    def _grow(self) -> None:
        for name in ("_geoms", "_forces", "_normals", "_points", "_frictions"):
            setattr(self, name, doubled(getattr(self, name), self.count))

    def forces(self, first: int, last: int) -> dict[BodyPair, FloatArray]:
        """Normal force [N] of pairs that touch in samples first to last - 1, (samples,) each."""
        found: dict[BodyPair, FloatArray] = {}
        for numbers, rows, contacts in self._by_pair(first, last):
            sums = found.setdefault(self._pair(*numbers), np.zeros(last - first))
            _add(sums, rows, self._forces[contacts])
        return {pair: found[pair] for pair in sorted(found)}

    def force_on(self, own: Set[str], first: int, last: int) -> tuple[float, FloatArray]:
        """Mean sum of some bodies' normal forces on all others, and their vector sum, (3,) [N]."""
        names, total, push = self._physics.body_names, 0.0, np.zeros(3)
        for numbers, _, contacts in self._by_pair(first, last):
            inside, force = [each for each in numbers if names[each] in own], self._forces[contacts]
            if len(inside) == 1:
                total += float(force.sum())
                push += (force * self._signs(contacts, inside[0])) @ self._normals[contacts]
        return total / (last - first), push / (last - first)

    def presses(self, first: int, last: int) -> dict[BodyPair, FloatArray]:
        """Contact points and normal forces between a link of the robot and any other body.

        Returns:
            The presses by link and other body in samples first to last - 1, shape (samples, 6): the
            mean of the contact points, weighted by their normal forces, in the world; then the sum
            of these forces on the other body, in world axes [N]. NaN where there is no force.
        """
        found: dict[BodyPair, FloatArray] = {}
        for pair, link, rows, contacts in self._by_link(first, last):
            sums = found.setdefault(pair, np.zeros((last - first, 7)))
            force = self._forces[contacts]
            signed = self._signs(contacts, link) * force
            weighted = [*(self._points[contacts] * force[:, None]).T]
            vectors = [*(self._normals[contacts] * signed[:, None]).T]
            for column, values in enumerate((*weighted, *vectors, force)):
                _add(sums[:, column], rows, values)
        for pair, sums in found.items():
            pressed = np.full((last - first, 6), np.nan)
            there = sums[:, 6] > 0
            pressed[there] = sums[there, :6]
            pressed[there, :3] /= sums[there, 6:]
            found[pair] = pressed
        return {pair: found[pair] for pair in sorted(found)}

    def frictions(self, first: int, last: int) -> dict[BodyPair, FloatArray]:
        """Friction forces of a link of the robot on any other body, in world axes [N].

        Returns:
            The friction forces by link and other body in samples first to last - 1, shape
            (samples, 3); zero without contact.
        """
        found: dict[BodyPair, FloatArray] = {}
        for pair, link, rows, contacts in self._by_link(first, last):
            sums = found.setdefault(pair, np.zeros((last - first, 3)))
            on_other = self._frictions[contacts] * self._signs(contacts, link)[:, None]
            for column in range(3):
                _add(sums[:, column], rows, on_other[:, column])
        return {pair: found[pair] for pair in sorted(found)}

    def support_forces(self, first: int, last: int) -> dict[BodyPair, FloatArray]:
        """Upward part of the normal force [N] of one object on another, as `forces` returns it."""
        names, robot = self._physics.body_names, self._physics.robot_bodies
        found: dict[BodyPair, FloatArray] = {}
        for numbers, rows, contacts in self._by_pair(first, last):
            if not robot.isdisjoint(numbers):
                continue
            pair = self._pair(*numbers)
            below = next(number for number in numbers if names[number] == pair[0])
            upward = self._forces[contacts] * self._normals[contacts, 2]
            sums = found.setdefault(pair, np.zeros(last - first))
            _add(sums, rows, self._signs(contacts, below) * upward)
        return {pair: found[pair] for pair in sorted(found)}

    def slides(
        self,
        first: int,
        last: int,
        poses: Mapping[str, FloatArray],
        chosen: Set[str],
        surfaces: Mapping[str, FloatArray],
    ) -> dict[BodyPair, FloatArray]:
        """How far objects slide along each other since the sample before [m], shape (N,) each.

        It is the largest way along the surface of any point at which they press each other.

        Args:
            first: The first of the N samples, in which nothing slides.
            poses: T_world_object of each object, NaN while absent, shape (N, 7) each.
            chosen: Objects; pairs without any of them are left out.
            surfaces: The motion of the surface of each belt since the sample before, in its axes:
                its displacement at the origin [m] and its turn about z [rad], shape (N, 4) each.
        """
        found: dict[BodyPair, FloatArray] = {}
        for numbers, rows, contacts in self._by_pair(first, last):
            pair = self._pair(*numbers)
            if chosen.isdisjoint(pair) or not poses.keys() >= set(pair):
                continue
            presses = (self._forces[contacts] > 0) & (rows > 0)
            rows, contacts = rows[presses], contacts[presses]
            points, normals = self._points[contacts], self._normals[contacts]
            ways = [_way_of_points(poses[name], rows, points, surfaces.get(name)) for name in pair]
            way = np.nan_to_num(ways[0] - ways[1])
            way -= np.sum(way * normals, axis=1, keepdims=True) * normals
            slid = found.setdefault(pair, np.zeros(last - first))
            np.maximum.at(slid, rows, np.linalg.norm(way, axis=1))
        return {pair: found[pair] for pair in sorted(found)}

    def _by_link(self, first: int, last: int) -> Iterator[tuple[BodyPair, int, Array, Array]]:
        """Contacts of a link of the robot with any other body, as `_by_pair` yields them.

        Yields:
            The names of the two, the id of the link, the samples, and the contacts' indices.
        """
        robot = self._physics.robot_bodies
        for (one, other), rows, contacts in self._by_pair(first, last):
            if (one in robot) != (other in robot):
                yield self._pair(one, other), one if one in robot else other, rows, contacts

    def _by_pair(self, first: int, last: int) -> Iterator[tuple[tuple[int, int], Array, Array]]:
        """Contacts of each pair of bodies in samples first to last - 1.

        Contacts are sorted by pair, some samples at a time: the time is linear in their number
        however many pairs there are, and little memory is needed in addition to the record.

        Yields:
            The ids of two bodies, the smaller first; then, for their contacts in some samples, in
            the order of recording, the sample counted from `first` and the contact's index.
        """
        ends = self._end[first:last]
        row = 0
        while row < len(ends):
            begin = self._begin(first + row)
            stop = max(row + 1, int(np.searchsorted(ends, begin + BLOCK, side="right")))
            rows = np.repeat(np.arange(row, stop), np.diff(ends[row:stop], prepend=begin))
            for numbers, contacts in self._sorted(begin, begin + len(rows)):
                yield numbers, rows[contacts - begin], contacts
            row = stop

    def _sorted(self, begin: int, end: int) -> Iterator[tuple[tuple[int, int], Array]]:
        """Ids of two bodies, the smaller first, and the indices of the contacts between them."""
        if begin == end:
            return
        size = self._physics.model.nbody
        one, other = self._physics.model.geom_bodyid[self._geoms[begin:end].T]
        codes = np.minimum(one, other) * size + np.maximum(one, other)
        codes = codes.astype(np.min_scalar_type(size * size))  # 16 bits are sorted in linear time
        order = np.argsort(codes, kind="stable")
        codes = codes[order]
        starts = np.flatnonzero(codes[1:] != codes[:-1]) + 1
        order += begin
        for code, contacts in zip(
            codes[[0, *starts]].tolist(), np.split(order, starts), strict=True
        ):
            yield divmod(code, size), contacts

    def _signs(self, contacts: Array, body: int) -> Array:
        """1 where a contact's normal, from its first geom to its second, leaves a body; else -1."""
        return np.where(
            self._physics.model.geom_bodyid[self._geoms[contacts, 0]] == body, 1.0, -1.0
        )

    def _pair(self, first: int, second: int) -> BodyPair:
        """The names of two bodies: the robot's link first, otherwise in alphabetical order."""
        names, robot = self._physics.body_names, self._physics.robot_bodies
        one, other = names[first], names[second]
        if (first in robot) != (second in robot):
            return (one, other) if first in robot else (other, one)
        return min(one, other), max(one, other)


def _way_of_points(
    poses: FloatArray, rows: Array, points: Array, surface: FloatArray | None
) -> FloatArray:
    """How far points of a body's surface moved since the sample before [m], shape (C, 3).

    Args:
        surface: The motion of a belt's surface along its body, as in `slides`.
    """
    now, before = poses[rows], poses[rows - 1]
    in_body = rotate(conjugate(now[:, 3:]), points - now[:, :3])
    way = points - before[:, :3] - rotate(before[:, 3:], in_body)
    if surface is None:
        return way
    shift, turn = surface[rows, :3], surface[rows, 3]
    shift = shift + np.column_stack([-turn * in_body[:, 1], turn * in_body[:, 0], 0 * turn])
    return way + rotate(now[:, 3:], shift)


def _add(sums: FloatArray, rows: Array, values: Array) -> None:
    """Add values at their rows; rows are in ascending order."""
    part = np.bincount(rows - rows[0], values)
    sums[rows[0] : rows[0] + len(part)] += part


def doubled(values: Array, needed: int) -> Array:
    """Copy values into an array at least twice as long; its new part takes no memory until used."""
    larger = np.empty((max(2 * len(values), needed), *values.shape[1:]), values.dtype)
    larger[: len(values)] = values
    return larger
