"""Messages to the page, as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from harness.core.amounts import amount
from harness.core.errors import Problem
from harness.core.printable import printable
from harness.plugins.studio.language_help import GRIPPER_TARGET, Names
from harness.plugins.studio.live_cell import LiveCell
from harness.plugins.studio.session import Message
from harness.plugins.studio.texts import MOTIONS, ObjectForm, gripper_steps
from harness.recording.step_record import StepRecord
from harness.reporting.explanation import explanation_lines
from harness.robot.description import RobotDescription

MOST_CONTACTS = 8  # contacts that are listed, strongest first
READ = 0.01  # [s]: the readings of a sensor are their mean over this time


def robot_message(cell: LiveCell) -> Message:
    """What does not change while the cell is the same."""
    from harness.language.reading.load import bundled_worlds
    from harness.planning.search.find_pipeline import planner_names

    description = cell.description
    gripper = description.gripper
    actuated = set(cell.simulator.physics.actuated.tolist())
    return {
        "type": "robot",
        "name": description.name,
        "title": description.name,
        "arms": list(description.of_arm),
        "arm": description.selected_arm,
        "tcp": description.tcp_link,
        "arm_joints": list(description.groups[description.arm_group].joint_names)
        if description.arm_group
        else [],
        "joints": [
            {
                "name": joint.name,
                "label": _label(joint.name, description),
                "lower": max(joint.lower, -2 * np.pi),
                "upper": min(joint.upper, 2 * np.pi),
                "slides": joint.kind == "prismatic",
            }
            for index, joint in enumerate(description.movable_joints)
            if index in actuated
        ],
        "states": list(description.states_of(description.arm_group)),
        "gripper": None
        if gripper is None
        else {
            "steps": gripper_steps(description),
            "narrowest": 0.0 if gripper.cups else float(gripper.widths[:, 1].min()),
            "widest": 0.0 if gripper.cups else float(gripper.widths[:, 1].max()),
        },
        "frames": list(
            dict.fromkeys(
                ["world", description.base_link, *cell.cell.presence, *description.link_names]
            )
        ),
        "objects": [
            {**asdict(form), "half": form.half() if form.kind else None}
            for form in map(ObjectForm.of, cell.document.object_specs())
        ],
        "bodies": list(cell.cell.presence),
        "fixed": [name for name, each in cell.cell.presence.items() if each.obj.is_static],
        "overlaps": [
            f"{touch.first} and {touch.second} overlap by {-1e3 * touch.distance:.1f} mm"
            for touch in cell.simulator.overlaps_at_start
        ],
        "worlds": bundled_worlds(),
        "planners": list(planner_names()),
        "verbs": list(MOTIONS),
        "cameras": list(cell.prepared.program.cameras),
    }


def _label(joint: str, description: RobotDescription) -> str:
    """A joint's name without the name of its arm, and without the word that all have."""
    return joint.removeprefix(f"{description.selected_arm}_").removesuffix("_joint") or joint


def resizable(cell: LiveCell) -> dict[str, ObjectForm]:
    """The objects whose size can still be changed, as the page's fields have them."""
    forms = map(ObjectForm.of, [] if cell.steps_done else cell.document.object_specs())
    return {form.name: form for form in forms if form.kind}


def cell_message(cell: LiveCell) -> Message:
    """The numbers of the cell as it is now."""
    positions = cell.joint_positions()
    contacts = sorted(cell.simulator.contact_forces().items(), key=lambda item: -item[1])
    return {
        "type": "state",
        "time": round(cell.simulator.time, 3),
        "positions": [
            round(float(positions[index]), 5) for index in cell.simulator.physics.actuated
        ],
        "contacts": [[*pair, round(force, 2)] for pair, force in contacts[:MOST_CONTACTS]],
        "readings": _readings(cell),
        "width": _width(cell),
        "steps_done": cell.steps_done,
        "step_count": cell.document.step_count,
        "is_run": cell.is_run,
        "is_by_hand": cell.is_by_hand,
    }


def names_of(cell: LiveCell | None) -> Names:
    """Names that exist in a cell, for completion; without one, the bundled robots and worlds."""
    from harness.language.reading.load import bundled_worlds
    from harness.robot.load import gripper_names, robot_names

    robots = robot_names()
    names = {"world": bundled_worlds(), "robot": robots, "model": robots}
    names["gripper"] = gripper_names()
    if cell is None:
        return names
    description, objects = cell.description, list(cell.cell.presence)
    gripper = description.gripper
    states = list(description.states_of(description.arm_group))
    ends = [] if gripper is None else list(description.states_of(gripper.group))
    links, joints = description.link_names, description.joint_names
    bodies = [*objects, *links]
    named: dict[str, Sequence[str]] = {
        **{"named_target": states, "state": [*states, *ends], GRIPPER_TARGET: ends},
        **dict.fromkeys(("joints", "positions"), joints),
        **dict.fromkeys(("object", "objects"), objects),
        **dict.fromkeys(("link", "tcp_link", "touch_links"), links),
        **dict.fromkeys(("on", "support", "container"), bodies),
        **{"between": ["robot", "gripper", "any", *bodies], "frame": ["world", *bodies]},
        **{"group": list(description.groups), "camera": list(cell.prepared.program.cameras)},
    }
    return names | named


def failure_message(record: StepRecord) -> Message:
    """Why a step failed, with the explanation of a run."""
    return {
        "status": "failed",
        "error": printable(f"{record.error_code}: {record.message}"),
        "explanation": [
            printable(line) for line in explanation_lines(record.explanation, record.message)
        ],
    }


def problem_message(problem: Problem, file: str) -> Message:
    """A mistake with its place in a file; of one in another file, the text has the place."""
    is_here = problem.path == file
    where = "" if is_here else f"{problem.path}:{problem.line}: "
    return {
        "line": problem.line if is_here else 0,
        "column": problem.column,
        "length": problem.length,
        "text": printable(f"{where}{problem.message}"),
        "hint": printable(problem.hint),
    }


def _readings(cell: LiveCell) -> list[tuple[str, str]]:
    """What belts, joints of fixtures and sensors of force and torque show now, with units."""
    shown: list[tuple[str, str]] = []
    poses = cell.object_poses()
    for name, presence in cell.cell.presence.items():
        joint = presence.obj.joint
        if presence.obj.surface_motion is not None:
            shown.append((name, f"surface {cell.simulator.surface_motion(name)}"))
        if joint is not None:
            shown.append((name, amount(joint.position(poses[name]), joint.unit)))
    for name in cell.description.wrench_sensors:
        parts = cell.simulator.wrench(name, READ).reshape(2, 3)
        force, torque = np.linalg.norm(parts, axis=1)
        shown.append((name, f"{amount(force, 'N')}, {amount(torque, 'N*m')}"))
    return shown


def _width(cell: LiveCell) -> float | None:
    gripper = cell.description.gripper
    if gripper is None or gripper.cups:
        return None
    value = cell.joint_positions()[cell.description.joint_index[gripper.joint]]
    rows = gripper.widths[np.argsort(gripper.widths[:, 0])]
    return round(float(np.interp(value, rows[:, 0], rows[:, 1])), 5)
