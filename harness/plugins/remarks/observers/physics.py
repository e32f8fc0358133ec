"""Joints far from their commands, and pairs that touched or overlapped because they may."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from harness.cell.program import Program
from harness.core.amounts import amount
from harness.core.types import Pair
from harness.judging.joints import hand_joints
from harness.recording.run import Finding, Run
from harness.recording.signals import Signals
from harness.recording.step_results import AllowedCollisions
from harness.session.observation.observer import Observer


class Physics(Observer):
    """The joint that lagged most, and contacts and overlaps that the robot's files permit."""

    name: ClassVar[str] = "physics"

    def report(self, run: Run, program: Program) -> tuple[Finding, ...]:
        del program
        overlaps = link_overlap_findings(run.signals)
        return (*overlaps, *tracking_finding(run), *allowed_contacts(run))


def tracking_finding(run: Run) -> tuple[Finding, ...]:
    """The joint that was furthest from its command."""
    signals = run.signals
    errors = np.abs(signals.joint_positions - signals.joint_commands)
    errors = np.where(np.isfinite(errors), errors, 0.0)
    hand = hand_joints(run.robot)
    for column, joint in enumerate(run.robot.movable_joints):
        if joint.name in hand:
            errors[:, column] = 0.0  # a gripper that presses lags its command
    row, column = (int(place) for place in np.unravel_index(int(np.argmax(errors)), errors.shape))
    worst = float(errors[row, column])
    joint = run.robot.movable_joints[column]
    unit = joint.position_unit
    return (
        Finding(
            "tracking",
            f"{joint.name} was furthest from its command: {amount(worst, unit)}",
            float(signals.times[row]),
            values={"joint": joint.name, "error": worst, "unit": unit},
        ),
    )


def allowed_contacts(run: Run) -> tuple[Finding, ...]:
    """Pairs that the SRDF or `allow_collisions` lets touch, and that really did."""
    times, period = run.signals.times, run.timestep
    found: list[Finding] = []
    for pair, force in run.signals.contact_forces.items():
        for where, touching in _allowances(run, pair):
            rows = np.flatnonzero((force > 0) & touching)
            if not len(rows):
                continue
            first, seconds = float(times[rows[0]]), len(rows) * period
            peak = float(force[rows].max())
            found.append(
                Finding(
                    "allowed_contact",
                    f"{pair[0]} and {pair[1]} touched, as {where} allows: first at {first:.2f} s,"
                    f" for {seconds:.2f} s, at most {amount(peak, 'N')}",
                    first,
                    values={"pair": list(pair), "seconds": seconds, "peak_force": peak},
                )
            )
    return tuple(found)


def _allowances(run: Run, pair: Pair) -> list[tuple[str, np.ndarray]]:
    times = run.signals.times
    either = {pair, (pair[1], pair[0])}
    allowances: list[tuple[str, np.ndarray]] = []
    if either & set(run.allowed_contacts):
        allowances.append(("the SRDF", np.ones(len(times), dtype=bool)))
    links = set(run.robot.link_names)
    names = [{name, "robot"} if name in links else {name} for name in pair]
    for step in run.steps:
        allowed = step.result.find(AllowedCollisions)
        for first, second in allowed.allowed_collisions if allowed else ():
            both = (first in names[0] and second in names[1]) or (
                first in names[1] and second in names[0]
            )
            if both:
                during = (times >= step.start_time) & (times <= step.end_time)
                allowances.append((f"step {step.title}", during))
    return allowances


def link_overlap_findings(signals: Signals) -> tuple[Finding, ...]:
    """Links that were inside each other, and that the SRDF excludes from collision checking."""
    found: list[Finding] = []
    for (first, second), depth in signals.link_overlaps.items():
        deepest = int(np.argmax(depth))
        time = float(signals.times[deepest])
        found.append(
            Finding(
                "link_overlap",
                f"{first} and {second}, which the SRDF excludes from collision checking, were"
                f" {1e3 * depth[deepest]:.1f} mm inside each other; with every joint at zero they"
                " are apart: enable the pair, or expect `collision` with `count_allowed`",
                time,
                values={"pair": [first, second], "depth": float(depth[deepest])},
            )
        )
    return tuple(found)
