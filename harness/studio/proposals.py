"""Expectations that hold in the state of the cell, as text for the scenario."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.studio.judging import judged
from harness.studio.live_cell import LiveCell
from harness.studio.step_texts import step_text

AT_A_STATE = 0.01
"""Largest difference of a joint from a named state [rad or m]."""

PRESSED = 0.05
"""Smallest force with which a finger side holds an object [N]."""

MOVED = 0.005
"""Largest distance from its start at which an object counts as not moved [m]."""

UPRIGHT = 0.1
"""Largest angle from the vertical at which an object stands upright [rad]."""


@dataclass(frozen=True)
class Proposal:
    """An expectation that holds now.

    Attributes:
        text: It, as a scenario has it.
        why: The observation that it states.
    """

    text: str
    why: str


def proposals(cell: LiveCell) -> list[Proposal]:
    """Expectations of what is seen, each with a tolerance that a repetition keeps."""
    return [*_about_robot(cell), *_about_objects(cell)]


def holding(cell: LiveCell, proposed: list[Proposal]) -> list[Proposal]:
    """Those of the proposals that the judge of a run lets pass on the last step executed."""
    step = cell.steps_done - 1
    if step < 0 or not proposed:
        return []
    document = cell.document.with_expectations([each.text for each in proposed], step)
    name = cell.execution.program.steps[step].id
    verdicts = [each for each in judged(cell, document).verdicts if each.step == name]
    passed = [each.status == "passed" for each in verdicts[-len(proposed) :]]
    return [each for each, is_kept in zip(proposed, passed, strict=True) if is_kept]


def _about_robot(cell: LiveCell) -> list[Proposal]:
    description, positions = cell.description, cell.joint_positions()
    found: list[Proposal] = []
    state = named_state_at(cell)
    if state:
        found.append(Proposal(step_text("named_target", state), f"the arm is at '{state}'"))
    elif description.arm_group:
        pose = cell.tcp_pose()
        keys = {
            "pose": {
                "xyz": [round(float(value), 4) for value in pose.translation],
                "quat_wxyz": [round(float(value), 4) for value in pose.as_vector()[3:]],
            },
            "tolerance": {"position": "3 mm", "orientation": "1 deg"},
        }
        found.append(Proposal(step_text("tcp_pose", keys), "the TCP stands there"))
    gripper = description.gripper
    if gripper is not None:
        value = float(positions[description.joint_index[gripper.joint]])
        for name, each in description.states_of(gripper.group).items():
            if abs(each.positions.get(gripper.joint, np.inf) - value) < 2 * AT_A_STATE:
                found.append(Proposal(step_text("gripper", name), f"the gripper is '{name}'"))
                break
    return found


def _about_objects(cell: LiveCell) -> list[Proposal]:
    found: list[Proposal] = []
    forces = cell.simulator.contact_forces()
    for name, pose in cell.object_poses().items():
        obj = cell.cell.presence[name].obj
        if obj.is_static or not obj.in_simulation:
            continue
        start = cell.cell.presence[name].obj.pose
        if _is_held(cell, name, forces):
            found.append(Proposal(step_text("grasped", name), f"both finger sides press '{name}'"))
            continue
        if start.distance_to(pose)[0] < MOVED:
            continue
        below = _support(cell, name, forces)
        if below:
            vector = [round(float(value), 4) for value in pose.as_vector()]
            place = {"xyz": vector[:3], "quat_wxyz": vector[3:]}
            keys: dict[str, Any] = {"object": name, "on": below, "pose": place}
            keys["tolerance"] = {"position": "5 mm", "orientation": "3 deg"}
            found.append(Proposal(step_text("placed", keys), f"'{name}' stands on '{below}'"))
        tilt = float(np.arccos(np.clip(pose.rotation[2, 2], -1.0, 1.0)))
        if tilt < UPRIGHT:
            found.append(Proposal(step_text("upright", name), f"'{name}' is upright"))
    return found


def named_state_at(cell: LiveCell) -> str:
    """The arm's named state where it stands; empty where there is none."""
    description, positions = cell.description, cell.joint_positions()
    for name, state in description.states_of(description.arm_group).items():
        index = description.joint_index
        if all(
            abs(positions[index[joint]] - value) < AT_A_STATE
            for joint, value in state.positions.items()
        ):
            return name
    return ""


def _is_held(cell: LiveCell, name: str, forces: dict[tuple[str, str], float]) -> bool:
    gripper = cell.description.gripper
    if gripper is None:
        return False
    sides = [
        sum(forces.get((min(link, name), max(link, name)), 0.0) for link in links)
        for links in gripper.sides.values()
    ]
    return len(sides) > 1 and min(sides) > PRESSED


def _support(cell: LiveCell, name: str, forces: dict[tuple[str, str], float]) -> str:
    """The object that carries another one; the lower body of the strongest contact."""
    poses = cell.object_poses()
    carriers = {
        other: force
        for pair, force in forces.items()
        if name in pair
        for other in pair
        if other != name and other in poses
    }
    below = [other for other in carriers if poses[other].translation[2] < _height(cell, name)]
    return max(below, key=lambda other: carriers[other], default="")


def _height(cell: LiveCell, name: str) -> float:
    return float(cell.object_poses()[name].translation[2])
