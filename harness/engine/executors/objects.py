"""add_object, remove_object, move_object, clear_objects."""

from __future__ import annotations

from harness.core.errors import StepFailed
from harness.engine.cell import Cell
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
    cell.notes.result["added"] = [spec.name for spec in step.objects]


@execute.handles(RemoveObject)
def remove_object(step: RemoveObject, cell: Cell) -> None:
    """Take objects out."""
    for name in step.objects:
        cell.remove_from_scene(name)
    cell.notes.result["removed"] = list(step.objects)


@execute.handles(MoveObject)
def move_object(step: MoveObject, cell: Cell) -> None:
    """Put an object somewhere else, at rest, in planning scene and physics."""
    presence = cell.presence.get(step.object)
    if presence is None or not presence.is_there:
        raise StepFailed("INVALID_OBJECT_NAME", f"'{step.object}' is not in the scene now")
    if step.object in cell.scene.attached():
        raise StepFailed("INVALID_OBJECT_NAME", f"'{step.object}' is attached: detach it first")
    pose = cell.world_pose(step.pose)
    presence.pose = pose
    if presence.obj.in_simulation:
        cell.simulator.move_object(step.object, pose)
    if step.object in cell.scene.object_names():
        cell.scene.move_object(step.object, pose)


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
    cell.notes.result["removed"] = gone
