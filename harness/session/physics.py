"""The physics of a prepared scenario, at its start."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from harness.core.errors import ModelRefused, Problem, RobotError, SpecError
from harness.observation.findings import overlap_text
from harness.ports import Touch
from harness.session.prepare import Prepared
from harness.session.timing import Clock

if TYPE_CHECKING:
    from harness.session.timed_simulator import TimedSimulator


def start_physics(
    prepared: Prepared, clock: Clock | None = None, frames: Sequence[str] = ()
) -> TimedSimulator:
    """Build the physics and record its start state.

    Args:
        prepared: The scenario.
        clock: Takes the wall time of what moves; None where nobody asks for it.
        frames: Links whose poses are recorded besides the TCP's.

    Raises:
        SpecError: The physics cannot be built, at the object or the robot that prevents it.
    """
    from harness.session.timed_simulator import TimedSimulator  # loads MuJoCo

    program = prepared.program
    try:
        with np.errstate(
            over="ignore", invalid="ignore"
        ):  # a start with infinite forces is refused
            return TimedSimulator(
                clock or Clock(),
                program.description,
                [obj for obj in program.all_objects() if obj.in_simulation],
                [obj.name for obj in program.world.objects if obj.in_simulation],
                gravity=program.world.gravity,
                timestep=program.world.timestep,
                frames=frames,
            )
    except ModelRefused as refused:
        raise SpecError([_problem(prepared, refused)]) from refused
    except RobotError as error:  # a mesh that cannot be read
        problem = prepared.loaded.lines.problem(("robot",), str(error))
        raise SpecError([problem]) from error


def overlap_note(prepared: Prepared, touch: Touch) -> str:
    """An overlap at the start, with the place of the object in the file."""
    locs = prepared.program.object_locs
    known = [locs[name] for name in (touch.second, touch.first) if name in locs]
    loc = min(known, key=lambda each: each == ("world",))  # the world's objects come last
    problem = prepared.loaded.lines.problem(loc, overlap_text(touch))
    return f"{problem.path}:{problem.line}:{problem.column}: {problem.message}"


def _problem(prepared: Prepared, refused: ModelRefused) -> Problem:
    program, name = prepared.program, refused.body
    loc = program.object_locs.get(name)
    kind = "object" if loc is not None else "link"
    message = f"{kind} '{name}': {refused.reason}" if name else refused.reason
    return prepared.loaded.lines.problem(loc or ("robot",), message)
