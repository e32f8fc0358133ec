"""add_object, remove_object, move_object, clear_objects."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.engine.registry import execute
from harness.spec.steps import AddObject, ClearObjects, MoveObject, RemoveObject


@execute.handles(AddObject)
def add_object(step: AddObject, cell: Cell) -> None:
    """Add objects to the planning scene, the physics, or both."""
    for spec in step.objects:
        presence = cell.presence.get(spec.name)
        if presence is not None and presence.is_there:
            raise StepFailed("INVALID_OBJECT_NAME", f"'{spec.name}' is in the scene already")
        cell.add_to_scene(cell.later_objects[spec.name], cell.world_pose(spec.pose))


@execute.handles(RemoveObject)
def remove_object(step: RemoveObject, cell: Cell) -> None:
    """Take objects out."""
    for name in step.objects:
        cell.remove_from_scene(name)


@execute.handles(MoveObject)
def move_object(step: MoveObject, cell: Cell) -> None:
    """Put an object somewhere else, at rest, in planning scene and physics."""
    cell.move_in_scene(step.object, cell.world_pose(step.pose))
    cell.notes.result["moved"] = [step.object]


@execute.handles(ClearObjects)
def clear_objects(step: ClearObjects, cell: Cell) -> None:
    """Remove what steps added, and with `world` all; what is attached stays, as in MoveIt."""
    attached = cell.scene.attached()
    there = [name for name, presence in cell.presence.items() if presence.is_there]
    gone = [
        name
        for name in there
        if name not in attached and (step.world or cell.presence[name].added_by_step)
    ]
    for name in gone:
        cell.remove_from_scene(name)
