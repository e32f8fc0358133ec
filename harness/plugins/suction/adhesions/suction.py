"""Suction cups in the physics: where a rim is sealed, and the force with which it holds."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass
from itertools import takewhile
from typing import Any, ClassVar

import mujoco
import numpy as np

from harness.core.types import FloatArray
from harness.robot.end_effector import Cup, Gripper, seal_words
from harness.simulation.adhesion import Adhesion
from harness.simulation.model import PhysicsModel

QUARTER = 3  # rays along each quarter of a rim
RINGS = ((0.0, 1), (0.5, 6))
"""Radius, as a share of the rim's, and number of rays inside a rim: every hole is found that is
wider than 0.6 of the rim's radius, and some smaller ones."""

BACK = 0.001  # How far rays begin outside of what may bulge into a cup [m]
OPEN_SHARE = 0.02  # Share of a valve's way up to which it is shut


SEAL_EVERY = 4
"""Samples between two looks at the seals of a held load: rays take longer than a step. A load falls
by less than 0.1 mm meanwhile."""


@dataclass(frozen=True)
class _Seal:
    """What a rim touches: the number of the cup, and the id of the body, -1 where there is none."""

    cup: int
    body: int
    quarters: int
    is_sealed: bool


@dataclass(frozen=True, eq=False)
class _Entry:
    """A cup with its valve open at a sample: its seal, and its force on the body [N], (3,)."""

    row: int
    seal: _Seal
    force: FloatArray


