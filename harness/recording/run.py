"""What happened in a run: plain data, enough to judge and draw it without planner or physics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from harness.core.camera import Camera
from harness.core.details import Details
from harness.core.geometry import Rgba, Shape
from harness.core.quantity import distinct
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray, IntArray
from harness.recording.commands import CommandRecord

StepStatus = Literal["passed", "failed", "expected error", "not reached"]
VerdictStatus = Literal["passed", "failed", "not reached", "not observable"]
Outcome = Literal["passed", "failed", "invalid", "error"]
Pair = tuple[str, str]
Floats = tuple[float, ...]


@dataclass(frozen=True)
class JointRecord:
    """Limits of a movable joint, as verdicts and plots need them (SI; inf where there is none)."""

    name: str
    kind: str
    lower: float
    upper: float
    velocity: float
    acceleration: float
    effort: float
    is_mimic: bool = False


@dataclass(frozen=True)
class GripperRecord:
    """Which links make up the finger sides, and the joint that closes them.

    Attributes:
        sides: Links of each finger side, by side name.
        widths: Rows (joint position, gap between the pads [m]).
        palm_link: The link that carries the fingers; empty if unknown.
    """

    group: str
    joint: str
    sides: Mapping[str, tuple[str, ...]]
    open_position: float
    closed_position: float
    widths: tuple[tuple[float, float], ...] = ()
    palm_link: str = ""


@dataclass(frozen=True)
class LinkPlacement:
    """How a link hangs on its parent link.

    Attributes:
        pose: T_parent_link with its joint at zero (xyz, quat wxyz).
        joint: The joint that moves it; empty when it is fixed.
        slides: Whether that joint slides along the axis; else it turns about it.
        axis: Unit vector in the link's frame.
    """

    link: str
    parent: str
    pose: Floats
    joint: str = ""
    slides: bool = False
    axis: Floats = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class MeshRecord:
    """Triangles of one colour of a mesh file that links or objects look like.

    Attributes:
        path: The path of the file, as `Shape.geometry` names it; it need not be there any more.
        scale: The scale of `Shape.geometry`; the vertices are scaled already.
        vertices: The vertices, shape (V, 3) [m].
        faces: Indices of vertices, shape (F, 3).
        rgba: None where the file gives no colour: the shape's.
    """

    path: Path
    scale: tuple[float, float, float]
    vertices: FloatArray
    faces: IntArray
    rgba: Rgba | None = None


@dataclass(frozen=True)
class RobotRecord:
    """The robot as the run needs it.

    Attributes:
        joints: Movable joints in description order: the columns of the joint signals.
        groups: Joint names of each planning group.
        named_states: Group -> state -> joint -> position.
        static_links: Links that cannot move; they are no clearance finding against static objects.
        link_visuals: Shapes for pictures, by link.
        static_link_poses: T_world_link of `static_links` (xyz, quat wxyz).
        placements: Every link but the root, parents first.
    """

    name: str
    joints: tuple[JointRecord, ...]
    groups: Mapping[str, tuple[str, ...]]
    named_states: Mapping[str, Mapping[str, Mapping[str, float]]]
    arm_group: str
    tcp_link: str
    base_link: str
    link_names: tuple[str, ...]
    static_links: tuple[str, ...]
    gripper: GripperRecord | None = None
    link_visuals: Mapping[str, tuple[Shape, ...]] = field(
        default_factory=dict[str, tuple[Shape, ...]]
    )
    urdf: str = ""
    srdf: str = ""
    static_link_poses: Mapping[str, tuple[float, ...]] = field(
        default_factory=dict[str, tuple[float, ...]]
    )
    placements: tuple[LinkPlacement, ...] = ()

    @property
    def arm_joints(self) -> tuple[str, ...]:
        """Joints of the arm; every movable joint where the robot is a gripper alone."""
        return self.groups.get(self.arm_group) or tuple(joint.name for joint in self.joints)


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
    """

    object: str
    link: str
    start_time: float
    end_time: float
    pose_in_link: tuple[float, ...]
    represents: str


