"""What a recording lacks, in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from harness.core.types import BoolArray
from harness.plugins.grading.bag.content import BagContent, BagTopics
from harness.plugins.grading.bag.events import StepInterval, is_present
from harness.plugins.grading.bag.message_files import bag_error
from harness.recording.signals import Signals


def gaps(
    joints: Sequence[str],
    movable: Sequence[str],
    signals: Signals,
    present: Mapping[str, Sequence[StepInterval]],
) -> list[str]:
    """Messages about gaps in joints and objects.

    Args:
        joints: Names of the joints, by column.
        movable: Names of the objects that may move.
        present: When each object is in the scene, by name.
    """
    messages: list[str] = []
    unknown: BoolArray = np.isnan(signals.joint_positions)
    spans = np.diff(signals.times)
    is_lost = np.all(unknown, axis=0).tolist()
    without = [name for name, gone in zip(joints, is_lost, strict=True) if gone]
    if without:
        messages.append(f"the recording lacks the joints {', '.join(without)}")
    for column, name in enumerate(joints):
        gone = unknown[:, column]
        if gone.any() and name not in without:
            messages.append(f"{name} has a gap that begins at t={signals.times[gone][0]:.3f} s")
    for name, poses in sorted(signals.object_poses.items()):
        there = is_present(present[name], signals.times)
        gone = np.isnan(poses[:, 0]) & there
        if gone.any():
            lost, whole = ((each[1:] & there[:-1] & there[1:]) @ spans for each in (gone, there))
            share = 100 * float(lost / max(whole, spans.min()))
            first = signals.times[gone][0]
            messages.append(
                f"{name}: no pose for {share:.0f} % of the time, first at t={first:.3f} s"
            )
    never = [name for name in movable if name not in signals.object_poses]
    if never:
        messages.append(f"the recording lacks poses of {', '.join(never)}")
    return messages


def no_joints(
    path: Path, topics: BagTopics, content: BagContent, expected: Sequence[str]
) -> Exception:
    """The error of a recording without the expected joints; names those that it has."""
    if content.joints:
        seen = sorted({name for names in content.joints for name in names})
        prefixed = [name for name in seen if expected and name.endswith(expected[0])]
        prefix = prefixed[0].removesuffix(expected[0]) if prefixed else ""
        hint = f"expected: {', '.join(expected)}; --joint NAME=RECORDED names one"
        return bag_error(
            path,
            f"{topics.joint_states} names none of the robot's joints, but {', '.join(seen[:12])}",
            f"--joint-prefix {prefix}" if prefix else hint,
        )
    others = [n for n, (kind, _) in sorted(content.topics.items()) if kind.endswith("/JointState")]
    if others:
        hint = f"topics of joint states: {', '.join(others)} (--joint-states TOPIC)"
    else:
        hint = (
            f"its topics: {', '.join(sorted(content.topics)[:20])}"
            if content.topics
            else "it has no messages"
        )
    return bag_error(path, f"has no {topics.joint_states} and no frames of this robot in /tf", hint)
