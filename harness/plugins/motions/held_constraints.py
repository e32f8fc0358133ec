"""Path constraints: how far a state is inside them, and its projection back into them."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import chain

import numpy as np
import pinocchio as pin

from harness.core.amounts import amount, amounts
from harness.core.kinematics import LinkPoses
from harness.core.pose_arrays import times_each
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker
from harness.planning.goals.goal_study import MOST_GOALS
from harness.planning.model.robot_model import GroupSpace
from harness.planning.model.turns import FREE, free_axis, turns_from
from harness.planning.verification.path_constraints import FindFrame, Violation
from harness.ports.goals import Goal, OrientationBand, PathConstraints, PositionBox, PositionGoal
from harness.recording.motion_failures import ConstraintFailure

INNER_SHARE = 0.8
"""Of every tolerance that states are projected to, so that the lines between them hold it too; half
of the rest is left to the last step of a projection."""

GOAL_SHARE = 0.98  # The same share for goals, which may be at the bounds
LIMIT_MARGIN = 0.01
"""Distance of projected states from joint limits, so that a smooth curve through them keeps these
[rad or m]."""

PROJECTIONS = 64  # Number of random positions that are projected to a goal and to path constraints

_ITERATIONS = 20  # Newton steps of a projection
_ROUNDING = 1e-9  # [rad or m] of values at their bounds
_DAMPING = 1e-12  # of steps at singular positions

Poses = tuple[FloatArray, FloatArray]
"""Rotations, shape (N, 3, 3), and translations, shape (N, 3) [m]."""


def random_positions(space: GroupSpace, rng: np.random.Generator) -> FloatArray:
    """Group positions drawn uniformly inside the limits, or in one turn where there are none."""
    lower = np.where(np.isfinite(space.lower), space.lower, -np.pi)
    upper = np.where(np.isfinite(space.upper), space.upper, np.pi)
    return rng.uniform(lower, upper)


class PathBands:
    """Path constraints of one planning call, as values with bounds.

    Attributes:
        space: The space of the planning group.
        lower: The lower bound of each value, shape (m,).
        upper: The upper bound of each value, shape (m,).
        checks: The number of states evaluated.
    """

    def __init__(
        self,
        constraints: PathConstraints,
        space: GroupSpace,
        find_frame: FindFrame,
        goal: PositionBox | None = None,
    ) -> None:
        """Prepare the constraints, and those of a goal that is to satisfy them.

        Raises:
            PlanningFailed: INVALID_LINK_NAME.
        """
        self.space = space
        self._constraints, self._find_frame = constraints, find_frame
        self.checks = 0
        self._measured: list[tuple[_Turn | _Tilt | _Offset, str, SE3]] = []
        names: list[tuple[str, str]] = []
        low: list[float] = []
        high: list[float] = []
        band, box = constraints.orientation, constraints.position
        for measure in (band and _turned(band), box and _Offset(box), goal and _Offset(goal)):
            if measure is not None:
                self._measured.append((measure, *find_frame(measure.frame)))
                names += measure.names
                low += [-width for width in measure.half_widths]
                high += measure.half_widths
        self._joints: list[int] = []
        for joint in constraints.joints:
            index = space.joint_names.index(joint.joint)
            names.append((f"{joint.joint} is at {{}}", "rad" if space.wraps[index] else "m"))
            low.append(joint.lower)
            high.append(joint.upper)
            self._joints.append(index)
        self._names = names
        self.lower, self.upper = np.array(low), np.array(high)
        width = np.where(np.isfinite(self.upper - self.lower), self.upper - self.lower, 0.0)
        margin = 0.5 * (1 - (INNER_SHARE if goal is None else GOAL_SHARE)) * width
        self._inner_lower, self._inner_upper = self.lower + margin, self.upper - margin
        self._slack = 0.5 * margin + _ROUNDING
        room = np.minimum(LIMIT_MARGIN, 0.1 * (space.upper - space.lower))
        self._least, self._most = space.lower + room, space.upper - room

    @property
    def narrowest(self) -> float:
        """The smallest half width of a band [rad or m]."""
        return float(0.5 * (self.upper - self.lower).min())

    def at(self, goal: PositionBox) -> PathBands:
        """These constraints and those of a goal."""
        return PathBands(self._constraints, self.space, self._find_frame, goal)

    def values(self, states: FloatArray) -> FloatArray:
        """Values of all constraints at group positions (N, dof), shape (N, m)."""
        self.checks += len(states)
        links = {link for _, link, _ in self._measured}
        poses = LinkPoses(self.space.robot.description.joints, self.space.whole(states), [*links])
        columns = [states[:, self._joints]]
        for measure, link, offset in self._measured[::-1]:
            rotations = poses.rotations[link]
            places = poses.translations[link] + times_each(rotations, offset.translation)
            columns.insert(0, measure.values((times_each(rotations, offset.rotation), places)))
        return np.hstack(columns)

    def hold(self, positions: FloatArray) -> bool:
        """Whether all hold at group positions."""
        return bool(self._excess(self._values_at(positions)).max() <= _ROUNDING)

    def hold_between(self, first: FloatArray, second: FloatArray, resolution: float) -> bool:
        """Whether all hold on a straight line, its first end taken as checked."""
        return bool(self._excess(self._between(first, second, resolution)).max() <= _ROUNDING)

    def are_inside(self, first: FloatArray, second: FloatArray, resolution: float) -> bool:
        """The same for states that are as far inside the bounds as projected ones."""
        values = self._between(first, second, resolution)
        off = values - np.clip(values, self._inner_lower, self._inner_upper)
        return bool(np.all(np.abs(off) <= self._slack))

    def _between(self, first: FloatArray, second: FloatArray, resolution: float) -> FloatArray:
        count = max(1, math.ceil(self.space.distance(first, second) / resolution))
        shares = np.arange(1, count + 1)[:, None] / count
        return self.values(first + (second - first) * shares)

    def first_violation(self, states: FloatArray) -> tuple[int, Violation] | None:
        """The first of states (N, dof) that breaks one, and the one that it breaks most."""
        values = self.values(states)
        excess = self._excess(values)
        broken = np.flatnonzero(excess.max(axis=1) > _ROUNDING)
        if not len(broken):
            return None
        row = int(broken[0])
        worst = int(np.argmax(excess[row]))
        value, low, high = (float(each[worst]) for each in (values[row], self.lower, self.upper))
        name, unit = self._names[worst]
        found, limit = amounts(value, high if value > high else low, unit)
        allowed = f"at most {limit.lstrip('-')}"
        if low != -high:
            allowed = f"{amount(low, unit)} to {amount(high, unit)}"
        what = f"{name.format(found)}, allowed is {allowed}"
        record = ConstraintFailure(value, low, high)
        return row, Violation(what, float(excess[row, worst]), record)

    def violation(self, positions: FloatArray) -> Violation | None:
        """The one that is broken most at group positions, or None."""
        found = self.first_violation(np.asarray(positions, dtype=float)[None])
        return None if found is None else found[1]

    def solutions(
        self,
        found: Sequence[FloatArray],
        goal: Goal,
        checker: MotionChecker,
        start: FloatArray,
        seed: int,
    ) -> list[FloatArray]:
        """Those of free positions at a goal that satisfy the constraints.

        A position leaves the orientation open: where none does, positions are projected to the
        goal and the constraints, from those found and from random ones, least effort first.
        """
        kept = [positions for positions in found if self.hold(positions)]
        if kept or not isinstance(goal, PositionGoal) or goal.pitch is not None:
            return kept
        side = 2 * goal.position_tolerance / np.sqrt(3)
        at_goal = self.at(PositionBox(goal.link, SE3(np.eye(3), goal.position), (side, side, side)))
        rng, space = np.random.default_rng(seed % 2**63), self.space
        drawn = (random_positions(space, rng) for _ in range(PROJECTIONS))
        for begin in chain(found, drawn):
            positions = at_goal.project(begin)
            if positions is not None and checker.state_free(positions):
                kept.append(positions)
            if len(kept) == MOST_GOALS:
                break
        return sorted(kept, key=lambda positions: round(space.effort(start, positions), 9))

    def project(self, positions: FloatArray) -> FloatArray | None:
        """The state nearby that is well inside all constraints; None when there is no way to it.

        Gauss and Newton's method on what is beyond the inner bounds, `LIMIT_MARGIN` away from the
        joint limits.
        """
        q: FloatArray = np.array(positions, dtype=float)
        for _ in range(_ITERATIONS):
            values = self._values_at(q)
            off = values - np.clip(values, self._inner_lower, self._inner_upper)
            is_off = np.abs(off) > self._slack
            if not is_off.any():
                return q
            broken = off != 0
            rates = self._rates()[broken]
            normal = rates @ rates.T
            normal.flat[:: len(normal) + 1] += _DAMPING
            step = rates.T @ np.linalg.solve(normal, off[broken])
            q = np.minimum(np.maximum(q - step, self._least), self._most)
        return None

    def _excess(self, values: FloatArray) -> FloatArray:
        return np.maximum(self.lower - values, values - self.upper)

    def _values_at(self, positions: FloatArray) -> FloatArray:
        """Values at one state, shape (m,), of which `_rates` are the derivatives."""
        self.checks += 1
        robot = self.space.robot
        pin.computeJointJacobians(robot.model, robot.data, self.space.configuration(positions))
        parts: list[FloatArray] = []
        for measure, link, offset in self._measured:
            pose = pin.updateFramePlacement(robot.model, robot.data, robot.frame_id(link))
            rotation, place = pose.rotation, pose.translation
            place = place + rotation @ offset.translation
            parts.append(measure.values(((rotation @ offset.rotation)[None], place[None]))[0])
        return np.concatenate([*parts, positions[self._joints]])

    def _rates(self) -> FloatArray:
        """The derivative of the last `_values_at` by the group's positions, shape (m, dof)."""
        robot = self.space.robot
        parts: list[FloatArray] = []
        for measure, link, offset in self._measured:
            frame = robot.frame_id(link)
            whole = pin.getFrameJacobian(
                robot.model, robot.data, frame, pin.LOCAL_WORLD_ALIGNED
            ).reshape(6, -1)
            jacobian, rotation = self.space.jacobian(whole), robot.data.oMf[frame].rotation
            if offset.translation.any():
                jacobian[:3] += np.cross(jacobian[3:].T, rotation @ offset.translation).T
            parts.append(measure.rates(jacobian, rotation @ offset.rotation))
        return np.vstack([*parts, np.eye(self.space.dof)[self._joints]])