@dataclass(frozen=True)
class StepRecord:
    """One executed (or not executed) step.

    Attributes:
        id: The file's `id`, else its path (`steps[3]`, `steps[3].lift`).
        path: Place in the expanded file; the step's seed is made from it.
        verb: The verb: `move_to`, `lin`, ...
        summary: One line for a person: `move_to mogi_home`.
        line: The line in the scenario file, from 1; 0 if unknown.
        error_code: MoveIt error name of its failure, expected or not; empty when it succeeded.
        expected_error: What the file expects; empty when success is expected.
        start_time: The simulated time at its start [s].
        end_time: The simulated time at its end [s].
        start_index: First sample of the step.
        end_index: One past its last sample.
        trajectory: The commanded trajectory; None for steps without a motion.
        planner: Statistics: planner_id, checks, attempts, path lengths ...
        explanation: Plain data: IK solutions and what became of them, blocking pairs, nearest pose.
        result: What the step reports; `harness.recording.step_results` has the common parts.
    """

    id: str
    path: str
    verb: str
    summary: str
    line: int
    status: StepStatus
    start_time: float = 0.0
    end_time: float = 0.0
    start_index: int = 0
    end_index: int = 0
    error_code: str = ""
    expected_error: str = ""
    message: str = ""
    trajectory: JointTrajectory | None = None
    planner: Mapping[str, Any] = field(default_factory=dict[str, Any])
    explanation: Mapping[str, Any] = field(default_factory=dict[str, Any])
    result: Details = field(default_factory=Details)


def is_nested(inner: str, outer: str) -> bool:
    """Whether the step at one path is nested in the step at another."""
    return inner.startswith((f"{outer}.", f"{outer}["))


@dataclass(frozen=True)
class Measure:
    """A measured quantity against its limit.

    Attributes:
        name: What was measured: `TCP position error`.
        value: The value in `unit`.
        limit: What it is compared with, in `unit`; NaN where there is none.
        comparison: How value must stand to limit.
        unit: `m`, `rad`, `s`, `N`, `1`.
        time: Simulation time of the sample [s].
        detail: The joint, link or pair that was measured.
        expected: Where in the world something was to be (xyz), where the value is a distance.
        actual: Where it was (xyz).
        ceiling: The largest value that can be measured, in `unit`, as 1 is of a share; inf where
            there is none.
        plot: The plot of the report that shows the quantity; empty where none does.
    """

    name: str
    value: float
    limit: float
    comparison: Literal["<=", ">=", "=="]
    unit: str
    time: float
    detail: str = ""
    expected: Floats = ()
    actual: Floats = ()
    ceiling: float = float("inf")
    plot: str = ""

    def __str__(self) -> str:
        where = f" ({self.detail})" if self.detail else ""
        sign = self.comparison
        unit = "" if self.unit == "1" else f" {self.unit}"
        value, limit = distinct(
            self.value, self.limit, lambda number, more: f"{number:.{6 + more}g}"
        )
        said = f"{self.name}: {value}{unit} (must be {sign} {limit})"
        return f"{said} at t={self.time:.3f} s{where}"


@dataclass(frozen=True)
class Observed:
    """How much of a run a verdict is based on.

    Attributes:
        samples: Samples of the window at which the expectation applies and its value is known.
        unknown: Samples at which it applies and its value is not known.
        pairs: Pairs of bodies whose contact or distance it reads; None where it reads none.
        premises: Samples at which the premise of a formula's implication holds, the least of its
            implications; None without one.
    """

    samples: int
    unknown: int = 0
    pairs: int | None = None
    premises: int | None = None


@dataclass(frozen=True)
class VerdictWarning:
    """Why a verdict that passed shows less than it seems to.

    Attributes:
        name: One of a few fixed names: `already true at the start`, `premise never held`.
        message: One sentence with the numbers.
    """

    name: str
    message: str

    def __str__(self) -> str:
        return f"{self.name}: {self.message}"


@dataclass(frozen=True)
class Verdict:
    """The result of an expectation.

    Attributes:
        expectation: Its text, one line: `never: collision between robot and Table`.
        margin: How far from flipping, in `unit`; positive when passed, negative when failed.
        time: The sample that decided it [s]; NaN when none did.
        line: The line in the scenario file; 0 if unknown.
        step: Id of the step it stands on; empty for the whole run.
        reason: One sentence with the numbers, for a failure why.
        measures: What was measured at the deciding sample.
        observed: How much it is based on; None where nothing could be judged.
        warnings: Why it shows less than it seems to; `--strict` turns them into failures.
    """

    expectation: str
    status: VerdictStatus
    margin: float = float("nan")
    unit: str = ""
    time: float = float("nan")
    line: int = 0
    step: str = ""
    reason: str = ""
    measures: tuple[Measure, ...] = ()
    points: float | None = None
    observed: Observed | None = None
    warnings: tuple[VerdictWarning, ...] = ()


