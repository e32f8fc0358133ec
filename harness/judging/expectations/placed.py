"""placed: the object rests on a support, released and still, at a pose if one is given."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

import numpy as np
from pydantic import Field

from harness.cell.possible_contacts import check_contact
from harness.cell.scope import At
from harness.core.amounts import amounts
from harness.core.pose_arrays import (
    angle_between,
    compose,
    conjugate,
    quat_product,
    relative,
    rotate,
    rotation_vector,
)
from harness.core.spatial import rotation_from_quat_wxyz
from harness.core.symmetry import ANY, equal_turns
from harness.core.types import FloatArray
from harness.judging.at_rest import (
    ATTACHED,
    CONTACT,
    SPEED,
    TURNING,
    released_parts,
    rest_is_known,
    resting_parts,
)
from harness.judging.body_motion import middles
from harness.judging.contacts import TOUCH_FORCE, was_in_robot
from harness.judging.expectation import ObjectPredicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.observations import Observations
from harness.judging.poses import JUMP, UP, frame_poses, object_poses, present, start_samples
from harness.judging.support import required_support, standing, supports
from harness.judging.window import Window, object_record, window_of
from harness.language.base import Name, RestSpeed, RestTurning
from harness.language.expectation import Quantity
from harness.language.poses import Pose, PoseTolerance
from harness.recording.run import Run
from harness.recording.verdict import Measure, Verdict, VerdictWarning

PLACE_POSITION = 0.01  # tolerance of `placed` with a pose and no tolerance [m]
PLACE_TILT = 0.1  # and how far it may lean from the given pose, turns about the vertical free [rad]

SUPPORT = Quantity(
    "support", "N", "at least half of its weight from below, by what the robot does not carry"
)
POSITION = Quantity(
    "position error", "m", "with `pose`: at most the tolerance's `position`", "displacement"
)
LEAN = Quantity("lean", "rad", "with `pose` and no tolerance: at most 0.1")
ORIENTATION = Quantity("orientation error", "rad", "with `tolerance`: at most its `orientation`")


class Placed(ObjectPredicate):
    """The object rests on a support, released and still, at a pose if one is given.

    A support carries at least half of its weight from below. What the robot holds is none, nor is
    what lies on the robot, nor anything stacked on these, also where `on` names it.

    A `pose` without a rotation allows every turn about the vertical after which the object's
    collision shapes are the same. It is still where it was slow for 50 ms, which may begin before
    the step's window. Where a surface runs under it, as a belt below what a stop holds, it passes
    with a warning: its support does not keep it there.
    """

    sentence = "{object} is placed[ on {on}][ at {pose}]"
    synonyms = ("at_pose", "near", "object_pose", "resting")
    quantities = (SUPPORT, SPEED, TURNING, CONTACT, ATTACHED, POSITION, LEAN, ORIENTATION)
    is_proposed = True
    goes_with: ClassVar[Mapping[str, tuple[str, ...]]] = {"tolerance": ("pose",)}

    on: Name | None = Field(
        default=None,
        description="The supporting object; by default anything but the robot supports it.",
    )
    pose: Pose | None = Field(
        default=None,
        description="The expected pose of the object; by default the object may stand anywhere.",
    )
    tolerance: PoseTolerance | None = Field(
        default=None,
        description="The tolerance of `pose`; by default 1 cm, and turns about the vertical are"
        " free. `{position: 5 mm}` requires the orientation too, to its default of 0.01 rad.",
    )
    max_velocity: RestSpeed = Field(
        default=0.005, description="The largest speed of an object at rest [m/s]."
    )
    max_angular_velocity: RestTurning = Field(
        default=0.05, description="The largest turning speed of an object at rest [rad/s]."
    )

    def check(self, at: At) -> None:
        super().check(at)
        if self.on is not None:
            at.scope.check_body(self.on, at.key("on"), special=())
            check_contact(at.scope, self.object, self.on, at.key("on"))
        if self.pose is not None:
            at.scope.check_frame(self.pose.frame, at.key("pose", "frame"), of=self.object)

    def observations(self) -> Observations:
        return Observations(frozenset() if self.pose is None else frozenset({self.pose.frame}))

    def signal(self, window: Window) -> MarginSignal:
        """Rests on a support from below, untouched by the robot, still, and at the pose if given.

        Raises:
            NotReached: The object is not there for `STILL` seconds at any sample.
        """
        run, name = window.run, self.object
        carried = {
            body: force for body, force in standing(run, name).items() if self.on in (None, body)
        }
        support = np.sum([np.zeros(len(run.signals.times)), *carried.values()], axis=0)
        by = f"support by {self.on or 'anything but the robot'}"
        parts = [
            *self._at_pose(window),
            Part(SUPPORT, window.cut(support), required_support(run, name), ">=", measured_name=by),
            *resting_parts(window, name, (self.max_velocity, self.max_angular_velocity)),
            *released_parts(window, name),
        ]

        def text(index: int, tightest: Measure) -> str:
            sample = window.start + index
            every = supports(run, name)
            below = [each for each in carried if every[each][sample] > TOUCH_FORCE]
            held = [each for each in below if carried[each][sample] <= TOUCH_FORCE]
            missed = "rests on nothing" if self.on is None else f"does not rest on {self.on}"
            rests = f"rests on {' and '.join(below)}" if below else missed
            rests += f", and the robot carries {' and '.join(held)}" if held else ""
            return f"{name} {rests}; {_against(tightest)}"

        here = present(run, name)
        judged = rest_is_known(window, here)
        return all_of(window, parts, text, present=window.cut(here), applies=judged)

    def verdict(self, run: Run, step: str) -> Verdict:
        answer, end = super().verdict(run, step), window_of(run, step).stop - 1
        surfaces, forces = run.signals.surfaces, supports(run, self.object)
        below = [each for each, force in forces.items() if force[end] > 0 and each in surfaces]
        running = [each for each in below if surfaces[each][end].any()]
        if answer.status != "passed" or not running:
            return answer
        why = f"{running[0]} runs under {self.object}, so that something else keeps it there"
        found = (*answer.warnings, VerdictWarning("held on a running belt", why))
        return replace(answer, warnings=found)

    def unchanged(self, window: Window) -> str:
        run, name = window.run, self.object
        begin = int(start_samples(run, name)[window.stop - 1])
        since = slice(begin, window.stop)
        if was_in_robot(run, name, since):
            return ""
        carriers = [body for body, force in supports(run, name).items() if force[window.stop - 1]]
        frame = "world" if self.pose is None else self.pose.frame
        for base in dict.fromkeys(("world", frame, *carriers)):
            if _moved(run, name, base, since) <= JUMP:
                on = "" if base == "world" else f" on {base}"
                at = "a step put it there" if begin else "the run began"
                return f"the robot never touched {name}, and it stands where it stood{on} when {at}"
        return ""

    def _at_pose(self, window: Window) -> list[Part]:
        if self.pose is None:
            return []
        run = window.run
        target = compose(frame_poses(run, self.pose.frame), self.pose.se3().as_vector())
        actual = object_poses(run, self.object)
        distance = window.cut(np.linalg.norm(actual[:, :3] - target[:, :3], axis=1))
        points = (window.cut(target[:, :3]), window.cut(actual[:, :3]))
        ups = (rotate(conjugate(each[:, 3:]), UP) for each in (target, actual))
        lean = window.cut(angle_between(*ups))
        most = PLACE_POSITION if self.tolerance is None else self.tolerance.position
        place = Part(POSITION, distance, most, "<=", points=points)
        if self.tolerance is None:
            return [place, Part(LEAN, lean, PLACE_TILT, "<=")]
        turns = 1
        if not self.pose.has_rotation:
            stated = rotation_from_quat_wxyz(target[window.stop - 1, 3:])
            turns = equal_turns(object_record(run, self.object).shapes, stated)
        turn = lean if turns == ANY else window.cut(_turned(target[:, 3:], actual[:, 3:], turns))
        return [place, Part(ORIENTATION, turn, self.tolerance.orientation, "<=")]


def _moved(run: Run, name: str, base: str, samples: slice) -> float:
    """How far the middle of an object was from its first place in a frame, at some samples [m]."""
    seen = relative(frame_poses(run, base), object_poses(run, name))[samples]
    known = middles(object_record(run, name), seen[~np.isnan(seen).any(axis=1)])
    return float(np.linalg.norm(known - known[0], axis=1).max()) if len(known) else 0.0


def _turned(target: FloatArray, actual: FloatArray, turns: int) -> FloatArray:
    """Largest turn about an axis [rad], (N,), of quaternions (N, 4); `turns` a round are alike."""
    angles = np.pi * np.arange(turns) / turns  # half of them: of quaternions
    alike = [np.array([np.cos(angle), 0, 0, np.sin(angle)]) for angle in angles]
    off = [quat_product(conjugate(target), quat_product(turn, actual)) for turn in alike]
    return np.min([np.abs(rotation_vector(each)).max(axis=1) for each in off], axis=0)


def _against(measure: Measure) -> str:
    if measure.comparison == "==":
        return measure.name
    value, limit = amounts(measure.value, measure.limit, measure.unit)
    detail = f" of {measure.detail}" if measure.detail else ""
    return f"{measure.name}{detail} {value} against {limit}"
