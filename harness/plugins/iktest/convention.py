"""How a function counts: units of targets and answers, zeros and directions of joints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.contract import Value, call_arguments
from harness.plugins.iktest.strategies.poses import Target
from harness.plugins.iktest.strategies.tasks import Task, task_error, task_jacobians

LENGTHS = {"metres": 1.0, "centimetres": 0.01, "millimetres": 0.001}
ANGLES = {"": 1.0, "is given in degrees": np.pi / 180, "counts upwards": -1.0}
ROLLS = {"quat_wxyz": -1, "quat_xyzw": 1}  # places by which the other order of w, x, y, z is rolled
STARTS = (0.0, np.pi / 2, -np.pi / 2, np.pi)  # [rad], of a joint's zero, from which a fit starts

MOST_SAMPLES, MOST_STEPS = 10, 12
KEPT = 0.8  # share of the answers that a convention explains; others may be wrong in another way
NO_OFFSET = 1e-6  # [rad or m]
CONVERGED = 1e-11  # [rad or m] of a step
NEARLY_RIGHT = 1e-3  # [rad, or m as a share of the reach] of answers that a fit explains


@dataclass(frozen=True, eq=False)
class Convention:
    """How a function counts: joint positions are `scale * answer + offset`.

    Attributes:
        scale: The unit of each joint in rad or m, shape (dof,); negative in the other direction.
        offset: The zero of each joint, shape (dof,) [rad or m].
        length: The unit of a target's position [m].
        angle: The unit of a target's pitch [rad], negative if it counts upwards.
        roll: The places by which a target's quaternion is rolled, as in `ROLLS`; 0 in its order.
    """

    scale: FloatArray
    offset: FloatArray
    length: float = 1.0
    angle: float = 1.0
    roll: int = 0

    @classmethod
    def plain(cls, dof: int) -> Convention:
        """The convention of the contract: radians, metres, and the zeros of the robot."""
        return cls(np.ones(dof), np.zeros(dof))

    def positions(self, answer: FloatArray) -> FloatArray:
        """Joint positions of an answer [rad or m]."""
        return self.scale * answer + self.offset

    def answer(self, positions: FloatArray) -> FloatArray:
        """The answer that stands for joint positions [rad or m]."""
        return (positions - self.offset) / self.scale

    def changes(self) -> int:
        """The number of zeros and directions that differ from the robot's."""
        return int(np.count_nonzero(self.offset) + np.count_nonzero(self.scale < 0))

    def arguments(self, words: Sequence[str], target: SE3, seed: FloatArray) -> dict[str, Value]:
        """What a function is called with for a target, by its parameters."""
        scaled = SE3(target.rotation, target.translation / self.length)
        found = call_arguments(words, scaled, self.answer(seed))
        if "pitch" in found:
            found["pitch"] = float(found["pitch"]) / self.angle
        found |= {word: np.roll(found[word], self.roll) for word in ROLLS if word in found}
        return found

    def text(self, chain: Chain) -> str:
        """What makes answers right, in words."""
        unit = {value: name for name, value in LENGTHS.items()}
        sizes = np.abs(self.scale)
        parts = ["it is taken in degrees"] if np.any(sizes[chain.is_turning] != 1) else []
        parts += [
            f"its lengths are taken in {unit[float(size)]}"
            for size in np.unique(sizes[~chain.is_turning])
            if size != 1
        ]
        rows = zip(chain.joint_names, chain.is_turning, self.scale, self.offset, strict=True)
        for name, is_turning, scale, offset in rows:
            amount = f"{abs(offset):.4g} {'rad' if is_turning else 'm'}"
            if scale < 0 and not offset:
                parts.append(f"{name} counts in the other direction")
            elif scale < 0:
                parts.append(f"{name} is {'-' if offset < 0 else ''}{amount} minus the answer's")
            elif offset:
                parts.append(f"{name} is {amount} {'more' if offset > 0 else 'less'}")
        parts += [f"the target is given in {unit[self.length]}"] if self.length != 1 else []
        parts += [f"`pitch` {word}" for word, value in ANGLES.items() if value == self.angle != 1]
        if self.roll:
            parts.append(f"the quaternion's w comes {'last' if self.roll < 0 else 'first'}")
        return " and ".join(parts)


