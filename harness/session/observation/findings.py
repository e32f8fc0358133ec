"""Findings: what users should know of a run besides its verdicts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from pydantic import BaseModel

from harness.cell.program import Program
from harness.core.errors import Problem
from harness.core.geometry import Box, Capsule, Cylinder, Sphere, bounding_radius
from harness.core.limits import LONGEST_RUN
from harness.core.solids import volume_of
from harness.core.world import WorldObject
from harness.language.annotations import unit_of
from harness.ports.scene import Touch
from harness.recording.run import Finding, Run

LARGE = 5.0  # size from which a movable object is probably given in millimetres [m]
REACHED = {"s": LONGEST_RUN, "m": LONGEST_RUN, "m/s": 100.0, "N": 1e5, "N*m": 1e5}
"""More than any run reaches, by unit: distance is that of the longest run at 1 m/s."""
DENSEST = 22590.0  # osmium at room temperature, CRC Handbook of Chemistry and Physics [kg/m^3]

NOTHING_EXPECTED = (
    "the scenario expects nothing, so it passes whatever happens, as long as no step fails;"
    " write what must hold below `expect:`"
)


def about_file(program: Program, notes: Sequence[Problem]) -> tuple[Finding, ...]:
    """What the scenario file allows and probably does not intend."""
    found = [Finding("note", noted(problem)) for problem in notes]
    found += [Finding("note", text) for obj in program.all_objects() if (text := _too_large(obj))]
    found += [Finding("note", text) for obj in program.all_objects() if (text := _too_inert(obj))]
    found += [Finding("note", text) for obj in program.all_objects() if (text := _too_dense(obj))]
    for item in program.expectations:
        found += [Finding("note", text) for text in _unreachable(item.spec, item.line)]
    expects_errors = any(step.spec.expect_error for step in program.all_steps())
    if not program.expectations and not expects_errors:
        found.append(Finding("nothing_expected", NOTHING_EXPECTED))
    return tuple(found)


def _unreachable(spec: BaseModel, line: int) -> Iterator[str]:
    """Remarks on numbers of an expectation that no run reaches: as limits they limit nothing."""
    for key, value in spec:
        if isinstance(value, BaseModel):
            yield from _unreachable(value, line)
        elif isinstance(value, float) and value > REACHED.get(unit := unit_of(spec, key), np.inf):
            yield f"line {line}: `{key}` is {value:g} {unit}, more than any run reaches"


def _too_large(obj: WorldObject) -> str:
    """A remark on a movable object that is as large as a house; empty for others."""
    sizes = [shape.geometry.size for shape in obj.shapes if isinstance(shape.geometry, Box)]
    sizes += [
        (2 * shape.geometry.radius,) * 3
        for shape in obj.shapes
        if isinstance(shape.geometry, Sphere | Cylinder | Capsule)
    ]
    largest = max((max(size) for size in sizes), default=0.0)
    if obj.is_static or largest < LARGE:
        return ""
    return (
        f"'{obj.name}' measures {largest:g} m: a number without a unit is in metres, "
        f"write `{largest:g} mm` for millimetres"
    )


def _too_inert(obj: WorldObject) -> str:
    """A remark on an inertia beyond that of the whole mass at the far end of the shapes."""
    if obj.is_static:
        return ""
    radius = max(map(bounding_radius, obj.shapes), default=np.inf)
    most = obj.mass * (radius + float(np.linalg.norm(obj.center_of_mass))) ** 2
    moment = float(np.linalg.eigvalsh(obj.inertia).max())
    if moment <= most:
        return ""
    return (
        f"'{obj.name}' has an inertia of {moment:.3g} kg m^2, and its mass within its shapes has"
        f" {most:.3g} kg m^2 at most: it tips and turns so slowly that it seems to rest"
    )


def _too_dense(obj: WorldObject) -> str:
    """A remark on a movable object that is heavier than any metal of its size."""
    volumes = [volume_of(shape.geometry) for shape in obj.shapes]
    volume = sum(each for each in volumes if each is not None)
    if obj.is_static or not volume or None in volumes or obj.mass <= DENSEST * volume:
        return ""
    return (
        f"'{obj.name}' has {obj.mass / volume:.3g} kg/m^3, and osmium, the densest metal,"
        f" {DENSEST:g}: a mass without a unit is in kg, write `{obj.mass:g} g` for grams"
    )


def noted(problem: Problem) -> str:
    """A remark about a place in a file, on one line."""
    return f"{problem.path}:{problem.line}:{problem.column}: {problem.message}; {problem.hint}"


def notes_of_files(notes: Sequence[str]) -> tuple[Finding, ...]:
    """What was left out of the robot's and the world's files, or assumed."""
    return tuple(Finding(kind="note", message=note) for note in notes)


def slowed_videos(run: Run, rates: Mapping[str, float]) -> tuple[Finding, ...]:
    """The cameras whose video has a lower rate than requested, since the run is long."""
    most = {camera.name: camera.most_frames for camera in run.cameras}
    return tuple(
        Finding(
            "video_rate",
            f"{name} is recorded at {most[name] / run.duration:.3g} Hz instead of {rate:g} Hz:"
            f" a video of this size has at most {most[name]} frames",
        )
        for name, rate in rates.items()
        if run.duration * rate > most[name]
    )


def overlap_text(touch: Touch) -> str:
    """Which two bodies overlap at the start, and how deep."""
    return (
        f"at the start {touch.first} and {touch.second} overlap by {-1e3 * touch.distance:.3g} mm;"
        " the physics pushes them apart"
    )


def overlap_findings(touches: Sequence[Touch]) -> tuple[Finding, ...]:
    """Objects that are inside something when the run begins."""
    return tuple(
        Finding(
            kind="overlap",
            message=overlap_text(touch),
            time=0.0,
            values={"pair": [touch.first, touch.second], "depth": -touch.distance},
        )
        for touch in touches
    )
