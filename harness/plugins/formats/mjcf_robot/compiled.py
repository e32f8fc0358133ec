"""Compiles an MJCF file with MuJoCo, without what pictures alone need."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.core.errors import Problem, SpecError
from harness.language.files.source import Source
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.mjcf_robot.files import missing_meshes
from harness.robot.packages import PackagePath

WEIGHTLESS = "give its geoms a `mass` or a `density` above 0, or the body an `inertial`"


def compile_mjcf(
    path: Path, roots: Sequence[XmlElement], packages: PackagePath, notes: list[str]
) -> tuple[Any, Any]:
    """The MjSpec and the MjModel of a file.

    Args:
        path: The path of the file.
        roots: What `read_tree` reads of it.
        packages: The folders that may be read.
        notes: Collects a note on meshes that are not drawn.

    Raises:
        SpecError: MuJoCo refuses it, or a mesh that touches cannot be read; at line and column
            where known.
    """
    import mujoco  # here: robots and worlds of other formats do not need it

    try:
        spec = mujoco.MjSpec.from_file(str(path))
        _remove_looks(spec)
        folder = path.parent / (spec.meshdir or "")
        _remove_missing(spec, missing_meshes(roots, folder, packages), notes)
        return spec, spec.compile()
    except ValueError as error:
        raise SpecError([_problem(str(error), roots[0], path)]) from error


def driven_trees(model: Any) -> set[int]:
    """Bodies on the world that carry a joint that an actuator moves."""
    import mujoco

    data = mujoco.MjData(model)
    for stage in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_tendon, mujoco.mj_transmission):
        stage(model, data)
    first, count = data.moment_rowadr, data.moment_rownnz
    moved = [data.moment_colind[first[k] : first[k] + count[k]] for k in range(model.nu)]
    trees = model.body_rootid[model.dof_bodyid]
    return {int(trees[dof]) for dofs in moved for dof in dofs}


def _remove_looks(spec: Any) -> None:
    """Remove textures, and lights with one, and skins: colours are plain, files may be missing."""
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for look in [*spec.textures, *spec.skins, *(each for each in spec.lights if each.texture)]:
        spec.delete(look)


def _remove_missing(spec: Any, missing: Mapping[str, SpecError], notes: list[str]) -> None:
    """Remove meshes that cannot be read and the geoms that show them.

    Raises:
        SpecError: A geom that touches has such a mesh.
    """
    touching = {geom.meshname for geom in spec.geoms if geom.contype or geom.conaffinity}
    if wrong := [missing[name] for name in missing if name in touching]:
        raise SpecError([problem for error in wrong for problem in error.problems])
    shown = [geom for geom in spec.geoms if geom.meshname in missing]
    for unread in (*shown, *(mesh for mesh in spec.meshes if mesh.name in missing)):
        spec.delete(unread)
    if missing:
        reason = next(iter(missing.values())).problems[0].message
        notes.append(f"meshes that are not drawn: {', '.join(missing)}; the first: {reason}")


def _problem(message: str, root: XmlElement, path: Path) -> Problem:
    """MuJoCo's message with the element, at the line that it names."""
    lines = [line for line in message.splitlines() if line.strip()]
    text = lines[0].removeprefix("Error: ").removeprefix("XML Error: ")
    named = re.search(r"Element name '([^']+)'", message)
    text += f": '{named[1]}'" if named else ""
    found = re.search(r"line (\d+)", message)
    source: Source = root.place.source
    line = int(found[1]) if found else 0
    excerpt = source.line(line)
    column = len(excerpt) - len(excerpt.lstrip()) + 1 if line else 0
    hint = WEIGHTLESS if "mjMINVAL" in text else ""
    return Problem(str(path), line, column, f"MuJoCo: {text}", hint, excerpt)
