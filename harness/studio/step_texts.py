"""Steps as text: what the page's buttons do, written as a scenario has it."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.language.goals import GoalFields
from harness.language.step import STEPS
from harness.robot.description import RobotDescription
from harness.studio.document import flow
from harness.studio.reach import WHOLE_POSE_JOINTS, pitch_of

_TO_A_GOAL = {verb: step for verb, step in STEPS.items() if issubclass(step, GoalFields)}

MOTIONS = sorted(_TO_A_GOAL, key=lambda verb: (-len(_TO_A_GOAL[verb].goal_keys), verb))
"""The verbs of motions to a goal, those with the most kinds of goals first."""


def step_text(verb: str, keys: Any) -> str:
    """A step on one line: `move_to: {joints: {...}}`."""
    return f"{verb}: {flow(keys)}"


def pose_keys(description: RobotDescription, group: str, pose: SE3, frame: str) -> dict[str, Any]:
    """The goal keys of a TCP pose in a frame, which the arm's joints are enough for.

    Args:
        description: The description of the robot.
        group: The name of the planning group.
        pose: The pose T_frame_tcp of the TCP.
        frame: The name of the frame.
    """
    place: dict[str, Any] = {} if frame == "world" else {"frame": frame}
    place["xyz"] = [round(float(value), 5) for value in pose.translation]
    if len(description.groups[group].joint_names) < WHOLE_POSE_JOINTS:
        return {"position": place, "pitch": round(pitch_of(pose), 5)}
    w, x, y, z = (float(value) for value in pose.as_vector()[3:])
    place["quat_xyzw"] = [round(value, 6) for value in (x, y, z, w)]
    return {"pose": place}


def joint_keys(description: RobotDescription, group: str, positions: FloatArray) -> dict[str, Any]:
    """The goal keys of joint positions in description order."""
    index = description.joint_index
    names = description.groups[group].joint_names
    return {"joints": {name: round(float(positions[index[name]]), 5) for name in names}}


def gripper_steps(description: RobotDescription) -> dict[str, str]:
    """Steps that move the gripper, by the words of their buttons; `open` and `close` are there.

    A gripper without named states of that kind opens and closes to the ends of its width.
    """
    gripper = description.gripper
    if gripper is None:
        return {}
    steps = {state: f"gripper: {state}" for state in description.states_of(gripper.group)}
    widths = gripper.widths[:, 1]
    narrowest, widest = np.ceil(1e4 * widths.min()) / 1e4, np.floor(1e4 * widths.max()) / 1e4
    closed = next((steps.pop(word) for word in ("closed", "close") if word in steps), None)
    opened = steps.pop("open", None) or step_text("gripper", {"width": float(widest)})
    return {
        "open": opened,
        "close": closed or step_text("gripper", {"width": float(narrowest)}),
        **steps,
    }