@dataclass(frozen=True)
class Finding:
    """Something a person should know that is no verdict: plan against physics, notes, fallbacks."""

    kind: str
    message: str
    time: float = float("nan")
    step: str = ""
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True)
class ContactRecord:
    """Two bodies that touched, allowed or not.

    Attributes:
        pair: Names of links or objects, as in `Signals.contact_forces`.
        first_time: When they touched first [s].
        duration: How long they touched, all in all [s].
        peak_force: Largest normal force [N].
        is_collision: Whether any of it is a collision, by what the expectation `collision` counts.
    """

    pair: Pair
    first_time: float
    duration: float
    peak_force: float
    is_collision: bool


@dataclass(frozen=True)
class CaptureRecord:
    """Pictures that a camera took in one moment, all of the same recorded state.

    Attributes:
        camera: Name of one of `Run.cameras`.
        time: The simulated time of the picture [s].
        step: Id of the `capture` step; empty when an expectation needed the picture.
        backend: Who drew them: `rays`, the same on every machine.
        files: Path in `Run.files` by kind: `color` (PNG or JPEG, with the camera's noise), `depth`
            (.npz, array `depth` of float32 metres along the optical axis, shape (height, width),
            inf where nothing is within the clip distances), `segmentation` (PNG of `labels`), and
            of what a `capture` step took `depth_preview` and `segmentation_preview` (PNG).
        pose: T_world_optical (xyz, quat wxyz): z forward, x right, y down.
        labels: Pixel value in `segmentation` of every link and object; 0 is none of them.
        outlines: Pixels that each object would have if nothing hid it and the picture had no edge;
            with `segmentation`, for those in front of the camera.
    """

    camera: str
    time: float
    sample: int
    step: str = ""
    backend: str = "rays"
    files: Mapping[str, str] = field(default_factory=dict[str, str])
    pose: Floats = ()
    labels: Mapping[str, int] = field(default_factory=dict[str, int])
    outlines: Mapping[str, int] = field(default_factory=dict[str, int])


@dataclass(frozen=True)
class VideoRecord:
    """What a camera saw all along.

    Attributes:
        camera: Name of one of `Run.cameras`.
        file: VP8 WebM in `Run.files`, of the camera's size; frame i is shown at i / `rate` of the
            video's own clock.
        times: Simulation time of every frame [s], rising evenly by 1 / `rate`.
        rate: Frames a second of simulated time.
        width: The width in pixels: the camera's, made even.
        height: The height in pixels: the camera's, made even.
        backend: Who drew it: `egl`, `osmesa` or `rays`.
    """

    camera: str
    file: str
    times: Floats
    rate: float
    width: int
    height: int
    backend: str


