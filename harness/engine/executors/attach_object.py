"""attach_object and detach_object: the planning scene alone, as AttachedCollisionObject."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.engine.registry import execute
from harness.spec.steps import AttachObject, DetachObject


@execute.handles(AttachObject)
def attach_object(step: AttachObject, cell: Cell) -> None:
    """Fix an object to a link; a new object is added to the scene first."""
    cell.sync_scene()
    if isinstance(step.object, str):
        name = step.object
    else:
        name = step.object.name
        cell.add_to_scene(cell.later_objects[name], cell.world_pose(step.object.pose))
    link = step.link or cell.description.tcp_link
    touch_links = step.touch_links
    if touch_links is None:
        hand = cell.description.gripper
        touch_links = hand.links if hand else ()
    cell.attach(name, link, touch_links, step.represents)


@execute.handles(DetachObject)
def detach_object(step: DetachObject, cell: Cell) -> None:
    """Let go of an attached object; it stays in the planning scene where it is."""
    cell.detach(step.object)
    cell.notes.result["detached"] = step.object
