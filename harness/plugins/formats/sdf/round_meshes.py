"""Cones and ellipsoids of SDF: two meshes of this package, scaled."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from harness.language.world import MeshSpec, WorldSpec

FOLDER = Path(__file__).with_name("meshes")
CONE = FOLDER / "cone.stl"  # about z, of radius and length 1, as `stl.cone` makes it
SPHERE = FOLDER / "sphere.stl"  # 1,280 triangles, up to 0.5 % inside a radius of 1


def cone(radius: float, length: float) -> MeshSpec:
    """A cone about z, its tip up, the origin halfway between tip and base [m]."""
    return MeshSpec(file=str(CONE), scale=(radius, radius, length))


def ellipsoid(radii: tuple[float, float, float]) -> MeshSpec:
    """An ellipsoid with these radii along x, y and z [m]."""
    return MeshSpec(file=str(SPHERE), scale=radii)


def round_meshes(world: WorldSpec) -> Iterator[Path]:
    """Those of the two files that a world uses, once for every shape."""
    for item in world.objects:
        for shape in (*item.shapes, *item.visuals, item):
            if shape.mesh is not None and Path(shape.mesh.file).parent == FOLDER:
                yield Path(shape.mesh.file)
