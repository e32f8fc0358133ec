"""What the plots can show: recorded signals and what follows from them, in units people use."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from harness.recording.run import Run
from harness.recording.verdict import Verdict
from harness.reporting.html import joint_groups as joints
from harness.reporting.html import world_groups as world
from harness.reporting.html.packing import Packer, pack, thin
from harness.reporting.html.plot_group import Group, Limit

STRETCHES_PER_SECOND, FEWEST_STRETCHES, MOST_STRETCHES = 40, 600, 3000
NEAR_LIMIT = 0.4  # share of a limit that is used before the plot makes room to show it


def pack_groups(run: Run, verdicts: Sequence[Verdict], packer: Packer) -> list[dict[str, Any]]:
    """Put every group into the page's data."""
    times = run.signals.times
    duration = float(times[-1])
    stretches = int(min(MOST_STRETCHES, max(FEWEST_STRETCHES, duration * STRETCHES_PER_SECOND)))
    timestep = duration / (len(times) - 1) if len(times) > 1 else run.timestep
    packed: list[dict[str, Any]] = []
    for group in groups_of(run, verdicts):
        columns = np.array([np.asarray(values, dtype=float) for values in group.series.values()])
        thinned = thin(columns, stretches)
        spans = pack(thinned, group.id, packer)
        packed.append(
            {
                "id": group.id,
                "title": group.title,
                "unit": group.unit,
                "least": group.least,
                "points": thinned.values.shape[1],
                "bin": thinned.bin,
                "timestep": timestep,
                "start": float(times[0]),
                "series": [
                    {"name": name, **span} for name, span in zip(group.series, spans, strict=True)
                ],
                "limits": [_limit(limit, spans) for limit in group.limits],
            }
        )
    return packed


def _limit(limit: Limit, spans: Sequence[Mapping[str, float]]) -> dict[str, Any]:
    mine = spans if limit.series is None else [spans[limit.series]]
    peak = max(max(abs(s["low"]), abs(s["low"] + s["size"])) for s in mine)
    stretches = limit.series is None and peak >= NEAR_LIMIT * abs(limit.value)
    return {"value": limit.value, "series": limit.series, "stretches": stretches}


def groups_of(run: Run, verdicts: Sequence[Verdict] = ()) -> Iterator[Group]:
    """Every group that has something to show, the usual ones first."""
    makers: Sequence[Callable[[Run], Group | None]] = (
        joints.positions, joints.velocities, joints.efforts, joints.tracking, joints.gripper,
        world.clearances, world.contacts, world.forces, world.torques, world.surfaces, world.slip,
        world.tcp_position, world.tcp_turn, world.tcp_speed, world.heights, world.displacements,
        world.turns, joints.gripper_effort,
        joints.commands, joints.velocity_errors, joints.plain_velocities, joints.plain_efforts,
        joints.other_positions, joints.other_velocities,
        world.planned_clearances, world.frame_travel,
    )  # fmt: skip
    for make in makers:
        group = make(run)
        if group is not None and _is_known(group):
            yield _with_expected(group, verdicts)


def _is_known(group: Group) -> bool:
    return any(np.isfinite(values).any() for values in group.series.values())


def _with_expected(group: Group, verdicts: Sequence[Verdict]) -> Group:
    """A group with the limits that the scenario's expectations set."""
    found = {
        group.factor * measure.limit
        for verdict in verdicts
        for measure in verdict.measures
        if measure.name == group.measure and math.isfinite(measure.limit) and measure.limit
        and not (group.id == "effort" and measure.unit != "1")
    }  # fmt: skip
    both = {-value for value in found} if group.is_signed else set[float]()
    extra = [Limit(value) for value in sorted(found | both)]
    return replace(group, limits=[*group.limits, *extra])
