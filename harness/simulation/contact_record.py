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
AT_ONCE = 500  # Samples whose contacts are converted at once
CONTACT = np.dtype("f8, 2i4, 3f4, 3f4, 3f4", align=True)
CONTACT.names = "force", "geoms", "normal", "point", "friction"
WORDS = CONTACT.itemsize // 8  # numpy takes rows of numbers ten times as fast as records

BodyPair = tuple[str, str]
Array = np.ndarray[Any, Any]


class ContactRecord:
    """The contacts of consecutive samples, and sums of them for each pair of bodies.

    MuJoCo computes no contacts of bodies that are asleep: as nothing
    moves there, they are those of the last sample in which the bodies were awake.
    """

    def __init__(self, physics: PhysicsModel, data: mujoco.MjData) -> None:
        self._physics = physics
        self._data = data
        self._end = np.zeros(ROWS, dtype=np.int64)
        self._contacts = np.empty((ROWS * CONTACTS_PER_ROW, WORDS))
        self._sleep = b""  # the state of sleep for which contacts of bodies asleep are known
        self._asleep = self._contacts[:0]
        self._copied: list[list[Array]] = []  # of the last samples, which are converted together
        self._rows = self._count = 0  # samples and contacts that are converted

    @property
    def nbytes(self) -> int:
        """The memory that the contacts of all samples take."""
        self._convert()
        return self._count * CONTACT.itemsize

    def rewind(self, rows: int) -> None:
        """Forget the contacts of all samples after the first `rows`."""
        self._convert()
        self._rows, self._count = rows, self._begin(rows)
        self._sleep = b""

    def keep(self) -> None:
        """Copy the contacts of the current physics state as those of the next sample."""
        data = self._data
        if data.tree_asleep.tobytes() != self._sleep:
            self._find_asleep()
        contact = data.contact
        parts = contact.geom, contact.pos, contact.frame, contact.efc_address, data.efc_force
        self._copied.append([part.copy() for part in parts])
        if len(self._copied) == AT_ONCE:
            self._convert()

    def _convert(self) -> None:
        """Put the copied contacts of the last samples into the record."""
        copied, self._copied = self._copied, []
        if not copied:
            return
        parts = [*zip(*copied, strict=True)]
        geoms, points, axes, addresses, forces = map(np.concatenate, parts)
        counts, sizes = ([*map(len, part)] for part in parts[3:])
        # A contact's forces: normal, then friction along its other two axes. An inactive one has
        # no constraint rows and the address -1; it has no forces.
        starts = addresses + np.repeat(np.cumsum(sizes) - sizes, counts)
        starts = np.where(addresses < 0, len(forces), starts)
        pressed = np.append(forces, np.zeros(3)).take(starts[:, None] + np.arange(3))
        friction = pressed[:, 1:2] * axes[:, 3:6]
        friction += pressed[:, 2:] * axes[:, 6:]
        found = np.empty(len(addresses), CONTACT)
        found["force"], found["friction"] = pressed[:, 0], friction
        found["geoms"], found["normal"], found["point"] = geoms, axes[:, :3], points
        begin, first, samples = self._count, self._rows, np.arange(len(copied))
        rows = np.append(samples.repeat(counts), samples.repeat(len(self._asleep)))
        ends = begin + np.bincount(rows, minlength=len(copied)).cumsum()
        self._count, self._rows = int(ends[-1]), first + len(copied)
        self._end = enlarged(self._end, self._rows)
        self._end[first : self._rows] = ends
        asleep = np.tile(self._asleep, (len(copied), 1))
        found = np.concatenate([found.view(np.float64).reshape(-1, WORDS), asleep])
        self._contacts = enlarged(self._contacts, self._count)
        self._contacts[begin : self._count] = found.take(rows.argsort(kind="stable"), axis=0)

    def _find_asleep(self) -> None:
        """Take the contacts of bodies asleep from the sample before."""
        self._convert()
        model, data = self._physics.model, self._data
        self._sleep = data.tree_asleep.tobytes()
        is_asleep = np.append(data.tree_asleep, -1) >= 0
        trees = model.body_treeid[model.geom_bodyid]  # -1, the last, for a static body
        before = self._contacts[self._begin(max(0, self._rows - 1)) : self._count]
        self._asleep = before[is_asleep[trees[before.view(CONTACT)["geoms"][:, 0]]].any(axis=1)]

    def _begin(self, row: int) -> int:
        """The first contact of a sample."""
        return int(self._end[row - 1]) if row else 0

    def forces(self, first: int, last: int) -> dict[BodyPair, FloatArray]:
        """Normal force [N] of pairs that touch in samples first to last - 1, (samples,) each."""
        found: dict[BodyPair, FloatArray] = {}
        for numbers, rows, contacts in self._by_pair(first, last):
            sums = found.setdefault(self._pair(*numbers), np.zeros(last - first))
            _add(sums, rows, contacts["force"])
        return {pair: found[pair] for pair in sorted(found)}

    def force_on(self, own: Set[str], first: int, last: int) -> tuple[float, FloatArray]:
        """Mean sum of some bodies' normal forces on all others, and their vector sum, (3,) [N]."""
        names, total, push = self._physics.body_names, 0.0, np.zeros(3)
        for numbers, _, contacts in self._by_pair(first, last):
            inside, force = [each for each in numbers if names[each] in own], contacts["force"]
            if len(inside) == 1:
                total += float(force.sum())
                push += (force * self._signs(contacts, inside[0])) @ contacts["normal"]
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
            force = contacts["force"]
            signed = self._signs(contacts, link) * force
            weighted = [*(contacts["point"] * force[:, None]).T]
            vectors = [*(contacts["normal"] * signed[:, None]).T]
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
            on_other = contacts["friction"] * self._signs(contacts, link)[:, None]
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
            upward = contacts["force"] * contacts["normal"][:, 2]
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
            presses = (contacts["force"] > 0) & (rows > 0)
            rows, contacts = rows[presses], contacts.compress(presses)
            points, normals = contacts["point"], contacts["normal"]
            ways = [_way_of_points(poses[name], rows, points, surfaces.get(name)) for name in pair]
            way = np.nan_to_num(ways[0] - ways[1])
            way -= np.sum(way * normals, axis=1, keepdims=True) * normals
            slid = found.setdefault(pair, np.zeros(last - first))
            np.maximum.at(slid, rows, np.linalg.norm(way, axis=1))
        return {pair: found[pair] for pair in sorted(found)}

    def _by_link(self, first: int, last: int) -> Iterator[tuple[BodyPair, int, Array, Array]]:
        """Contacts of a link of the robot with any other body, as `_by_pair` yields them.

        Yields:
            The names of the two, the id of the link, the samples, and the contacts.
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
            the order of recording, the sample counted from `first` and the contact.
        """
        self._convert()
        ends = self._end[first:last]
        row = 0
        while row < len(ends):
            begin = self._begin(first + row)
            stop = max(row + 1, int(np.searchsorted(ends, begin + BLOCK, side="right")))
            rows = np.repeat(np.arange(row, stop), np.diff(ends[row:stop], prepend=begin))
            for numbers, places in self._sorted(begin, begin + len(rows)):
                found = self._contacts.take(places, axis=0).view(CONTACT)[:, 0]
                yield numbers, rows[places - begin], found
            row = stop

    def _sorted(self, begin: int, end: int) -> Iterator[tuple[tuple[int, int], Array]]:
        """Ids of two bodies, the smaller first, and the places of the contacts between them."""
        if begin == end:
            return
        size = self._physics.model.nbody
        geoms = self._contacts[begin:end].view(CONTACT)["geoms"][:, 0].T
        one, other = self._physics.model.geom_bodyid[geoms]
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
        bodies = self._physics.model.geom_bodyid[contacts["geoms"][:, 0]]
        return np.where(bodies == body, 1.0, -1.0)

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


def enlarged(values: Array, needed: int) -> Array:
    """The values, in an array twice as long if needed; its new part takes no memory until used."""
    if needed <= len(values):
        return values
    larger = np.empty((max(2 * len(values), needed), *values.shape[1:]), values.dtype)
    larger[: len(values)] = values
    return larger