def target_units(chain: Chain, words: Sequence[str]) -> Iterator[Convention]:
    """Conventions with other units of targets, the plain one first."""
    angles = ANGLES.values() if "pitch" in words else [1.0]
    rolls = [0, *(ROLLS[word] for word in words if word in ROLLS)]
    for length, angle, roll in product(LENGTHS.values(), angles, rolls):
        yield replace(Convention.plain(chain.dof), length=length, angle=angle, roll=roll)


def answer_units(chain: Chain, convention: Convention) -> Iterator[Convention]:
    """The convention with other units of answers, the same first."""
    lengths = [1.0] if chain.is_turning.all() else LENGTHS.values()
    turns = [1.0, np.pi / 180] if chain.is_turning.any() else [1.0]
    for turn, length in product(turns, lengths):
        yield replace(convention, scale=np.where(chain.is_turning, turn, length))


def with_fitted_zeros(
    chain: Chain,
    task: Task,
    convention: Convention,
    pairs: Sequence[tuple[Target, FloatArray]],
    *,
    is_shifted: bool,
) -> Iterator[Convention]:
    """The convention with zeros and directions of joints for which answers reach their targets.

    Gauss-Newton on the offsets of all joints at once, for up to two joints in the other direction
    and from a few zeros, on the answers that fit best.

    Args:
        pairs: Targets and what the function answered.
        is_shifted: Whether the base and the tool may be elsewhere, too.
    """
    if not pairs:
        return
    step = 1 + (len(pairs) - 1) // MOST_SAMPLES
    targets = [target.pose for target, _ in pairs[::step]]
    answers = np.array([answer for _, answer in pairs[::step]])
    for directions, offset in _starts(chain):
        scale = directions * convention.scale
        found = _fitted_offset(chain, task, targets, scale * answers, offset, is_shifted)
        if found is not None:
            turns = 2 * np.pi * np.round(found / (2 * np.pi)) * chain.is_turning
            found = np.round(found - turns, 9)
            offset = np.where(np.abs(found) < NO_OFFSET, 0.0, found)
            yield replace(convention, scale=scale, offset=offset)


def _starts(chain: Chain) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Directions and zeros of the joints from which a fit starts, shape (dof,) each."""
    for joint, direction, start in product(range(chain.dof), (1.0, -1.0), STARTS):
        directions, offset = np.ones(chain.dof), np.zeros(chain.dof)
        directions[joint] = direction
        offset[joint] = start if chain.is_turning[joint] else 0.0
        yield directions, offset
    for both in combinations(range(chain.dof), 2):
        directions = np.ones(chain.dof)
        directions[[*both]] = -1.0
        yield directions, np.zeros(chain.dof)


def _fitted_offset(
    chain: Chain,
    task: Task,
    targets: Sequence[SE3],
    answers: FloatArray,
    offset: FloatArray,
    is_shifted: bool,
) -> FloatArray | None:
    """Offsets of the joints with which most answers reach their targets, or None.

    Of a shifted function its base is shifted in the world, its tool in the reached link.
    """
    reach = max(chain.farthest()[1], 1e-6)
    count = max(1, round(KEPT * len(targets)))
    base, tool = np.zeros((2, 3))
    for _ in range(MOST_STEPS):
        samples = answers + offset
        reached = [chain.link_pose(each) for each in samples]
        shifted = [SE3(p.rotation, p.translation + base + p.rotation @ tool) for p in reached]
        pairs = zip(targets, shifted, strict=True)
        errors = np.array([task_error(task, *pair, reach) for pair in pairs])
        best = np.argsort(np.abs(errors).max(axis=1), kind="stable")[:count]
        columns = task_jacobians(chain, task, samples[best])
        if is_shifted:
            shifts = np.zeros((count, columns.shape[1], 6))
            shifts[:, :3, :3] = np.eye(3) / reach
            shifts[:, :3, 3:] = np.array([reached[each].rotation for each in best]) / reach
            columns = np.concatenate([columns, shifts], axis=2)
        rows = columns.reshape(-1, columns.shape[2])
        change = np.linalg.lstsq(rows, errors[best].ravel(), rcond=1e-9)[0]
        size = float(np.abs(change).max())
        change /= max(1.0, size)
        offset = offset + change[: chain.dof]
        if is_shifted:
            base, tool = base + change[-6:-3], tool + change[-3:]
        if size < CONVERGED:
            return offset if np.abs(errors[best]).max() < NEARLY_RIGHT else None
    return None
