"""Fails motions whose goals are in the frame of something that moves by itself meanwhile."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from typing import cast

import numpy as np

from harness.cell.cell import Cell
from harness.cell.program import ProgramStep
from harness.cell.step import Step
from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.language.base import SpecModel
from harness.language.poses import Pose, Position
from harness.ports.simulation import RecordingSimulator
from harness.recording.explanation import Explanation
from harness.recording.signals import Signals

MISSED = (0.005, 0.05)  # [m], [rad] of a goal from where it was planned to be; less is no miss
Predicted = Callable[[float], SE3]  # T_world_object after a duration [s]


def places_in(content: object) -> Iterator[Pose | Position]:
    """Every pose and position that a step states, but for those of its constraints and steps."""
    if isinstance(content, Pose | Position):
        yield content
    elif isinstance(content, SpecModel):
        for key, value in content:
            yield from places_in(None if key == "path_constraints" else value)
    elif isinstance(content, tuple | dict):
        inside = cast("Sequence[object] | dict[str, object]", content)
        for each in inside.values() if isinstance(inside, dict) else inside:
            yield from places_in(None if isinstance(each, Step) else each)


def may_move(name: str, cell: Cell) -> bool:
    """Whether a frame is an object that may move by itself: in the physics, not static or held."""
    obj = cell.presence[name].obj if name in cell.presence else None
    is_free = name in cell.scene.object_names() and name not in cell.scene.attached()
    return obj is not None and obj.in_simulation and not obj.is_static and is_free


@contextmanager
def watched_goals(steps: Sequence[ProgramStep], cell: Cell) -> Generator[dict[str, Predicted]]:
    """Fail where a goal of motions was elsewhere than planned when the arm came.

    Yields:
        Where objects will be whose motion is known, to be filled in; the others are taken to rest.

    Raises:
        StepFailed: MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE; says by how much and when.
    """
    known, first, waits = dict[str, Predicted](), cell.simulator.sample_count - 1, cell.waiting
    goals = [
        (step, place)
        for step in steps
        for place in places_in(step.spec)
        if place.frame != getattr(step.spec, "object", "") and may_move(place.frame, cell)
        if step.spec.moves_arm or step.spec.is_made_of_parts
    ]
    yield known
    if goals and waits is None and isinstance(cell.simulator, RecordingSimulator):
        signals = cell.simulator.finish(first)
        for step, place in goals:
            ends = len(steps) == 1 and step.spec.moves_arm and not step.spec.has_corners
            _refuse_miss(step, place, known.get(place.frame), signals, ends, cell)


def _refuse_miss(
    step: ProgramStep,
    place: Pose | Position,
    planned: Predicted | None,
    signals: Signals,
    ends_there: bool,
    cell: Cell,
) -> None:
    """Fail where a goal of a step was elsewhere when the arm came, or first pushed its object."""
    name, times, moved = place.frame, signals.times, signals.object_poses[place.frame]
    goal = place.se3() if isinstance(place, Pose) else SE3(np.eye(3), np.array(place.xyz))
    link = (cell.robot.of_arm[step.arm] if step.arm else cell.robot).tcp_link
    put = signals.object_poses.get(getattr(step.spec, "object", ""))

    def expected(row: int) -> SE3:
        frame = planned(float(times[row] - times[0])) if planned else SE3.from_vector(moved[0])
        return frame @ goal

    def away(row: int) -> float:  # of the tool, or of what it puts there, from the goal [m]
        tcp = cell.kinematics.link_pose(signals.joint_positions[row], link).translation
        return expected(row).distance_to(SE3(np.eye(3), tcp if put is None else put[row, :3]))[0]

    last = len(times) - 1
    arrival = last if ends_there else min(range(last, -1, -10), key=away)
    row = min(arrival, _first_push(name, signals, cell))
    off, turn = expected(row).distance_to(SE3.from_vector(moved[row]) @ goal)
    if off > MISSED[0] or turn > MISSED[1]:
        how = "arrived" if row == last else "passed" if row == arrival else "went, and was pushed"
        raise StepFailed(
            "MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE",
            f"'{name}', in whose frame the goal is, moved by itself: at t={times[row]:.3f} s the"
            f" goal was {1e3 * off:.1f} mm and {np.degrees(turn):.1f} deg from where the arm {how}",
            Explanation(advice="let it come to rest before: `settle`, or `wait: {until: ...}`"),
        )


def _first_push(name: str, signals: Signals, cell: Cell) -> int:
    """The sample at which what the arm may have pushed touches an object, or the number of all."""
    free = {each for each, presence in cell.presence.items() if not presence.obj.is_static}
    pushed, near = set[str](), set(cell.robot.link_names)
    while near - pushed:
        pushed |= near
        pairs = [pair for pair in signals.contact_forces if pushed & {*pair}]
        near = {each for pair in pairs for each in pair} & free - {name}
    forces = [f for pair, f in signals.contact_forces.items() if name in pair and pushed & {*pair}]
    touched = np.any([*forces, np.zeros(len(signals.times))], axis=0)
    return int(touched.argmax()) if touched.any() else len(touched)
