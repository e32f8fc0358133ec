"""Path constraints: how far a state is inside them, and its projection back into them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray
from harness.planning.model.robot_model import GroupSpace
from harness.planning.model.turns import FREE, turn_from
from harness.ports.goals import PathConstraints, PositionBox
from harness.recording.motion_failures import ConstraintFailure

INNER_SHARE = 0.8
"""Of every tolerance that projected states keep to, so that the lines between them hold it too."""

_NUDGE = 1e-6  # [rad or m] of finite differences
_ITERATIONS = 20


@dataclass(frozen=True)
class Violation:
    """The constraint that a state breaks most.

    Attributes:
        what: The violation in words: `end_effector_link is turned 0.20 rad about y, 0.10 rad are
            allowed`.
        excess: Beyond its tolerance [rad or m].
        record: The value and its bounds.
    """

    what: str
    excess: float
    record: ConstraintFailure


class HeldConstraints:
    """Path constraints of one planning call, as values with bounds.

    Attributes:
        space: The space of the planning group.
        lower: The lower bound of each value, shape (m,).
        upper: The upper bound of each value, shape (m,).
        checks: The number of states evaluated.
    """

    def __init__(self, constraints: PathConstraints, space: GroupSpace) -> None:
        self.space = space
        self.checks = 0
        self._constraints = constraints
        names: list[str] = []
        low: list[float] = []
        high: list[float] = []
        band, box = constraints.orientation, constraints.position
        if band is not None:
            names += [f"{band.link} is turned {{value:.3f}} rad about {axis}" for axis in "xyz"]
            low += [-tolerance if tolerance < FREE else -np.inf for tolerance in band.tolerance]
            high += [tolerance if tolerance < FREE else np.inf for tolerance in band.tolerance]
        if box is not None:
            names += [
                f"{box.link} is {{value:.4f}} m off the box's middle along {axis}" for axis in "xyz"
            ]
            low += [-0.5 * size for size in box.size]
            high += [0.5 * size for size in box.size]
        self._joints = []
        for joint in constraints.joints:
            names.append(f"{joint.joint} is at {{value:.4f}}")
            low.append(joint.lower)
            high.append(joint.upper)
            self._joints.append(space.joint_names.index(joint.joint))
        self._names = names
        self.lower, self.upper = np.array(low), np.array(high)
        width = np.where(np.isfinite(self.upper - self.lower), self.upper - self.lower, 0.0)
        margin = 0.5 * (1 - INNER_SHARE) * width
        self._inner_lower, self._inner_upper = self.lower + margin, self.upper - margin

    @property
    def narrowest(self) -> float:
        """The smallest half width of a band [rad or m]."""
        return float(0.5 * (self.upper - self.lower).min())

    def values(self, positions: FloatArray) -> FloatArray:
        """Values of all constraints at group positions, shape (m,)."""
        self.checks += 1
        parts: list[FloatArray] = []
        whole, robot = self.space.whole(positions), self.space.robot
        band, box = self._constraints.orientation, self._constraints.position
        if band is not None:
            rotation = robot.link_pose(whole, band.link).rotation
            parts.append(turn_from(band.rotation, rotation, band.tolerance))
        if box is not None:
            parts.append(_offset(box, robot.link_pose(whole, box.link).translation))
        parts.append(positions[self._joints])
        return np.concatenate(parts)

    def hold(self, positions: FloatArray) -> bool:
        """Whether all hold at group positions."""
        values = self.values(positions)
        return bool(np.all(values >= self.lower - 1e-9) and np.all(values <= self.upper + 1e-9))

    def hold_between(self, first: FloatArray, second: FloatArray, resolution: float) -> bool:
        """Whether all hold on a straight line, its first end taken as checked."""
        count = max(1, int(np.ceil(self.space.distance(first, second) / resolution)))
        return all(
            self.hold(first + (second - first) * (step / count)) for step in range(1, count + 1)
        )

    def violation(self, positions: FloatArray) -> Violation | None:
        """The one that is broken most at group positions, or None."""
        values = self.values(positions)
        excess = np.maximum(self.lower - values, values - self.upper)
        worst = int(np.argmax(excess))
        if excess[worst] <= 1e-9:
            return None
        allowed = f"{self.lower[worst]:.4g} to {self.upper[worst]:.4g} are allowed"
        return Violation(
            f"{self._names[worst].format(value=values[worst])}, {allowed}",
            float(excess[worst]),
            ConstraintFailure(
                float(values[worst]), float(self.lower[worst]), float(self.upper[worst])
            ),
        )

    def project(self, positions: FloatArray) -> FloatArray | None:
        """The state nearby that is well inside all constraints; None when there is no way to it.

        Newton's method on what is beyond the inner bounds, by finite differences, inside the joint
        limits.
        """
        q: FloatArray = np.array(positions, dtype=float)
        for _ in range(_ITERATIONS):
            values = self.values(q)
            off = values - np.clip(values, self._inner_lower, self._inner_upper)
            broken = np.flatnonzero(np.abs(off) > 1e-9)
            if not len(broken):
                return q
            slopes = np.empty((len(broken), self.space.dof))
            for joint in range(self.space.dof):
                nudged = q.copy()
                nudged[joint] += _NUDGE
                slopes[:, joint] = (self.values(nudged) - values)[broken] / _NUDGE
            step = np.linalg.lstsq(slopes, off[broken], rcond=1e-6)[0]
            q = np.asarray(np.clip(q - step, self.space.lower, self.space.upper), dtype=np.float64)
        return None


def _offset(box: PositionBox, point: FloatArray) -> FloatArray:
    return box.pose.inverse().apply(point)
