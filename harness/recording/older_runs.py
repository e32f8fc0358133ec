"""Runs of older formats of run.json, as the present format has them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

from harness.core.spatial import SE3

FORMAT = "armharness-run/3"
KNOWN_FORMATS = ("armharness-run/1", "armharness-run/2", FORMAT)

STEP_STATUS = {"not_reached": "not reached", "expected_error": "expected error"}
"""Status of a step in the first format, and since."""

STAGE_STATUS = {"not reached": "skipped"}
"""Status of a stage of planning in the first format, and since."""


def in_present_form(document: dict[str, Any]) -> dict[str, Any]:
    """A run or a result, as plain data, in the form of the present format.

    What fits no format is left unchanged: reading it reports that.
    """
    robot = document.get("robot")
    if isinstance(robot, dict) and "placements" in robot:
        try:
            document = {**document, "robot": _described(cast("dict[str, Any]", robot))}
        except (AttributeError, IndexError, KeyError, TypeError, ValueError):
            return document
    steps = document.get("steps")
    if not isinstance(steps, list):
        return document
    return {**document, "steps": [_step(each) for each in cast("list[Any]", steps)]}


def _step(step: Any) -> Any:
    if not isinstance(step, dict):
        return step
    present = _with_status(cast("dict[str, Any]", step), STEP_STATUS)
    explanation: Any = present.get("explanation")
    if not isinstance(explanation, dict) or not isinstance(explanation.get("stages"), list):  # pyright: ignore[reportUnknownMemberType]
        return present
    known = cast("dict[str, Any]", explanation)
    stages = [
        _with_status(cast("dict[str, Any]", each), STAGE_STATUS) if isinstance(each, dict) else each
        for each in cast("list[Any]", known["stages"])
    ]
    return {**present, "explanation": {**known, "stages": stages}}


def _with_status(content: dict[str, Any], words: dict[str, str]) -> dict[str, Any]:
    status = content.get("status")
    if not isinstance(status, str) or status not in words:
        return content
    return {**content, "status": words[status]}


def _described(robot: Mapping[str, Any]) -> dict[str, Any]:
    """The robot of the first two formats, which had a form of its own in runs, as a description.

    They have no shapes for collisions: links that something can touch get those of pictures.
    """
    joints = {each["name"]: each for each in robot["joints"]}
    looks, untouched = robot.get("link_visuals", {}), robot.get("shapeless_links", ())
    gripper = robot.get("gripper")
    kept = ("name", "urdf", "srdf", "arm_group", "tcp_link", "base_link")
    return {
        **{key: robot[key] for key in kept if key in robot},
        "links": [
            {
                "name": name,
                "inertial": None,
                "visuals": looks.get(name, []),
                "collisions": [] if name in untouched else looks.get(name, []),
            }
            for name in robot["link_names"]
        ],
        "joints": [_joint(each, joints.get(each["joint"], {})) for each in robot["placements"]],
        "groups": {
            name: {"name": name, "joint_names": names} for name, names in robot["groups"].items()
        },
        "named_states": [
            {"name": name, "group": group, "positions": positions}
            for group, states in robot["named_states"].items()
            for name, positions in states.items()
        ],
        "allowed_collisions": [],
        "gripper": gripper and _gripper(gripper),
        "start_state": {},
    }


def _joint(placement: Mapping[str, Any], limits: Mapping[str, Any]) -> dict[str, Any]:
    pose = SE3.from_vector(placement["pose"])
    return {
        "kind": "fixed",
        **{key: value for key, value in limits.items() if key != "is_mimic"},
        "name": placement["joint"] or f"{placement['link']}_joint",
        "parent": placement["parent"],
        "child": placement["link"],
        "pose": {"rotation": pose.rotation.tolist(), "xyz": pose.translation.tolist()},
        "axis": placement["axis"],
        "mimic": {"joint": placement["joint"]} if limits.get("is_mimic") else None,
    }


def _gripper(gripper: Mapping[str, Any]) -> dict[str, Any]:
    """The gripper, with the first link of each side as its pad and without efforts."""
    pads = {side: links[0] for side, links in gripper["sides"].items() if links}
    return {"pads": pads, "grip_effort": 0.0, "max_effort": 0.0, **gripper}
