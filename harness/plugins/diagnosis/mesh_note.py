"""Explains where a collision may come from the convex shape of a mesh, not from the mesh itself."""

from __future__ import annotations

from collections.abc import Sequence

from harness.core.geometry import Mesh, Shape
from harness.planning.collision.scene import CoalScene
from harness.planning.collision.wording import length_text
from harness.recording.goal_failures import TouchRecord
from harness.robot.mesh_file import decomposition_of


def mesh_note(touches: Sequence[TouchRecord], padding: float, scene: CoalScene) -> str:
    """A sentence on the first pair that may be farther apart as meshes; empty where none can be.

    A pair may be so where its shapes reach farther beyond their meshes than they are too near.
    """
    for touch in touches:
        bodies = [(name, scene.shapes_of(name)) for name in touch.pair]
        excess = {name: _excess(shapes) for name, shapes in bodies}
        if sum(excess.values()) > padding - touch.distance:
            said = [_said(name, shapes) for name, shapes in bodies if excess[name]]
            return f"this may be due to the shapes that stand for meshes: {', '.join(said)}"
    return ""


def _excess(shapes: Sequence[Shape]) -> float:
    """How far the shapes of a body reach beyond its meshes at most [m]."""
    return max((_mesh_excess(mesh) for mesh in _convex(shapes)), default=0.0)


def _mesh_excess(mesh: Mesh) -> float:
    found = decomposition_of(mesh)
    return found.hull_excess if mesh.collision == "hull" else found.excess


def _convex(shapes: Sequence[Shape]) -> list[Mesh]:
    meshes = [shape.geometry for shape in shapes if isinstance(shape.geometry, Mesh)]
    return [mesh for mesh in meshes if mesh.collision in ("hull", "parts")]


def _said(name: str, shapes: Sequence[Shape]) -> str:
    worst = max(_convex(shapes), key=_mesh_excess)
    count = len(decomposition_of(worst).parts)
    other = "`parts` or `exact`" if worst.collision == "hull" else "`exact`"
    kind = "its convex hull" if count == 1 else f"{count} convex parts"
    return (
        f"{name} collides as {kind}, at most {length_text(_mesh_excess(worst))} larger than the "
        f"mesh (a `collision` of {other} is closer)"
    )