def _turned(band: OrientationBand) -> _Turn | _Tilt:
    axis, tolerance = free_axis(band.tolerance), band.tolerance
    if axis is not None and tolerance[axis - 1] == tolerance[axis - 2]:
        return _Tilt(band, axis)
    return _Turn(band)


def _turn_rates(turn: FloatArray, tolerance: Sequence[float]) -> FloatArray:
    """Derivative of a turn, by the angular velocity in the middle's axes."""
    rotation = pin.exp3(turn)
    rates: FloatArray = pin.Jlog3(rotation).T
    axis = free_axis(tolerance)
    if axis is None:
        return rates
    about = rates @ rotation[:, axis]
    return rates - np.outer(about, rates[axis]) / about[axis]


class _Turn:
    """How a frame is turned about each axis of the middle of its band [rad]."""

    def __init__(self, band: OrientationBand) -> None:
        self._band = band
        self.frame = band.link
        self.names = [(f"{band.link} is turned {{}} about {each}", "rad") for each in "xyz"]
        self.half_widths = [each if each < FREE else np.inf for each in band.tolerance]

    def values(self, poses: Poses) -> FloatArray:
        """The turns, shape (N, 3)."""
        return turns_from(self._band.rotation, poses[0], self._band.tolerance)

    def rates(self, jacobian: FloatArray, rotation: FloatArray) -> FloatArray:
        """Their derivatives by the joints, from the frame's Jacobian in the world's axes."""
        turn = turns_from(self._band.rotation, rotation[None], self._band.tolerance)[0]
        return _turn_rates(turn, self._band.tolerance) @ self._band.rotation.T @ jacobian[3:]


