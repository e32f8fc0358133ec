"""What happened in a run: plain data, enough to judge and draw it without planner or physics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from harness.core.camera import Camera
from harness.core.geometry import Shape
from harness.core.spatial import SE3
from harness.core.types import FloatArray, IntArray
from harness.core.world import Hole, ObjectJoint, WorldObject
from harness.recording.commands import CommandRecord
from harness.recording.signals import CaptureRecord, ContactRecord, Signals
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription

TIME_RESOLUTION = 1e-9  # Times nearer than this are the same [s]
Outcome = Literal["passed", "failed", "invalid", "error"]


@dataclass(frozen=True)
class ObjectRecord:
    """An object that took part.

    Attributes:
        shapes: Its collision shapes; planner, physics and verdicts know no others.
        present: Intervals [(from, to)] of simulation time in which it was in the scene [s].
        pose: T_world_object when it was added or put somewhere last (xyz, quat wxyz); empty when
            unknown.
        mass: The mass [kg]; NaN when unknown.
        visuals: Shapes that pictures show, where they differ from `shapes`.
        center_of_mass: The centre of mass in the object's frame [m]; empty when unknown.
        joint: The hinge or slide by which a part of a fixture moves; None of any other object.
    """

    name: str
    is_static: bool
    in_planning: bool
    in_simulation: bool
    shapes: tuple[Shape, ...]
    present: tuple[tuple[float, float], ...]
    pose: tuple[float, ...] = ()
    mass: float = float("nan")
    visuals: tuple[Shape, ...] = ()
    center_of_mass: tuple[float, ...] = ()
    joint: ObjectJoint | None = None
    holes: tuple[Hole, ...] = ()

    @classmethod
    def of(
        cls, obj: WorldObject, present: tuple[tuple[float, float], ...], pose: SE3 | None
    ) -> ObjectRecord:
        """The record of an object of the world, with when and where it was there."""
        return cls(
            name=obj.name,
            is_static=obj.is_static,
            in_planning=obj.in_planning,
            in_simulation=obj.in_simulation,
            shapes=obj.shapes,
            present=present,
            pose=() if pose is None else tuple(map(float, pose.as_vector())),
            mass=obj.mass,
            visuals=obj.visuals,
            center_of_mass=() if obj.is_static else tuple(map(float, obj.center_of_mass)),
            joint=obj.joint,
            holes=obj.holes,
        )

    def put_samples(self, times: FloatArray) -> IntArray:
        """Samples at which a step has put it somewhere else, ascending.

        An interval of `present` then begins where another one ends: at the sample before, which
        still shows the old pose.
        """
        ends = [end for _, end in self.present]
        moments = [
            begin
            for (begin, _), end in zip(self.present[1:], ends, strict=False)
            if abs(begin - end) <= TIME_RESOLUTION
        ]
        samples = np.searchsorted(times, np.array(moments) + TIME_RESOLUTION, side="right")
        return samples[samples < len(times)].astype(np.int64)

    @property
    def looks(self) -> tuple[Shape, ...]:
        """Shapes that pictures show."""
        return self.visuals or self.shapes


@dataclass(frozen=True)
class AttachmentRecord:
    """An object fixed to a link in the planning scene, from one time to another.

    Attributes:
        end_time: When it was let go [s]; inf when that did not happen.
        pose_in_link: T_link_object at attaching, as the planner believes it (xyz, quat wxyz).
        represents: The simulated object it stands for; its own name when it is that object.
        welded: The times from and to which the physics fixed it to the hand [s]; None if it did
            not.
    """

    object: str
    link: str
    start_time: float
    end_time: float
    pose_in_link: tuple[float, ...]
    represents: str
    welded: tuple[float, float] | None = None


@dataclass(frozen=True)
class Finding:
    """Something a person should know that is no verdict: plan against physics, notes, fallbacks."""

    kind: str
    message: str
    time: float = float("nan")
    step: str = ""
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True)
class Run:
    """A whole run of one case.

    Attributes:
        file: The path as the user named it.
        case: Empty when the file has one case.
        attachments: What the planner believed to hold.
        steps: The steps in execution order, nested ones flat.
        gravity: The gravity vector in the world [m/s^2].
        timestep: The timestep of the physics [s].
        allowed_contacts: Link or object pairs whose contact is no collision (the SRDF's).
        findings: The notes, and where plan and physics disagree.
        contacts: Every pair that touched, the first to touch first.
        versions: The version of every library that could change a number.
        ended_early: Why the run stopped before its last step; empty when it did not.
        unrecorded: Names of `Signals`' fields that were not recorded, as a bag has no contacts, and
            `attachments`, `steps` and `step_results`; an expectation that needs one is not
            observable.
        captures: Pictures taken, in order of time.
        commands: What external programs commanded, in the order of arrival.
        options: Words that `harness run FILE` was given besides, as `--set`, `lift=0.1`.
        files: Content of `captures` by path in the run's folder; a saved run reads each on first
            use.
    """

    scenario: str
    file: str
    case: str
    seed: int
    robot: RobotDescription
    objects: tuple[ObjectRecord, ...]
    attachments: tuple[AttachmentRecord, ...]
    steps: tuple[StepRecord, ...]
    signals: Signals
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.8)
    timestep: float = 0.001
    allowed_contacts: tuple[tuple[str, str], ...] = ()
    findings: tuple[Finding, ...] = ()
    contacts: tuple[ContactRecord, ...] = ()
    source: str = ""
    versions: Mapping[str, str] = field(default_factory=dict[str, str])
    ended_early: str = ""
    unrecorded: tuple[str, ...] = ()
    cameras: tuple[Camera, ...] = ()
    captures: tuple[CaptureRecord, ...] = ()
    commands: tuple[CommandRecord, ...] = ()
    options: tuple[str, ...] = ()
    files: Mapping[str, bytes] = field(default_factory=dict[str, bytes], repr=False)

    @property
    def duration(self) -> float:
        """Length of the run in simulation time [s]."""
        return float(self.signals.times[-1])
