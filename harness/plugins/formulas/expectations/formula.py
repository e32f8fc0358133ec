"""formula: signal temporal logic over recorded signals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field

from harness.cell.possible_contacts import HINT, why_never_in_contact
from harness.cell.scope import At, Scope
from harness.core.geometry import bounding_radius
from harness.judging.contacts import FORCE_WINDOW
from harness.judging.distances import MEASURED_WORDS
from harness.judging.expectation import SPECIAL_BODIES, Expectation
from harness.judging.limits import UNITS_HINT, lean_range
from harness.judging.observations import CLEARANCE_ROOM, Observations
from harness.judging.window import window_of
from harness.language.base import Duration
from harness.plugins.formulas.language.formula import (
    SIGNALS,
    Const,
    Kind,
    Node,
    Signal,
    arguments_of,
    mixed_units,
    parts_of,
    signals_of,
    text_of,
)
from harness.plugins.formulas.language.parser import SAME_KIND, parse_formula, readable
from harness.plugins.formulas.language.ranges import Range, RangeOf, decided_parts, range_of_signal
from harness.plugins.formulas.verdict import formula_verdict
from harness.recording.run import Run
from harness.recording.verdict import Verdict
from harness.robot.mechanism import Joint

RANGES: dict[str, Callable[[Joint], tuple[float, float]]] = {
    "position": lambda joint: (joint.lower, joint.upper),
    "command": lambda joint: (joint.lower, joint.upper),
    "velocity": lambda joint: (-joint.velocity, joint.velocity),
    "effort": lambda joint: (-joint.effort, joint.effort),
}
"""The smallest and the largest value of a joint's signals, by their names."""
FORCES = ("force", "torque")
LINK_RADIUS = 1.0  # [m]; no arm has a convex part of a link that is thicker than 2 m all around
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
        root = parse_formula(self.formula)
        units = {joint.name: joint.position_unit for joint in robot.movable_joints}
        for start, first, second in mixed_units(root, units):
            message = f"the formula joins {first} and {second}"
            at.scope.problems.add_in_text(at.key("formula"), start, message, SAME_KIND)
        for part, holds in decided_parts(root, _ranges(at.scope)):
            why = f"{'always' if holds else 'never'} holds, whatever the run does"
            if not signals_of(part):
                why = "reads no signal of the run"
            message = f"`{text_of(part)}` {why}"
            at.scope.problems.add_in_text(at.key("formula"), part.start, message, UNITS_HINT)
        reads_forces = any(each.name.startswith(FORCES) for each in signals_of(root))
        if "force_window" in self.model_fields_set and not reads_forces:
            at.scope.problems.add(at.key("force_window"), "the formula reads no force")
        objects = at.scope.objects
        belts = [name for name, each in objects.items() if each.surface_motion is not None]
        named = (*robot.of_arm, *objects)
        known: dict[Kind, tuple[str, Sequence[str]]] = {
            "joint": ("joint", robot.joint_names),
            "frame": ("link or object", ("tcp", *objects, *robot.link_names)),
            "body": ("object or link", (*SPECIAL_BODIES, *named, *robot.link_names)),
            "sensor": ("wrench sensor", tuple(robot.wrench_sensors)),
            "belt": ("belt or turntable", belts),
        }
        for signal in signals_of(root):
            kinds, _, _ = SIGNALS[signal.name]
            for kind, name, start in zip(kinds, signal.arguments, signal.starts, strict=True):
                what, names = known[kind]
                names = (*MEASURED_WORDS, *named) if signal.name == "distance" else names
                if name not in names:
                    at.scope.problems.unknown(at.key("formula"), what, name, names, start=start)
            if signal.name == "force":
                reason = why_never_in_contact(at.scope, *signal.arguments)
                if reason:
                    at.scope.problems.add_in_text(at.key("formula"), signal.starts[0], reason, HINT)

    def names(self) -> frozenset[str]:
        return frozenset(arguments_of(parse_formula(self.formula), "frame", "body", "joint"))

    def observations(self) -> Observations:
        root = parse_formula(self.formula)
        return Observations(frozenset(arguments_of(root, "frame") - {"tcp"}), _furthest(root))

    def verdict(self, run: Run, step: str) -> Verdict:
        window = window_of(run, self.during or step)
        return formula_verdict(self.formula, window, self.force_window)


def _ranges(scope: Scope) -> RangeOf:
    """The least and the largest value of each signal, as far as the robot and the world say."""

    def ends_of(signal: Signal) -> Range:
        first = signal.arguments[0] if signal.arguments else ""
        joint, part = scope.description.joint_by_name.get(first), scope.objects.get(first)
        if signal.name == "tilt" and part is not None and part.joint is not None:
            return lean_range(part.joint)
        if signal.name == "distance":
            return -sum(_thickness(scope, name) for name in signal.arguments), np.inf
        if joint is None or signal.name not in RANGES:
            return range_of_signal(signal)
        low, high = RANGES[signal.name](joint)
        if not low < high:
            return range_of_signal(signal)
        # what is further beyond the limits than they are apart is a number in another unit
        room = 0 if signal.name == "effort" else high - low
        return low - room, high + room

    return ends_of


def _thickness(scope: Scope, name: str) -> float:
    """The largest thickness of a convex part of a body, so that it is no deeper in another [m]."""
    obj = scope.objects.get(name)
    objects = scope.objects.values() if name == "any" else () if obj is None else (obj,)
    radii = [bounding_radius(shape) for each in objects for shape in each.shapes]
    return 2 * max([*radii, 0.0 if obj else LINK_RADIUS])


def _furthest(root: Node) -> float | None:
    """A cutoff of distances beyond every length that a formula compares one with [m]."""
    if not any(node.name == "distance" for node in signals_of(root)):
        return None
    numbers = [part for part in parts_of(root) if isinstance(part, Const)]
    lengths = [abs(each.value) for each in numbers if each.unit in ("", "m")]
    return min(max(lengths, default=0.0) + CLEARANCE_ROOM, LARGEST_CUTOFF)
