"""formula: signal temporal logic over recorded signals."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field

from harness.cell.possible_contacts import HINT, why_never_in_contact
from harness.cell.scope import At
from harness.judging.contacts import FORCE_WINDOW
from harness.judging.distances import MEASURED_WORDS
from harness.judging.expectation import SPECIAL_BODIES, Expectation
from harness.judging.observations import CLEARANCE_ROOM, Observations
from harness.judging.window import window_of
from harness.language.base import Duration
from harness.plugins.formulas.language.formula import (
    SIGNALS,
    Comparison,
    Const,
    Node,
    Signal,
    arguments_of,
    comparisons_of,
    constants_of,
    frames_of,
    mixed_units,
    signals_of,
)
from harness.plugins.formulas.language.parser import parse_formula, readable
from harness.plugins.formulas.language.ranges import decided, range_of_signal
from harness.plugins.formulas.verdict import formula_verdict
from harness.recording.run import Run
from harness.recording.verdict import Verdict
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Joint

RANGES: dict[str, Callable[[Joint], tuple[float, float]]] = {
    "position": lambda joint: (joint.lower, joint.upper),
    "command": lambda joint: (joint.lower, joint.upper),
    "velocity": lambda joint: (-joint.velocity, joint.velocity),
    "effort": lambda joint: (-joint.effort, joint.effort),
}
"""The smallest and the largest value of a joint's signals, by their names."""
ROOM = 1.0
"""A number further beyond a joint's limits, as a share of their distance, has another unit."""
FORCES = ("force", "torque")
UNITS_HINT = "angles without a unit are in radians, lengths in metres"
LARGEST_CUTOFF = 2.0  # [m]; distances are recorded up to here, whatever is compared


class Formula(Expectation):
    """A formula of signal temporal logic holds at the window's first sample."""

    short = "formula"

    formula: Annotated[str, AfterValidator(readable)] = Field(
        description="The formula, such as `always (z(box) > 5 cm implies force(robot, box) > 0.1"
        " N)`."
    )
    force_window: Duration = Field(
        default=FORCE_WINDOW,
        description="`force` is the mean over this time before each sample; with 0 the samples of "
        "the physics count [s].",
    )

    def check(self, at: At) -> None:
        """Names of the formula's signals, each problem under its name."""
        robot = at.scope.description
        bodies = (*SPECIAL_BODIES, *robot.of_arm, *at.scope.objects, *robot.link_names)
        frames = ("tcp", *at.scope.objects, *robot.link_names)
        root = parse_formula(self.formula)
        units = {joint.name: joint.position_unit for joint in robot.movable_joints}
        for start, first, second in mixed_units(root, units):
            at.scope.problems.add_in_text(
                at.key("formula"),
                start,
                f"the formula joins {first} and {second}",
                "both sides must be of one kind",
            )
        for comparison in comparisons_of(root):
            if problem := _beyond_range(comparison, robot) or _unbreakable(comparison, robot):
                at.scope.problems.add_in_text(at.key("formula"), comparison.start, *problem)
        reads_forces = any(each.name.startswith(FORCES) for each in signals_of(root))
        if "force_window" in self.model_fields_set and not reads_forces:
            at.scope.problems.add(at.key("force_window"), "the formula reads no force")
        sensors = tuple(robot.wrench_sensors)
        belts = tuple(n for n, each in at.scope.objects.items() if each.surface_motion is not None)
        known = {
            "joint": robot.joint_names,
            "frame": frames,
            "body": bodies,
            "sensor": sensors,
            "belt": belts,
        }
        measured = (*MEASURED_WORDS, *robot.of_arm, *at.scope.objects)
        kind_names = {
            "joint": "joint",
            "frame": "link or object",
            "body": "object or link",
            "sensor": "wrench sensor",
            "belt": "belt or turntable",
        }
        for signal in signals_of(root):
            kinds, _, _ = SIGNALS[signal.name]
            for kind, name, start in zip(kinds, signal.arguments, signal.starts, strict=True):
                names = measured if signal.name == "distance" else known[kind]
                if name not in names:
                    at.scope.problems.unknown(
                        at.key("formula"), kind_names[kind], name, names, start=start
                    )
            if signal.name == "force":
                reason = why_never_in_contact(at.scope, *signal.arguments)
                if reason:
                    at.scope.problems.add_in_text(at.key("formula"), signal.starts[0], reason, HINT)

    def names(self) -> frozenset[str]:
        return frozenset(arguments_of(parse_formula(self.formula), "frame", "body", "joint"))

    def observations(self) -> Observations:
        root = parse_formula(self.formula)
        return Observations(frozenset(frames_of(root) - {"tcp"}), _furthest(root))

    def verdict(self, run: Run, step: str) -> Verdict:
        window = window_of(run, self.during or step)
        return formula_verdict(self.formula, window, self.force_window)


def _unbreakable(comparison: Comparison, robot: RobotDescription) -> tuple[str, str] | None:
    """Why no run decides a comparison, and what to do; None where a run does."""
    if not signals_of(comparison):
        return f"`{comparison.text}` reads no signal of the run", "name one, such as `z(box)`"

    def range_here(signal: Signal) -> tuple[float, float]:
        """The range of a signal: of a joint with room for numbers of its unit, but of efforts."""
        joint = robot.joint_by_name.get(signal.arguments[0]) if signal.arguments else None
        if joint is None or signal.name not in RANGES:
            return range_of_signal(signal)
        low, high = RANGES[signal.name](joint)
        if not low < high:
            return range_of_signal(signal)
        room = 0 if signal.name == "effort" else ROOM * (high - low)
        return low - room, high + room

    holds = decided(comparison, range_here)
    if holds is None:
        return None
    always = "always" if holds else "never"
    return f"`{comparison.text}` {always} holds, whatever the run does", UNITS_HINT


def _beyond_range(comparison: Comparison, robot: RobotDescription) -> tuple[str, str] | None:
    """Why a joint's signal never comes near a number, and what to do; None where it may.

    A number further beyond the limits than they are apart is taken for one in another unit.
    """
    sides = (comparison.left, comparison.right)
    for signal, limit in (sides, sides[::-1]):
        if isinstance(signal, Signal) and isinstance(limit, Const) and signal.name in RANGES:
            joint = robot.joint_by_name.get(signal.arguments[0])
            low, high = (-np.inf, np.inf) if joint is None else RANGES[signal.name](joint)
            if abs(limit.value - (low + high) / 2) > (0.5 + ROOM) * (high - low):
                text = f"{signal} is between {low:.3g} and {high:.3g}, never {limit.value:g}"
                return text, UNITS_HINT
    return None


def _furthest(root: Node) -> float | None:
    """A cutoff of distances beyond every length that a formula compares one with [m]."""
    if not any(node.name == "distance" for node in signals_of(root)):
        return None
    lengths = [abs(each.value) for each in constants_of(root) if each.unit in ("", "m")]
    return min(max(lengths, default=0.0) + CLEARANCE_ROOM, LARGEST_CUTOFF)
