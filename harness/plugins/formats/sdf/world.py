"""Imports SDF worlds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.errors import Problem
from harness.language.base import SMALLEST_SIZE
from harness.language.cameras import CameraSpec
from harness.language.files.xml_file import XmlElement
from harness.language.world import LightSpec, ObjectSpec, PhysicsSpec, WorldSpec
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.plain_values import pose_spec, rounded
from harness.plugins.formats.sdf.bodies import SdfBody, bodies_of
from harness.plugins.formats.sdf.cameras import cameras_of
from harness.plugins.formats.sdf.elements import note_unread_elements
from harness.plugins.formats.sdf.model_path import MissingFileError, ModelPath
from harness.plugins.formats.sdf.object import LONGEST_NAME, object_of, part_of
from harness.plugins.formats.sdf.shapes import ShapeReader
from harness.plugins.formats.sdf.tree import SdfLight, SdfTree
from harness.plugins.formats.sdf.values import is_flag, is_true, numbers_of, validated
from harness.world.imported import ImportedWorld

SHORTEST_STEP, LONGEST_STEP = 1e-4, 0.02  # [s], as in a world file


def load_sdf(path: Path, folders: Sequence[Path] = ()) -> ImportedWorld:
    """The world of an SDF file.

    Args:
        folders: Folders to search for models and meshes before those of the environment.

    Raises:
        SpecError: A file is not valid SDF; located in the file with the mistake. An object without
            its mesh file is not refused here, since a scenario may replace it.
    """
    model_path = ModelPath(path.parent, folders)
    tree = SdfTree(path, model_path)
    notes = tree.notes
    reader = ShapeReader(model_path, notes)
    objects: list[ObjectSpec] = []
    cameras: list[tuple[str, CameraSpec]] = []
    unusable: list[tuple[str, Problem]] = []
    bodies = bodies_of(tree.world, notes)
    for body in bodies:
        if body.joint is not None:
            continue
        try:
            item = object_of(body, reader)
        except MissingFileError as error:
            unusable += [
                (body.name, replace(problem, hint=_options(problem, body.name)))
                for problem in error.problems
            ]
            dot = {"radius": SMALLEST_SIZE}
            words = {"name": body.name, "pose": pose_spec(body.pose), "static": True, "sphere": dot}
            item = ObjectSpec.model_validate(words)
        objects += [item] if item is not None else []
        found = cameras_of(body, notes, is_there=item is not None)
        cameras += [(body.name, camera) for camera in found]
    objects = _with_parts(objects, bodies, reader)
    lights = [_light(light, tree, notes) for light in tree.lights]
    title = tree.root.get("name").strip()[:100] or path.stem[:100]
    world = WorldSpec(
        world=title,
        objects=tuple(objects),
        cameras=_named_apart(cameras),
        lights=tuple(item for item in lights if item is not None),
        physics=_physics(tree.root, notes),
    )
    return ImportedWorld(world, path, notes.all(), tuple(unusable))


def _with_parts(
    objects: Sequence[ObjectSpec], bodies: Sequence[SdfBody], reader: ShapeReader
) -> list[ObjectSpec]:
    """The objects, with the bodies that hang on them as their joints."""
    whole = {item.name: item for item in objects}
    carriers = {link.name: body for body in bodies for link in body.links}
    for body in (body for body in bodies if body.joint is not None):
        joint = body.joint
        assert joint is not None  # of these bodies
        carrier = carriers.get(joint.parent)
        carrier = carrier if carrier is not None and carrier.name in whole else body
        part = part_of(body, joint, carrier.pose, reader)
        if part is None:
            continue
        words: dict[str, Any] = {
            "name": carrier.name,
            "pose": pose_spec(carrier.pose),
            "static": True,
        }
        item = whole.get(carrier.name) or ObjectSpec.model_construct(**words)
        whole[carrier.name] = item.model_copy(update={"joints": (*item.joints, part)})
    return list(whole.values())


def _options(problem: Problem, name: str) -> str:
    """What helps against a missing mesh."""
    other = f"put another object in its place: `name: {name}` with `replace: true` in `objects`"
    return f"{problem.hint}; or {other}" if problem.hint else other


def _named_apart(cameras: Sequence[tuple[str, CameraSpec]]) -> tuple[CameraSpec, ...]:
    """The cameras; equal names get their object's name as a prefix."""
    counts = Counter(camera.name for _, camera in cameras)
    return tuple(
        camera
        if counts[camera.name] == 1
        else camera.model_copy(update={"name": f"{body}::{camera.name}"[-LONGEST_NAME:]})
        for body, camera in cameras
    )


def _physics(root: XmlElement, notes: Notes) -> PhysicsSpec:
    profiles = root.findall("physics")
    chosen = [item for item in profiles if is_true(item, item.get("default", "false"))]
    physics = next(iter(chosen or profiles), None)
    words: dict[str, object] = {}
    gravity = root.find("gravity")
    if physics is not None:
        note_unread_elements(physics, "physics", notes)
        for other in profiles:
            if other is not physics:
                notes.add(other.place, "another <physics> is left out")
        step = physics.find("max_step_size")
        if step is not None:
            (value,) = numbers_of(step, 1)
            if value <= 0:
                step.refuse(f"a physics step is longer than 0 s, not {value:g} s")
            if SHORTEST_STEP <= value <= LONGEST_STEP:
                words["timestep"] = value
            else:
                supported = f"{SHORTEST_STEP:g} to {LONGEST_STEP:g} s are supported"
                taken = PhysicsSpec().timestep
                notes.add(step.place, f"a step of {value:g} s is taken as {taken:g} s: {supported}")
        gravity = gravity or physics.find("gravity")
    if gravity is not None:
        words["gravity"] = numbers_of(gravity, 3)
    return validated(PhysicsSpec, words, root)


def _light(light: SdfLight, tree: SdfTree, notes: Notes) -> LightSpec | None:
    """A directional light; None for other lights and for lights that are off."""
    element = light.element
    note_unread_elements(element, "light", notes)
    kind = element.get("type", "point").strip()
    if kind != "directional":
        notes.add(element.place, f"a {kind} light is left out: pictures have directional ones")
        return None
    if not is_flag(element, "light_on", default=True):
        return None
    given = element.find("direction")
    direction = np.array((0.0, 0.0, -1.0) if given is None else numbers_of(given, 3))
    if given is not None and not direction.any():
        given.refuse("a direction must not be 0 0 0")
    x, y, z = (rounded(v) for v in tree.world.pose_in(light.pose).rotation @ direction)
    diffuse = element.find("diffuse")
    color = (1.0, 1.0, 1.0, 1.0)
    if diffuse is not None:
        count = 3 if len(diffuse.text.split()) == 3 else 4
        values = (*(min(1.0, max(0.0, part)) for part in numbers_of(diffuse, count)), 1.0)
        color = (values[0], values[1], values[2], values[3])
    return LightSpec(
        direction=(x, y, z), diffuse=color, casts_shadow=is_flag(element, "cast_shadows")
    )
