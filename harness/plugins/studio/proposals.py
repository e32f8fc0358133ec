"""Expectations that hold in the state of the cell, as text for the scenario."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from harness.core.spatial import SE3
from harness.language.expectation import ExpectationFields
from harness.language.language import EXPECTATIONS
from harness.plugins.studio.judging import judged
from harness.plugins.studio.language_help import ITEM, named_at
from harness.plugins.studio.live_cell import LiveCell
from harness.plugins.studio.messages import names_of
from harness.plugins.studio.texts import pose_keys_of, step_text

MOVED = 0.005  # largest distance from its start at which an object counts as not moved [m]

TOLERANCE = {"position": "5 mm", "orientation": "3 deg"}
"""A tolerance of poses that a repetition keeps."""


@dataclass(frozen=True)
class Proposal:
    """An expectation that may hold now.

    Attributes:
        text: The expectation, as a scenario has it.
        why: What the expectation states.
        field: The field for which its bare value stands; empty where it has none.
    """

    text: str
    why: str
    field: str


def proposals(cell: LiveCell) -> list[Proposal]:
    """The expectations that the judge of a run lets pass on the last step executed.

    Candidates are the classes that are worth proposing, with every name that their bare value may
    have; of objects only those that have moved, or that the robot touches.
    """
    step = cell.steps_done - 1
    candidates = list(_candidates(cell))
    if step < 0 or not candidates:
        return []
    document = cell.document.with_expectations([each.text for each in candidates], step)
    name = cell.execution.program.steps[step].id
    verdicts = [each for each in judged(cell, document).verdicts if each.step == name]
    passed = [each.status == "passed" for each in verdicts[-len(candidates) :]]
    kept = [each for each, is_kept in zip(candidates, passed, strict=True) if is_kept]
    fields = {each.field for each in kept}
    return [each for each in kept if each.field or "state" not in fields]  # a name, not numbers


def _candidates(cell: LiveCell) -> Iterator[Proposal]:
    forces = cell.simulator.contact_forces()
    poses = cell.object_poses()
    moved = [name for name in poses if _is_of_interest(cell, name, poses[name], forces)]
    names = {**names_of(cell), "object": moved}
    for word in EXPECTATIONS:
        expectation = EXPECTATIONS[word]
        if not expectation.is_proposed:
            continue
        if not expectation.short and cell.description.arm_group:
            yield _proposal(expectation, {}, cell.tcp_pose())
        for value in named_at(("expect", ITEM, word), names):
            keys: dict[str, Any] = {expectation.short: value}
            below = _support(value, poses, forces) if value in moved else ""
            if "on" in expectation.model_fields and below:
                keys["on"] = below
            yield _proposal(expectation, keys, poses.get(value))


def _proposal(
    expectation: type[ExpectationFields], keys: dict[str, Any], pose: SE3 | None
) -> Proposal:
    if pose is not None and {"pose", "tolerance"} <= set(expectation.model_fields):
        keys = {**keys, "pose": pose_keys_of(pose), "tolerance": TOLERANCE}
    is_short = set(keys) == {expectation.short}
    text = step_text(expectation.word, keys[expectation.short] if is_short else keys)
    return Proposal(text, (expectation.__doc__ or "").partition("\n")[0], expectation.short)


def _is_of_interest(
    cell: LiveCell, name: str, pose: SE3, forces: dict[tuple[str, str], float]
) -> bool:
    """Whether an object has moved, or the robot touches it."""
    obj = cell.cell.presence[name].obj
    if obj.is_static or not obj.in_simulation:
        return False
    touching = {other for pair in forces if name in pair for other in pair}
    return obj.pose.distance_to(pose)[0] >= MOVED or not touching.isdisjoint(
        cell.description.link_names
    )


def _support(name: str, poses: dict[str, SE3], forces: dict[tuple[str, str], float]) -> str:
    """The object that carries another one: the lower body of the strongest contact."""
    height = poses[name].translation[2]
    carriers = {
        other: force
        for pair, force in forces.items()
        if name in pair
        for other in pair
        if other in poses and poses[other].translation[2] < height
    }
    return max(carriers, key=lambda other: carriers[other], default="")