class Suction(Adhesion):
    """The cups of all grippers: their seal at each sample, and the forces that follow from it.

    A cup is sealed where every ray along its rim meets the same body within its lip, and every ray
    inside it meets that body no farther than the lip and not nearer than its depth allows. Then the
    atmosphere presses the body against the cup, at the centre of the rim and along its axis, with
    the vacuum times the area; the cup is pressed with the opposite force. MuJoCo's adhesion
    actuator pulls at contacts instead, also at a single one in a corner.
    """

    name: ClassVar[str] = "suction"

    def __init__(self, physics: PhysicsModel, data: mujoco.MjData) -> None:
        model, description = physics.model, physics.description
        grippers = [(each, cup) for each in description.grippers for cup in each.cups]
        self.cups: tuple[Cup, ...] = tuple(cup for _, cup in grippers)
        self._physics, self._data = physics, data
        self._log: list[_Entry] = []
        self._hands = [gripper for gripper, _ in grippers]
        self._bodies = [int(model.body(cup.link).id) for cup in self.cups]
        self._valves = [
            int(physics.qpos[description.joint_index[hand.joint]]) for hand in self._hands
        ]
        self._rays = [_ray_starts(cup) for cup in self.cups]
        self._owners: list[int] = model.geom_bodyid.tolist()
        self._geom = np.full(1, -1, dtype=np.int32)

    def _vacuum(self, number: int) -> float:
        """The pressure below the atmosphere's that the valve of a cup lets through now [Pa]."""
        hand = self._hands[number]
        way = hand.closed_position - hand.open_position
        share = (float(self._data.qpos[self._valves[number]]) - hand.open_position) / way
        return hand.vacuum * min(share, 1.0) if share > OPEN_SHARE else 0.0

    def apply(self, row: int, *, anew: bool = False) -> None:
        self._data.qfrc_applied[:] = 0.0
        self._data.xfrc_applied[self._bodies] = 0.0
        before = takewhile(lambda entry: entry.row == row - 1, reversed(self._log))
        known = (
            {} if anew or row % SEAL_EVERY == 0 else {each.seal.cup: each.seal for each in before}
        )
        entries: list[_Entry] = []
        for number, cup in enumerate(self.cups):
            if vacuum := self._vacuum(number):
                seal = known.get(number) or self._seal(number, cup)
                force = self._press(seal, vacuum * cup.area) if seal.is_sealed else np.zeros(3)
                entries.append(_Entry(row, seal, force))
        self._log += entries

    def rewind(self, count: int) -> None:
        self._log = [entry for entry in self._log if entry.row < count]

    def held(self, row: int, gripper: Gripper) -> set[str]:
        names = self._physics.body_names
        seals = self._seals(row, gripper).values()
        return {names[seal.body] for seal in seals if seal is not None and seal.is_sealed}

    def unsealed(self, row: int, gripper: Gripper) -> dict[str, str]:
        return {
            cup: seal_words(None if seal is None else seal.quarters)
            for cup, seal in self._seals(row, gripper).items()
            if seal is None or not seal.is_sealed
        }

    def _seals(self, row: int, gripper: Gripper) -> dict[str, _Seal | None]:
        """The seals of a gripper's cups at a sample, by name; None where the valve is shut."""
        seals = {entry.seal.cup: entry.seal for entry in self._log if entry.row == row}
        numbers = [number for number, hand in enumerate(self._hands) if hand is gripper]
        return {self.cups[number].name: seals.get(number) for number in numbers}

    def recorded(self, count: int) -> dict[tuple[str, str], FloatArray]:
        pulls: dict[tuple[str, str], FloatArray] = {}
        for entry in self._log:
            if entry.seal.body < 0:
                continue
            pair = self.cups[entry.seal.cup].link, self._physics.body_names[entry.seal.body]
            rows = pulls.setdefault(pair, np.zeros((count, 4)))
            rows[entry.row] = [*entry.force, entry.seal.quarters]
        return {pair: pulls[pair] for pair in sorted(pulls)}

    def _seal(self, number: int, cup: Cup) -> _Seal:
        """The body before a cup, the quarters of the rim that touch it, and whether it is sealed.

        The body is the first that the rim meets; a rim on two bodies leaks between them.
        """
        model, data, own = self._physics.model, self._data, self._bodies[number]
        turn = data.xmat[own].reshape(3, 3)
        origins, along, geom = data.xpos[own] + self._rays[number] @ turn.T, turn[:, 2], self._geom
        body, met, is_sealed = -1, list[bool](), True
        for origin in origins:
            gap = mujoco.mj_ray(model, data, origin, along, None, 1, own, geom) - _back(cup)
            owner = self._owners[geom[0]] if geom[0] >= 0 and gap <= cup.lip else -1
            body = owner if body < 0 else body
            met.append(owner == body >= 0)
            is_sealed &= met[-1] and gap >= -cup.depth
        quarters = sum(all(met[QUARTER * each : QUARTER * (each + 1)]) for each in range(4))
        return _Seal(number, body, quarters, is_sealed)

    def _press(self, seal: _Seal, size: float) -> FloatArray:
        """Press a body against a cup; returns the force on the body, shape (3,) [N].

        The cup is pressed by `xfrc_applied`, which sensors of force read; nothing else pushes it.
        """
        model, data, own = self._physics.model, self._data, self._bodies[seal.cup]
        force = -size * data.xmat[own].reshape(3, 3)[:, 2]
        point, still, target = data.xpos[own].copy(), np.zeros(3), data.qfrc_applied
        mujoco.mj_applyFT(model, data, force, still, point, seal.body, target)
        data.xfrc_applied[own, :3] -= force
        data.xfrc_applied[own, 3:] -= np.cross(point - data.xipos[own], force)
        return force


def _ray_starts(cup: Cup) -> FloatArray:
    """Where the rays of a cup begin, in its frame: first along the rim, then inside, (N, 3) [m]."""
    count = 4 * QUARTER
    rings = [(1.0, count, np.pi / count), *((share, number, 0.0) for share, number in RINGS)]
    starts: list[list[Any]] = []
    for share, number, first in rings:
        for ray in range(number):
            angle = first + 2 * np.pi * ray / number
            radius = share * cup.radius
            starts.append([radius * np.cos(angle), radius * np.sin(angle), -_back(cup)])
    return np.array(starts)


def _back(cup: Cup) -> float:
    """How far before the plane of its rim the rays of a cup begin [m]."""
    return cup.depth + BACK
