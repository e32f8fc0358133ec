"""A scenario at its start: loaded, compiled, and its physics built."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from harness.core.errors import ModelRefused, Problem, RobotError, SpecError
from harness.ports.scene import Touch
from harness.session.observation.findings import overlap_text
from harness.session.prepare import Prepared, prepare
from harness.session.run_request import RunRequest
from harness.session.timing import Clock

if TYPE_CHECKING:
    from harness.session.timed_simulator import TimedSimulator

MOST_DRAWS = 100
"""Draws of a sample, the first included, until no objects overlap."""


class Start(NamedTuple):
    """A scenario that is about to be executed.

    Attributes:
        simulator: The simulator at the start state.
        draw: Number of the sample's draw; 0 for the first.
    """

    prepared: Prepared
    simulator: TimedSimulator
    draw: int


def start_case(request: RunRequest, clock: Clock) -> Start:
    """Prepare a case; where the request says so, draw it again until no objects overlap.

    Raises:
        SpecError: With every problem of the file; or objects overlap in every draw.
    """
    last: list[Problem] = []
    for draw in range(MOST_DRAWS):
        again = request.redraw.redrawn(draw) if request.redraw is not None and draw else request
        prepared = prepare(request.file, again.overrides, request.seed, request.text)
        simulator = start_physics(prepared, clock, prepared.observed_links)
        if request.redraw is None or not simulator.overlaps_at_start:
            return Start(prepared, simulator, draw)
        last = [_no_free_draw(prepared, simulator.overlaps_at_start[0])]
    raise SpecError(last)


def start_physics(
    prepared: Prepared,
    clock: Clock | None = None,
    frames: Sequence[str] = (),
    kind: type[TimedSimulator] | None = None,
) -> TimedSimulator:
    """Build the physics and record its start state.

    Args:
        prepared: The scenario, ready to be executed.
        clock: Takes the wall time of what moves; None where it is not reported.
        frames: Links whose poses are recorded besides the TCP's.
        kind: The class of the simulator.

    Raises:
        SpecError: The physics cannot be built, at the object or the robot that prevents it.
    """
    from harness.session.timed_simulator import TimedSimulator  # loads MuJoCo

    program = prepared.program
    try:
        with np.errstate(
            over="ignore", invalid="ignore"
        ):  # a start with infinite forces is refused
            return (kind or TimedSimulator)(
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
    loc = min(known, key=lambda each: each == ("world",))  # the world's objects are listed last
    problem = prepared.loaded.lines.problem(loc, overlap_text(touch))
    return f"{problem.path}:{problem.line}:{problem.column}: {problem.message}"


def _no_free_draw(prepared: Prepared, touch: Touch) -> Problem:
    return prepared.loaded.lines.problem(
        ("redraw_overlaps",),
        f"objects overlap in each of {MOST_DRAWS} draws; in the last one {touch.first} and"
        f" {touch.second} by {-1e3 * touch.distance:.3g} mm",
        "widen the distributions of `randomize`, or move what does not vary",
    )


def _problem(prepared: Prepared, refused: ModelRefused) -> Problem:
    program, name = prepared.program, refused.body
    loc = program.object_locs.get(name)
    kind = "object" if loc is not None else "link"
    message = f"{kind} '{name}': {refused.reason}" if name else refused.reason
    return prepared.loaded.lines.problem(loc or ("robot",), message)
