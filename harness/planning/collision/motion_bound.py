"""How much nearer bodies can come while a group moves, whatever its way."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from harness.core.geometry import Plane
from harness.core.types import FloatArray
from harness.planning.collision.certificates import MovingJoints
from harness.planning.collision.scene import Body, CollisionModel
from harness.planning.model.robot_model import GroupSpace

Point = tuple[float, ...]


def nearing_rates(model: CollisionModel, space: GroupSpace) -> FloatArray:
    """How much nearer the bodies of each pair come at most [m per rad of joint space], shape (P,).

    When a joint between two bodies turns, their nearest points approach each other by its turn
    times the distance of either of them from its axis, at most; the smaller of both counts. Over
    the group's joints that adds up to no more than the joint-space distance times the root of the
    sum of squares (Cauchy and Schwarz).

    Args:
        model: The model of the scene.
        space: The group that moves; its metric measures joint-space distances.
    """
    moving = MovingJoints(space)
    joints = _Joints(moving, space)
    balls = {body.name: _ball(body, model.geometry, moving) for body in model.bodies}
    levers = np.zeros((len(model.pairs), len(moving.columns)))
    for row, pair in enumerate(model.pairs):
        first, second = balls[pair.first], balls[pair.second]
        up, down = joints.between(first.joint, second.joint)
        levers[row, up] = joints.levers(up, first, down, second)
        levers[row, down] = joints.levers(down, second, up, first)
    drives = np.abs(space.matrix[moving.columns]) / space.metric
    return np.linalg.norm(levers @ drives, axis=1)


@dataclass(frozen=True, eq=False)
class _Ball:
    """A ball that holds a body: the moving joint that carries it (-1: none), in its frame [m]."""

    joint: int
    center: Point
    radius: float


def _ball(body: Body, geometry: pin.GeometryModel, moving: MovingJoints) -> _Ball:
    if any(isinstance(shape.geometry, Plane) for shape in body.shapes):
        return _Ball(-1, (0.0, 0.0, 0.0), math.inf)
    pose = moving.body_poses((body,))[0]
    centers: list[FloatArray] = []
    radii: list[float] = []
    for number in body.geometries:
        item = geometry.geometryObjects[number]
        item.geometry.computeLocalAABB()
        center = item.placement.act(np.array(item.geometry.aabb_center).reshape(3))
        centers.append(pose[:9].reshape(3, 3) @ center + pose[9:12])
        radii.append(float(item.geometry.aabb_radius))
    middle = np.mean(centers, axis=0)
    away = np.linalg.norm(np.array(centers) - middle, axis=1) + radii
    return _Ball(moving.above[body.joint], tuple(middle.tolist()), float(away.max()))


class _Joints:
    """The moving joints as levers: lengths of the chains between them."""

    def __init__(self, moving: MovingJoints, space: GroupSpace) -> None:
        self._moving = moving
        chain = moving.chain
        turned = np.einsum("kij,kj->ki", chain[:, :9].reshape(-1, 3, 3), chain[:, 12:15])
        self._places: list[Point] = list(map(tuple, chain[:, 9:12].tolist()))
        self._own_axes: list[Point] = list(map(tuple, chain[:, 12:15].tolist()))
        self._axes: list[Point] = list(map(tuple, turned.tolist()))
        self._slides = (chain[:, 15] > 0).tolist()
        self._slide = [
            _longest_slide(column, space) if slides else 0.0
            for column, slides in zip(moving.columns.tolist(), self._slides, strict=True)
        ]

    def between(self, first: int, second: int) -> tuple[list[int], list[int]]:
        """Joints that move one carrier and not the other, each list towards the base."""
        mine, theirs = self._moving.path(first), self._moving.path(second)
        while mine and theirs and mine[-1] == theirs[-1]:
            mine.pop()
            theirs.pop()
        return mine, theirs

    def levers(self, near: list[int], body: _Ball, far: list[int], other: _Ball) -> list[float]:
        """How far the nearest points of two bodies are from each of the axes that move one of them.

        Args:
            near: The joints that move the body, from it towards what carries both.
            body: The body that the joints move.
            far: The joints that move the other.
            other: The body that it approaches.
        """
        ways = zip(near, self._to_body(near, body), self._to_other(near, far, other), strict=True)
        return [1.0 if self._slides[joint] else min(each) for joint, *each in ways]

    def _to_body(self, joints: list[int], ball: _Ball) -> list[float]:
        """Distance of a carried body's points from the axes that carry it, in their order."""
        found: list[float] = []
        reach = math.hypot(*ball.center) + ball.radius
        for joint in joints:
            found.append(reach)
            reach += math.hypot(*self._places[joint]) + self._slide[joint]
        if joints:
            found[0] = _off_axis(ball.center, self._own_axes[joints[0]]) + ball.radius
        return found

    def _to_other(self, joints: list[int], far: list[int], other: _Ball) -> list[float]:
        """Distance of the other body's points from the same axes, in their order."""
        if not joints:
            return []
        root = joints[-1]
        if far:
            reach = math.dist(self._places[root], self._places[far[-1]]) + self._slide[far[-1]]
            reach += sum(math.hypot(*self._places[each]) + self._slide[each] for each in far[:-1])
            reach += math.hypot(*other.center) + other.radius
            found = [reach]
        else:
            offset = tuple(a - b for a, b in zip(other.center, self._places[root], strict=True))
            reach = math.hypot(*offset) + other.radius
            found = [_off_axis(offset, self._axes[root]) + other.radius]
        for before, joint in zip(joints[:0:-1], joints[-2::-1], strict=True):
            reach += math.hypot(*self._places[joint]) + self._slide[before]
            found.append(reach)
        return found[::-1]


def _off_axis(point: Point, axis: Point) -> float:
    """Distance of a point from an axis through the origin, a unit vector."""
    x, y, z = point
    a, b, c = axis
    return math.hypot(b * z - c * y, c * x - a * z, a * y - b * x)


def _longest_slide(column: int, space: GroupSpace) -> float:
    """How far from zero a prismatic joint comes at most [m]."""
    follows = np.flatnonzero(space.matrix[column])
    ends = np.vstack([space.lower[follows], space.upper[follows]]) * space.matrix[column, follows]
    most, least = ends.max(axis=0).sum(), ends.min(axis=0).sum()
    return float(np.abs(space.offset[column] + np.array([least, most])).max())
