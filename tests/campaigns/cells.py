"""Cells of generated scenarios: robots and objects, and the names that steps may say there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

FLOOR = {
    "name": "floor", "box": {"size": [3, 3, 0.1]}, "static": True, "pose": {"xyz": [0, 0, -0.05]},
}  # fmt: skip
EYE = {
    "name": "eye", "pose": {"xyz": [0.5, 0, 0.4]}, "look_at": [0.2, 0, 0],
    "image": {"width": 16, "height": 12},
}  # fmt: skip
COMMON = {
    "scenario": "drawn", "seed": 1, "cameras": [EYE], "planning": {"max_state_checks": 3000},
}  # fmt: skip


@dataclass(frozen=True)
class Cell:
    """Where drawn steps are carried out.

    Attributes:
        head: The keys of the scenario but for its steps and expectations.
        names: Names by the key that has them.
        any_name: Names of every other key.
        begins: Steps that make sense here, with one of which some scenarios begin, so that what
            follows meets a held object, a running belt or an open door.
    """

    head: dict[str, Any]
    names: Mapping[str, tuple[str, ...]]
    any_name: tuple[str, ...]
    begins: tuple[list[dict[str, Any]], ...] = field(default=())


def _box(name: str, size: list[float], xyz: list[float], **more: object) -> dict[str, Any]:
    return {"name": name, "box": {"size": size}, "pose": {"xyz": xyz}, **more}


def _cell(
    robots: Mapping[str, Any],
    objects: list[dict[str, Any]],
    joints: tuple[str, ...],
    links: tuple[str, ...],
    *begins: list[dict[str, Any]],
    **names: tuple[str, ...],
) -> Cell:
    things = tuple(each["name"] for each in objects)
    known = {
        **dict.fromkeys(("object", "objects", "between", "represents", "on", "support"), things),
        **dict.fromkeys(("frame", "relative_to", "link"), ("world", *links, *things)),
        **dict.fromkeys(("named_target", "move_to"), ("home", "up")),
        **dict.fromkeys(("camera", "capture"), ("eye",)),
        "gripper": ("open", "close"),
        "joint": joints,
        "joints": joints,
        "positions": joints,
        "never": ("collision",),
        "always": ("within_limits",),
        **names,
    }
    head = {**COMMON, **robots, "objects": [FLOOR, *objects]}
    others = (*things, *links[:1], "robot", "home", "open", "eye", "added")
    return Cell(head, known, others, begins)


def _touching(*steps: dict[str, Any]) -> dict[str, Any]:
    """Steps in which the gripper may touch what stands there."""
    pairs = [["gripper", "holed"], ["gripper", "peg"], ["peg", "holed"], ["gripper", "floor"]]
    return {"allow_collisions": {"pairs": pairs, "during": list(steps)}}


SMALL = ("joint1", "joint2", "joint3", "joint4")
UR = ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_3_joint")
TABLE = _box("table", [0.1, 0.3, 0.04], [0.25, 0.1, 0.02], static=True)
BLOCK = _box("block", [0.03, 0.03, 0.04], [0.2, -0.1, 0.0199], mass=0.02)
BALL = {
    "name": "ball", "sphere": {"radius": 0.02}, "mass": 0.02, "pose": {"xyz": [0.1, 0.2, 0.0199]},
}  # fmt: skip
BELT = _box("belt", [0.5, 0.12, 0.04], [0.05, 0.2, 0.02], static=True, surface_velocity=0)
PLATE = {
    "name": "plate", "static": True, "cylinder": {"radius": 0.1, "length": 0.02},
    "pose": {"xyz": [0.1, -0.22, 0.01]}, "surface_rotation": 0.2,
}  # fmt: skip
CARTON = _box("carton", [0.2, 0.15, 0.12], [0.4, 0.2, 0.06], mass=1)
SLAB = _box("slab", [0.1, 0.1, 0.03], [0.4, -0.2, 0.015], mass=0.2)
CHEST = {
    "name": "chest", "static": True, "pose": {"xyz": [0.82, 0.12, 0.14]},
    "shapes": [
        {"box": {"size": [0.30, 0.36, 0.02]}, "pose": {"xyz": [0, 0, 0.11]}},
        {"box": {"size": [0.02, 0.32, 0.20]}, "pose": {"xyz": [0.14, 0, 0]}},
    ],
    "joints": [
        {
            "name": "drawer", "slide": {"axis": [-1, 0, 0], "range": [0, 0.22]}, "mass": 0.8,
            "shapes": [
                {"box": {"size": [0.02, 0.34, 0.18]}, "pose": {"xyz": [-0.16, 0, 0]}},
                {
                    "name": "handle", "box": {"size": [0.02, 0.12, 0.02]},
                    "pose": {"xyz": [-0.22, 0, 0.04]},
                },
            ],
        },
        {
            "name": "lid", "mass": 0.3,
            "hinge": {"axis": [0, 1, 0], "at": [0.15, 0, 0.13], "range": [0, 1.5], "start": 0.5},
            "shapes": [{"box": {"size": [0.30, 0.36, 0.01]}, "pose": {"xyz": [0, 0, 0.13]}}],
        },
    ],
}  # fmt: skip
HOLE = {"diameter": 0.0202, "depth": 0.04}
HOLED = {
    "name": "holed", "static": True, "box": {"size": [0.08, 0.08, 0.05], "hole": HOLE},
    "friction": 0.1, "pose": {"xyz": [0.5, 0.1, 0.025]},
}  # fmt: skip
PEG = {
    "name": "peg", "cylinder": {"radius": 0.01, "length": 0.08}, "mass": 0.1,
    "pose": {"xyz": [0.5, -0.15, 0.0399]},
}  # fmt: skip
DOWN = {"xyz": [0, 0, -1]}
TOUCH = {"direction": DOWN, "contact": True, "max_distance": 0.1, "speed": 0.02}
PRESS = {"direction": DOWN, "force": 20, "max_distance": 0.01, "speed": 0.005}
YIELD = {"stiffness": {"x": 8000, "y": 8000}, "wrench": {"z": -10}}
LIFT = {"direction": {"xyz": [0, 0, 1]}, "distance": 0.02}
ABOVE = {"pose": {"xyz": [0.5, 0.1, 0.12], "rpy": [3.14159, 0, 0]}}
LEFT_AND_RIGHT = {
    side: {"model": "open_manipulator_x", "base": {"xyz": [0, y, 0]}}
    for side, y in (("left", 0.15), ("right", -0.15))
}

CELLS = {
    "desk": _cell(
        {"robot": "open_manipulator_x"}, [TABLE, BLOCK, BALL], SMALL,
        ("link1", "link5", "end_effector_link"),
        [{"pick": "block"}], [{"attach_object": {"object": "block", "link": "link5"}}],
        [{"pick": "block"}, {"place": {"on": "table"}}],
    ),
    "belt": _cell(
        {"robot": "open_manipulator_x"},
        [BELT, PLATE, _box("can", [0.03, 0.03, 0.04], [0.0, 0.2, 0.0599], mass=0.02), BLOCK],
        SMALL, ("link5", "end_effector_link"),
        [{"conveyor": {"object": "belt", "velocity": 0.03}}],
        [{"conveyor": {"object": "plate", "rotation": 0.5}}],
        [{"conveyor": {"object": "belt", "velocity": 0.03}}, {"pick": "can"}],
    ),
    "cups": _cell(
        {"robot": {"model": "ur3e", "gripper": "suction_cup"}}, [CARTON, SLAB], UR,
        ("tool0", "wrist_3_link"),
        [{"pick": "slab"}], [{"gripper": "on"}], [{"pick": "slab"}, {"place": {"on": "carton"}}],
        gripper=("on", "off"),
    ),
    "chest": _cell(
        {"robot": {"model": "ur5e", "gripper": "rh_p12_rn_a"}}, [CHEST], UR,
        ("tool0", "wrist_3_link"),
        [{"open": {"object": "chest", "joint": "drawer", "to": 0.1}}], [{"wait": 0.02}],
        joint=("drawer", "lid", UR[0]),
    ),
    "wrist": _cell(
        {
            "robot": {
                "model": "ur5e", "gripper": "rh_p12_rn_a",
                "wrench_sensors": {"wrist": "rh_p12_rn_base"},
            }
        },
        [HOLED, PEG], UR, ("tool0", "wrist_3_link"),
        [{"move_to": ABOVE}, {"tare": "wrist"}, _touching({"move_until": TOUCH})],
        [
            {"move_to": ABOVE},
            _touching({"move_until": TOUCH}, {"move_until": PRESS}, {"wait": 0.02}),
        ],
        [
            {"pick": {"object": "peg", "max_effort": 8}},
            _touching({"comply": {**YIELD, "during": [{"wait": 0.05}]}}),
        ],
        [{"gripper": "close"}, {"comply": {**YIELD, "during": [{"move_relative": LIFT}]}}],
        sensor=("wrist",), tare=("wrist",), peg=("peg",), hole=("holed",),
    ),
    "two arms": _cell(
        {"robots": LEFT_AND_RIGHT}, [TABLE, BLOCK, BALL],
        tuple(f"{side}_{joint}" for side in LEFT_AND_RIGHT for joint in SMALL[:2]),
        ("left_link5", "right_end_effector_link"),
        [{"pick": "block", "robot": "right"}],
        [{"parallel": [{"move_to": "home", "robot": side} for side in LEFT_AND_RIGHT]}],
        [
            {"pick": "block", "robot": "right"},
            {"parallel": [{"move_to": "home", "robot": side} for side in LEFT_AND_RIGHT]},
        ],
        by=("left", "right"), robot=("left", "right"), group=("left", "right"),
    ),
}  # fmt: skip
"""Cells by name; the number of a scenario chooses one after the other."""