class _Tilt:
    """How far the only free axis of a band is from its middle, whose other tolerances are equal."""

    def __init__(self, band: OrientationBand, axis: int) -> None:
        self._axis, self._middle = axis, band.rotation[:, axis]
        self.frame = band.link
        self.names = [(f"{band.link} is tilted {{}} from {'xyz'[axis]}", "rad")]
        self.half_widths = [band.tolerance[axis - 1]]

    def values(self, poses: Poses) -> FloatArray:
        """The angle [rad], shape (N, 1)."""
        axes = poses[0][:, :, self._axis]
        away = axes - self._middle
        return 2.0 * np.arcsin(np.minimum(0.5 * np.sqrt((away * away).sum(axis=1)), 1.0))[:, None]

    def rates(self, jacobian: FloatArray, rotation: FloatArray) -> FloatArray:
        """Its derivative by the joints, from the frame's Jacobian in the world's axes."""
        x, y, z = self._middle.tolist()
        u, v, w = rotation[:, self._axis].tolist()
        normal = np.array([y * w - z * v, z * u - x * w, x * v - y * u])
        return (normal / max(math.sqrt(normal @ normal), 1e-12) @ jacobian[3:])[None]


class _Offset:
    """Where a frame's origin is in a box."""

    def __init__(self, box: PositionBox) -> None:
        self._box = box
        self.frame = box.link
        off = f"{box.link} is {{}} off the box's middle along "
        self.names = [(off + axis, "m") for axis in "xyz"]
        self.half_widths = [0.5 * size for size in box.size]

    def values(self, poses: Poses) -> FloatArray:
        """The coordinates [m], shape (N, 3)."""
        return (poses[1] - self._box.pose.translation) @ self._box.pose.rotation

    def rates(self, jacobian: FloatArray, _rotation: FloatArray) -> FloatArray:
        """Their derivatives by the joints, from the frame's Jacobian in the world's axes."""
        return self._box.pose.rotation.T @ jacobian[:3]
