"""Damping and friction of mimic joints, at the joints that they follow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from harness.robot.description import Joint


def with_reflected_friction(joints: Sequence[Joint]) -> tuple[Joint, ...]:
    """The joints with the damping and friction of mimic joints moved to the joint they follow.

    A rigid coupling transmits both, so the motion is the same. The physics couples joints by a
    force that it chooses from their inertia, and then integrates damping implicitly: a follower
    whose damping times the time step is much larger than its inertia would hardly obey.
    """
    damping = {joint.name: joint.damping for joint in joints}
    friction = {joint.name: joint.friction for joint in joints}
    for joint in joints:
        if joint.mimic is None:
            continue
        ratio = abs(joint.mimic.multiplier)
        damping[joint.mimic.joint] += ratio**2 * joint.damping
        friction[joint.mimic.joint] += ratio * joint.friction
        damping[joint.name] = friction[joint.name] = 0.0
    return tuple(
        replace(joint, damping=damping[joint.name], friction=friction[joint.name])
        for joint in joints
    )
