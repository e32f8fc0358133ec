"""Shapes of MJCF geoms, with their colour and friction."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.geometry import Rgba
from harness.core.spatial import SE3
from harness.language.files.xml_file import XmlElement
from harness.language.world import FrictionSpec, ShapeSpec
from harness.plugins.formats.mjcf.elements import Elements
from harness.plugins.formats.mjcf_robot.joints import mjcf_pose
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.plain_values import pose_spec, rounded
from harness.plugins.formats.sdf.round_meshes import ellipsoid
from harness.plugins.formats.sdf.values import validated
from harness.robot.mesh_file import SUFFIXES

PLAIN = (0.5, 0.5, 0.5, 1.0)  # MuJoCo's colour of a geom without a colour or a material

SHAPES = ("box", "sphere", "cylinder", "capsule", "ellipsoid", "plane", "mesh")

DRAWN_GROUPS = 3  # MuJoCo draws the geoms of the groups 0 to 2


@dataclass(eq=False)
class GeomReader:
    """Reads the geoms of a compiled scene and collects notes."""

    spec: Any
    model: Any
    folder: Path
    elements: Elements
    notes: Notes

    @cached_property
    def _geoms(self) -> Mapping[int, Any]:
        return {geom.id: geom for geom in self.spec.geoms}

    def name(self, geom: int) -> str:
        """The name of a geom in the file; empty where it has none."""
        return self._geoms[geom].name

    def element(self, geom: int) -> XmlElement:
        """The element of a geom."""
        return self.elements.of(self._geoms[geom], "geom")

    def pose(self, geom: int) -> SE3:
        """T_body_shape of a geom; the frame of a mesh is that of its file."""
        pose = mjcf_pose(self.model.geom_pos[geom], self.model.geom_quat[geom])
        return pose @ self._mesh(geom)[1] if self.kind(geom) == "mesh" else pose

    def touches(self, geom: int) -> bool:
        """Whether a geom can be in contact."""
        masks = int(self.model.geom_contype[geom]), int(self.model.geom_conaffinity[geom])
        return masks != (0, 0)

    def is_drawn(self, geom: int) -> bool:
        """Whether MuJoCo's viewer shows a geom."""
        return int(self.model.geom_group[geom]) < DRAWN_GROUPS and self.color(geom)[3] > 0

    def kind(self, geom: int) -> str:
        """The type of a geom as MJCF writes it."""
        import mujoco

        number = int(self.model.geom_type[geom])
        return mujoco.mjtGeom(number).name.removeprefix("mjGEOM_").lower()

    def shape(self, geom: int, T_object_body: SE3) -> ShapeSpec | None:
        """The shape of a geom on its object; None, with a note, for one that cannot be drawn.

        Raises:
            SpecError: The geom touches and its shape is not supported, or has impossible numbers.
        """
        element = self.element(geom)
        words = self._mesh(geom)[0] if self.kind(geom) == "mesh" else self._solid(geom)
        if words is None:
            if self.touches(geom):
                hint = f"those that touch: {', '.join(SHAPES)}; mesh files: {', '.join(SUFFIXES)}"
                element.refuse(f"this {self.kind(geom)} is not supported", hint)
            self.notes.add(element.place, f"this {self.kind(geom)} is not drawn")
            return None
        pose = T_object_body @ self.pose(geom)
        color = self.color(geom)
        words |= {"name": self.name(geom)[:100] or None, "pose": pose_spec(pose), "color": color}
        if self.touches(geom):
            self._note_masks(geom)
            sliding, torsional, rolling = map(rounded, self.model.geom_friction[geom])
            words["friction"] = FrictionSpec(sliding=sliding, torsional=torsional, rolling=rolling)
        return validated(ShapeSpec, words, element)

    def _note_masks(self, geom: int) -> None:
        if (self.model.geom_contype[geom], self.model.geom_conaffinity[geom]) != (1, 1):
            message = "masks of contype and conaffinity are left out: all objects can touch"
            self.notes.add(self.element(geom).place, message)

    def _solid(self, geom: int) -> dict[str, Any] | None:
        """The geometry of a geom that is not a mesh; None for one that is not supported."""
        x, y, z = (float(size) for size in self.model.geom_size[geom])
        match self.kind(geom):
            case "box":
                return {"box": {"size": (2 * x, 2 * y, 2 * z)}}
            case "sphere":
                return {"sphere": {"radius": x}}
            case "cylinder" | "capsule" as kind:
                return {kind: {"radius": x, "length": 2 * y}}
            case "ellipsoid":
                return {"mesh": ellipsoid((x, y, z))}
            case "plane":
                return {"plane": {}}
            case _:
                return None

    def color(self, geom: int) -> Rgba:
        """The colour of a geom, or of its material where it has none."""
        values, material = self.model.geom_rgba[geom], int(self.model.geom_matid[geom])
        if material >= 0 and np.allclose(values, PLAIN):
            values = self.model.mat_rgba[material]
        red, green, blue, alpha = (round(min(1.0, max(0.0, float(v))), 6) for v in values)
        return red, green, blue, alpha

    def _mesh(self, geom: int) -> tuple[dict[str, Any] | None, SE3]:
        """The mesh of a geom, and the pose of the file's frame in the geom's.

        MuJoCo scales the vertices about `refpos` in the axes of `refquat`, and moves them to the
        centre of mass. Meshes touch as their convex hulls.
        """
        number = int(self.model.geom_dataid[geom])
        asset = self.spec.mesh(self.model.mesh(number).name)
        if asset is None or not asset.file or Path(asset.file).suffix.lower() not in SUFFIXES:
            return None, SE3.identity()
        scale = np.array(asset.scale, dtype=float)
        turn = mjcf_pose(np.zeros(3), asset.refquat).rotation.T
        if not np.allclose(turn, np.eye(3)) and not np.allclose(scale, scale[0]):
            element = self.elements.of(asset, "mesh")
            element.refuse("a mesh with a `refquat` has one scale", "turn the geom instead")
        reference = SE3(turn, -scale * (turn @ np.array(asset.refpos)))
        center = mjcf_pose(self.model.mesh_pos[number], self.model.mesh_quat[number])
        folder = self.folder / (self.spec.meshdir or self.spec.compiler.meshdir or "")
        x, y, z = (float(value) for value in scale)
        words: dict[str, Any] = {
            "file": str((folder / asset.file).resolve()),
            "scale": x if x == y == z else (x, y, z),
        }
        if self.touches(geom):
            words["collision"] = "hull"
        return {"mesh": words}, center.inverse() @ reference
