"""The direction in which a gripper approaches what it grasps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.ports.kinematics import Kinematics
from harness.ports.scene import PlanningScene
from harness.robot.description import RobotDescription
from harness.robot.end_effector import Gripper
from harness.robot.tree import carriers

LEAST_DISTANCE = 0.005  # [m]; two points nearer than this give no direction of a line
FROM_THE_PALM = math.cos(math.radians(60))  # least cosine of the line from palm to TCP
ALONG_AN_AXIS = math.cos(math.radians(20))
"""Cosine down to which a direction is that of an axis of the TCP's frame: origins of palms lie next
to the middle of the hand, and shapes are not symmetrical."""


def approach_axis(
    description: RobotDescription, kinematics: Kinematics, scene: PlanningScene, state: FloatArray
) -> FloatArray:
    """The approach axis of an arm's gripper in the TCP frame, shape (3,).

    It is the `approach_axis` of a robot.yaml, of whatever length, else the axis of the TCP's frame
    that leads from the palm to the pads. Where none does, as the hand is mounted obliquely, it is
    the line from the palm's origin to the TCP; from the palm's body to the pads where that origin
    is elsewhere, as at the fingertips.

    Args:
        state: Positions of the whole robot in description order, with the hand open.
    """
    gripper = description.gripper
    if gripper is None:
        raise ValueError(f"'{description.name}' has no gripper")
    if gripper.approach_axis is not None:
        return gripper.approach_axis
    world_to_tcp = kinematics.link_pose(state, description.tcp_link).inverse()

    def in_tcp(link: str) -> SE3:
        return world_to_tcp @ kinematics.link_pose(state, link)

    origins = -in_tcp(gripper.palm_link).translation
    bodies = _from_palm_to_pads(description, gripper, scene, in_tcp)
    length = float(np.linalg.norm(origins))
    if bodies is None:
        direction = origins / length if length else np.array([0.0, 0.0, 1.0])
    elif length >= LEAST_DISTANCE and origins @ bodies >= FROM_THE_PALM * length:
        direction = origins / length
    else:
        direction = bodies
    largest = int(np.abs(direction).argmax())
    if abs(direction[largest]) < ALONG_AN_AXIS:
        return direction
    return np.sign(direction[largest]) * np.eye(3)[largest]


def _from_palm_to_pads(
    description: RobotDescription,
    gripper: Gripper,
    scene: PlanningScene,
    in_tcp: Callable[[str], SE3],
) -> FloatArray | None:
    """Unit direction from the palm's shapes to those of the pads; None where they are in one place.

    A palm without shapes, or one that is a pad itself, is where the last joint before it is.
    """
    pads = [in_tcp(pad).apply(scene.corners(pad)).mean(axis=0) for pad in gripper.pads.values()]
    target = np.zeros(3) if gripper.has_single_jaw else np.mean(pads, axis=0)
    for point in _points_of_palm(description, gripper, scene, in_tcp):
        away = target - point
        if np.linalg.norm(away) >= LEAST_DISTANCE:
            return away / np.linalg.norm(away)
    return None


def _points_of_palm(
    description: RobotDescription,
    gripper: Gripper,
    scene: PlanningScene,
    in_tcp: Callable[[str], SE3],
) -> Iterator[FloatArray]:
    palm = gripper.palm_link
    has_shapes = any(link.name == palm and link.collisions for link in description.links)
    if has_shapes and not gripper.has_single_jaw:
        yield in_tcp(palm).apply(scene.corners(palm)).mean(axis=0)
    if palm not in description.static_links:
        yield in_tcp(carriers(description.joints, "world")[palm]).translation
