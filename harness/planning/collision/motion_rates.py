"""Bounds of how fast the bodies of a pair approach each other, at any configuration."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray
from harness.planning.collision.collision_model import Body, CollisionModel
from harness.planning.model.robot_model import GroupSpace

_LONGEST = 1e6  # Of a lever without a bound [m]


def motion_rates(model: CollisionModel, space: GroupSpace) -> FloatArray:
    """How much nearer each pair comes at most per joint-space distance [m/rad], shape (K,).

    A joint moves a point by its own motion times the longest possible lever: the offsets of the
    joints in between, with the travel of prismatic ones, and the radius of the body.
    """
    robot = space.robot.model
    drive = np.zeros((robot.njoints, space.dof))
    travel = np.zeros(robot.njoints)
    farthest = np.maximum(np.abs(space.lower), np.abs(space.upper))
    for index, joint in enumerate(space.robot.description.movable_joints):
        number, row = robot.getJointId(joint.name), np.abs(space.matrix[index])
        drive[number] = row
        if joint.kind == "prismatic":
            driven = row > 0
            travel[number] = abs(space.offset[index]) + row[driven] @ farthest[driven]
    offsets = [float(np.linalg.norm(pose.translation)) for pose in robot.jointPlacements]

    def levers(body: Body) -> FloatArray:
        found, lever = np.zeros(robot.njoints), _radius(body)
        number = body.rigid.joint
        while number > 0:
            lever += travel[number]
            found[number] = 1.0 if travel[number] else lever
            lever += offsets[number]
            number = robot.parents[number]
        return np.minimum(found, _LONGEST)

    each = np.array([levers(body) for body in model.bodies]).reshape(-1, robot.njoints)
    first, second = each[model.pairs.T]
    apart = np.where((first > 0) != (second > 0), first + second, 0.0)
    return np.linalg.norm(apart @ drive / space.metric, axis=1)


def _radius(body: Body) -> float:
    """How far a body reaches from the origin of its joint; 0 where it stands still [m]."""
    if body.rigid.joint == 0:
        return 0.0
    low, high = np.abs(body.rigid.box).reshape(2, 3)
    return float(np.linalg.norm(np.maximum(low, high)))