@dataclass(frozen=True, eq=False)
class Signals:
    """Recorded arrays; row i of each belongs to `times[i]`.

    Attributes:
        times: Simulation time of every physics sample [s], shape (N,).
        joint_positions: Measured, description order, shape (N, n).
        joint_velocities: Measured, shape (N, n).
        joint_efforts: Applied by the actuators, shape (N, n) [N m or N].
        joint_commands: Commanded positions, shape (N, n); NaN for mimic joints.
        joint_command_velocities: Commanded velocities, shape (N, n); NaN for mimic joints.
        tcp_pose: T_world_tcp, shape (N, 7): xyz, quat wxyz.
        frames: T_world_link of the links that expectations observe, (N, 7) each.
        object_poses: T_world_object, (N, 7) each; NaN while absent. Simulated objects as the
            physics had them, those of the planning scene alone as the planner believed them.
        contact_forces: Normal force [N] between two bodies that ever touched, (N,) each; keys are
            (body, body), robot link first, else sorted. Zero means no contact.
        presses: Where a robot link presses on another body, and how: mean of the contact points,
            weighted by their normal forces (world xyz), and the sum of these forces on the other
            body (world xyz) [N], (N, 6) each; NaN without force; keys as in `contact_forces`.
        frictions: Friction force of a robot link on another body (world xyz) [N], (N, 3) each; zero
            without contact; keys as in `presses`. A pair that is not in it was recorded without.
        support_forces: Upward part of the normal force [N] that the first of two objects exerts on
            the second; negative where the second carries the first. (N,) each; keys as in
            `contact_forces`, of objects alone. A pair that is not in it was recorded without.
        clearances: Distance [m] between the robot (key `robot`), or a held object (its name), and
            an object, or `robot` and itself: (N,) each; NaN while either is absent. Capped at
            `clearance_cutoff`: a value there means "at least that far".
        clearance_links: The robot link that was nearest, as an index into the robot's link_names,
            (N,) each, for keys of `clearances` that start with `robot`; -1 where none.
        link_overlaps: How deep two links are inside each other [m] whose contact the SRDF excludes
            from the physics, (N,) each; only pairs that overlap in the run and do not with every
            joint at zero.
        planned_clearances: The clearances had the arm been at its commands; recorded when an
            expectation needs them.
    """

    times: FloatArray
    joint_positions: FloatArray
    joint_velocities: FloatArray
    joint_efforts: FloatArray
    joint_commands: FloatArray
    joint_command_velocities: FloatArray
    tcp_pose: FloatArray
    frames: Mapping[str, FloatArray] = field(default_factory=dict[str, FloatArray])
    object_poses: Mapping[str, FloatArray] = field(default_factory=dict[str, FloatArray])
    contact_forces: Mapping[Pair, FloatArray] = field(
        default_factory=dict[tuple[str, str], FloatArray]
    )
    presses: Mapping[Pair, FloatArray] = field(default_factory=dict[tuple[str, str], FloatArray])
    frictions: Mapping[Pair, FloatArray] = field(default_factory=dict[tuple[str, str], FloatArray])
    support_forces: Mapping[Pair, FloatArray] = field(
        default_factory=dict[tuple[str, str], FloatArray]
    )
    clearances: Mapping[Pair, FloatArray] = field(default_factory=dict[tuple[str, str], FloatArray])
    clearance_links: Mapping[Pair, IntArray] = field(
        default_factory=dict[tuple[str, str], np.ndarray]
    )
    planned_clearances: Mapping[Pair, FloatArray] = field(
        default_factory=dict[tuple[str, str], FloatArray]
    )
    link_overlaps: Mapping[Pair, FloatArray] = field(
        default_factory=dict[tuple[str, str], FloatArray]
    )
    clearance_cutoff: float = 0.15


@dataclass(frozen=True)
class Run:
    """A whole run of one case.

    Attributes:
        file: The path as the user named it.
        case: Empty when the file has one case.
        attachments: What the planner believed to hold.
        steps: The steps in execution order, nested ones flat.
        signals: The signals that were recorded.
        gravity: The gravity vector in the world [m/s^2].
        timestep: The timestep of the physics [s].
        allowed_contacts: Link or object pairs whose contact is no collision (the SRDF's).
        findings: The notes, and where plan and physics disagree.
        contacts: Every pair that touched, the first to touch first.
        source: Text of the scenario file.
        resolved: Text of the resolved scenario; runs again to the same digest.
        versions: The version of every library that could change a number.
        ended_early: Why the run stopped before its last step; empty when it did not.
        unrecorded: Names of `Signals`' fields that were not recorded, as a bag has no contacts, and
            `attachments` and `steps`; an expectation that needs one is not observable.
        meshes: The triangles of mesh files, for pictures where the files are not.
        cameras: Every camera of robot, world and scenario.
        captures: Pictures taken, in order of time.
        videos: The videos of the cameras that were recorded all along.
        commands: What external programs commanded, in the order of arrival.
        files: Content of the pictures and videos by path in the run's folder; a saved run reads
            each on first use.
    """

    scenario: str
    file: str
    case: str
    seed: int
    robot: RobotRecord
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
    resolved: str = ""
    versions: Mapping[str, str] = field(default_factory=dict[str, str])
    ended_early: str = ""
    unrecorded: tuple[str, ...] = ()
    meshes: tuple[MeshRecord, ...] = ()
    cameras: tuple[Camera, ...] = ()
    captures: tuple[CaptureRecord, ...] = ()
    videos: tuple[VideoRecord, ...] = ()
    commands: tuple[CommandRecord, ...] = ()
    files: Mapping[str, bytes] = field(default_factory=dict[str, bytes], repr=False)

    @property
    def duration(self) -> float:
        """Length of the run in simulation time [s]."""
        return float(self.signals.times[-1])
