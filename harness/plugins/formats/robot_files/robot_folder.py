"""Writes an imported robot as a robot folder: robot.yaml, URDF and SRDF."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from harness.core.errors import RobotOptionError
from harness.core.geometry import Mesh
from harness.language.scenario import RobotSpec
from harness.plugins.formats.robot_files.import_robot import read_robot
from harness.robot.compose import RobotPart
from harness.robot.load import load_robot
from harness.robot.mechanism import Joint
from harness.robot.srdf.srdf import write_srdf
from harness.robot.urdf.write import package_name, write_urdf

WIDTH = 100  # characters of a line
DIGITS = 10  # of numbers in written files: below a nanometre


@dataclass(frozen=True)
class RobotFolder:
    """The content of a robot folder.

    Attributes:
        name: Name of the robot.
        files: Texts of the files, by name.
        notes: Notes on ignored elements and assumptions.
    """

    name: str
    files: dict[str, str]
    notes: tuple[str, ...]


def robot_folder(spec: RobotSpec, base_dir: Path, folder: Path) -> RobotFolder:
    """The files with which `model: folder` is the same robot as a scenario's `robot:`.

    URDF and SRDF are generated: xacro is rendered, the fingers of a gripper are coupled, its TCP
    frame is added, and pairs and states with unknown names are left out.

    Args:
        spec: A `urdf`, `xacro`, `mjcf` or `sdf` with its `srdf`.
        base_dir: The folder to which its paths are relative.
        folder: The folder of the files, to which paths of meshes are relative.

    Raises:
        SpecError: A file has mistakes.
        RobotError: A file is not found, or an option does not fit it.
    """
    part = read_robot(spec, base_dir)
    if spec.gripper is not None and not part.srdf.has_gripper(spec.gripper):
        raise RobotOptionError(
            "gripper",
            f"the SRDF has no group '{spec.gripper}'; a bundled gripper is named"
            " by the scenario, next to `model`",
        )
    description = load_robot(spec, base_dir)
    name = part.urdf.name or part.name
    outside = [Path(os.path.relpath(each, folder)).as_posix() for each in _outside(part)]
    facts = _facts(part, name, description.joints, outside)
    text = yaml.safe_dump(
        {key: value for key, value in facts.items() if value or key == "robot"},
        sort_keys=False,
        width=WIDTH,
        default_flow_style=None,
        allow_unicode=True,
    )
    notes = [f"#   {note}" for note in description.notes]
    comment = ["# Ignored or assumed:", *notes] if notes else []
    files = {
        "robot.yaml": "\n".join([f"# From {_sources(spec)}", *comment, text]),
        f"{name}.urdf": write_urdf(name, part.urdf.links, part.urdf.joints, folder),
        f"{name}.srdf": write_srdf(name, part.srdf),
    }
    return RobotFolder(name, files, description.notes)


def _sources(spec: RobotSpec) -> str:
    given = (spec.urdf or spec.xacro or spec.mjcf or spec.sdf, spec.srdf)
    return " and ".join(each for each in given if each)


def _facts(
    part: RobotPart, name: str, joints: Iterable[Joint], outside: list[str]
) -> dict[str, Any]:
    """The content of robot.yaml, in the order for readers."""
    facts = part.facts
    gripper = None if facts.gripper is None else facts.gripper.model_dump(mode="json")
    return {
        "robot": name,
        "kind": "arm",
        "urdf": f"{name}.urdf",
        "srdf": f"{name}.srdf",
        "packages": outside,
        "arm_group": facts.arm_group,
        "tcp_link": facts.tcp_link,
        "flange_link": facts.flange_link,
        "ik_solver": facts.ik_solver,
        "start_state": {"joints": dict(facts.start_state.joints or {})},
        "max_acceleration": facts.max_acceleration,
        "joints": {
            joint.name: {
                "max_acceleration": _short(joint.acceleration),
                **({"effort_source": joint.effort_source} if joint.effort_source else {}),
            }
            for joint in joints
            if joint.is_movable
        },
        "gripper": _short(gripper),
    }


def _short(value: Any) -> Any:
    """The value with numbers rounded to ten significant digits, enough for measured ones."""
    match value:
        case dict():
            return {key: _short(item) for key, item in value.items()}
        case list():
            return [_short(item) for item in value]
        case float():
            return float(f"{value:.{DIGITS}g}")
        case _:
            return value


def _outside(part: RobotPart) -> tuple[Path, ...]:
    """Folders of mesh files outside packages, sorted."""
    return tuple(sorted({path.parent for path in _meshes(part) if not package_name(path)}))


def _meshes(part: RobotPart) -> Iterator[Path]:
    for link in part.urdf.links:
        for shape in (*link.visuals, *link.collisions):
            if isinstance(shape.geometry, Mesh):
                yield shape.geometry.path
