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
            self._geoms = np.concatenate([self._geoms, np.empty_like(self._geoms)])
            self._forces = np.concatenate([self._forces, np.empty_like(self._forces)])
            self._normals = np.concatenate([self._normals, np.empty_like(self._normals)])
            self._points = np.concatenate([self._points, np.empty_like(self._points)])
        if end > begin:
            contact = data.contact
            self._geoms[begin:end] = contact.geom
            self._normals[begin:end] = contact.frame[:, :3]
            self._points[begin:end] = contact.pos
            _normal_forces(data, self._forces[begin:end])

    def forces(self, first: int, last: int) -> dict[BodyPair, FloatArray]:
        """Normal force [N] of pairs that touch in samples first to last - 1, (samples,) each."""
        begin = int(self._end[first - 1]) if first else 0
        forces = self._forces[begin : self._end[last - 1]]
        rows = self._rows(first, last)
        found = {
            self._pair(*numbers): np.bincount(rows[chosen], forces[chosen], minlength=last - first)
            for numbers, chosen in self._by_pair(begin, int(self._end[last - 1]))
        }
        return {pair: found[pair].astype(np.float64) for pair in sorted(found)}

    def presses(self, count: int) -> dict[BodyPair, FloatArray]:
        """Where a link of the robot presses on something else, and how.

        Args:
            count: Samples, from the first on.

        Returns:
            By link and other body, shape (count, 6): the mean of the contact points, weighted by
            their normal forces, in the world; then the sum of these forces on the other body, in
            world axes [N]. NaN where there is no force.
        """
        end, rows, robot = (
            int(self._end[count - 1]),
            self._rows(0, count),
            self._physics.robot_bodies,
        )
        found: dict[BodyPair, FloatArray] = {}
        for (first, second), chosen in self._by_pair(0, end):
            if (first in robot) == (second in robot):
                continue
            link = first if first in robot else second
            where, force = rows[chosen], self._forces[:end][chosen]
            # a contact's normal points from its first geom to its second
            bodies = self._physics.model.geom_bodyid[self._geoms[:end][chosen, 0]]
            signed = np.where(bodies == link, force, -force)
            total = np.bincount(where, force, minlength=count)
            weighted = [*(self._points[:end][chosen] * force[:, None]).T]
            vectors = [*(self._normals[:end][chosen] * signed[:, None]).T]
            sums = [np.bincount(where, values, minlength=count) for values in (*weighted, *vectors)]
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
        end, rows = int(self._end[count - 1]), self._rows(0, count)
        upward = self._forces[:end] * self._normals[:end, 2]
        names, robot = self._physics.body_names, self._physics.robot_bodies
        found: dict[BodyPair, FloatArray] = {}
        for numbers, chosen in self._by_pair(0, end):
            if not robot.isdisjoint(numbers):
                continue
            pair = self._pair(*numbers)
            # a contact's normal points from its first geom to its second
            bodies = self._physics.model.geom_bodyid[self._geoms[:end][chosen, 0]]
            signs = np.where(bodies == names.index(pair[0]), 1.0, -1.0)
            weights = (signs * upward[chosen]).astype(np.float64)
            found[pair] = np.bincount(rows[chosen], weights, count).astype(np.float64)
        return {pair: found[pair] for pair in sorted(found)}

    def _rows(self, first: int, last: int) -> Array:
        """Of every contact in samples first to last - 1: its sample, from 0."""
        begin = self._end[first - 1] if first else 0
        per_row = np.diff(self._end[first:last], prepend=begin)
        return np.repeat(np.arange(last - first), per_row)

    def _by_pair(self, begin: int, end: int) -> Iterator[tuple[tuple[int, int], Array]]:
        """Numbers of two bodies that touch, the smaller first, and which contacts are theirs."""
        bodies = self._physics.model.geom_bodyid[self._geoms[begin:end]]
        first, second = bodies.T
        codes = np.minimum(first, second) * self._physics.model.nbody + np.maximum(first, second)
        for code in np.unique(codes).tolist():
            yield divmod(code, self._physics.model.nbody), codes == code

    def _pair(self, first: int, second: int) -> BodyPair:
        """Names of two bodies: a robot's link first, else sorted."""
        names, robot = self._physics.body_names, self._physics.robot_bodies
        if (first in robot) != (second in robot):
            return (
                (names[first], names[second]) if first in robot else (names[second], names[first])
            )
        a, b = sorted((names[first], names[second]))
        return a, b


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
