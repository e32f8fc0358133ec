"""A scenario at its start: loaded, compiled, and its physics built."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from harness.core.errors import ModelRefused, Problem, RobotError, SpecError
from harness.ports.external import ExternalSession
from harness.ports.scene import Touch
from harness.ports.simulation import RecordingSimulator
from harness.session.observation.findings import overlap_text
from harness.session.prepare import Prepared, prepare
from harness.session.run_request import RunRequest
from harness.session.timing import Clock

if TYPE_CHECKING:
    from harness.simulation.mujoco_simulator import MujocoSimulator

S_co = TypeVar("S_co", bound=RecordingSimulator, covariant=True)
M = TypeVar("M", bound="MujocoSimulator")

MOST_DRAWS = 100  # draws of a sample, the first included, until no objects overlap


@dataclass(frozen=True)
class Start(Generic[S_co]):
    """A scenario that is about to be executed.

    Attributes:
        simulator: The simulator at the start state, or a robot.
        draw: Number of the sample's draw; 0 for the first.
        open_session: Makes the session of the programs to which a step hands the robot over; None
            where there are none.
    """

    prepared: Prepared
    simulator: S_co
    draw: int = 0
    open_session: Callable[[], ExternalSession | None] = lambda: None


def start_simulated(request: RunRequest, clock: Clock) -> Start[MujocoSimulator]:
    """Prepare a case in the physics; see `start_case`."""
    from harness.simulation.mujoco_simulator import MujocoSimulator

    return start_case(request, clock, MujocoSimulator)


def start_case(request: RunRequest, clock: Clock, kind: type[M]) -> Start[M]:
    """Prepare a case; where the request says so, draw it again until no objects overlap.

    Raises:
        SpecError: With every problem of the file; or objects overlap in every draw.
    """
    last: list[Problem] = []
    text = request.source or request.text
    for draw in range(MOST_DRAWS):
        again = request.redraw(draw) if request.redraw is not None and draw else request
        prepared = prepare(request.file, again.overrides, request.seed, text)
        simulator = start_physics(prepared, kind, clock, prepared.observed_links)
        simulator.limit(request.longest)
        if request.redraw is None or not simulator.overlaps_at_start:
            return Start(prepared, simulator, draw)
        last = [_no_free_draw(prepared, simulator.overlaps_at_start[0])]
    raise SpecError(last)


def start_physics(
    prepared: Prepared, kind: type[M], clock: Clock | None = None, frames: Sequence[str] = ()
) -> M:
    """Build the physics and record its start state.

    Args:
        clock: Takes the wall time of what moves; None where it is not reported.
        frames: Links whose poses are recorded besides the TCP's.

    Raises:
        SpecError: The physics cannot be built, at the object or the robot that prevents it.
    """
    program = prepared.program
    try:
        with np.errstate(
            over="ignore", invalid="ignore"
        ):  # a start with infinite forces is refused
            return kind(
                program.description,
                [obj for obj in program.all_objects() if obj.in_simulation],
                [obj.name for obj in program.world.objects if obj.in_simulation],
                gravity=program.world.gravity,
                timestep=program.world.timestep,
                frames=frames,
                seed=program.seed,
                moving=partial((clock or Clock()).part, "simulate"),
            )
    except ModelRefused as refused:
        raise SpecError([_problem(prepared, refused)]) from refused
    except RobotError as error:  # a mesh that cannot be read
        problem = prepared.loaded.lines.problem((prepared.loaded.scenario.robot_key,), str(error))
        raise SpecError([problem]) from error


def overlap_note(prepared: Prepared, touch: Touch) -> str:
    """An overlap at the start, with the place of the object in the file."""
    locs = prepared.program.object_locs
    names = [name.partition("/")[0] for name in (touch.second, touch.first)]  # of parts: fixtures
    known = [locs[name] for name in names if name in locs]
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
    return prepared.loaded.lines.problem(loc or (prepared.loaded.scenario.robot_key,), message)
