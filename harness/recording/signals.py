"""What was recorded at every physics sample: joints, poses, contacts, distances, pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from harness.core.types import FloatArray, Floats, IntArray, Pair

ByPair = dict[Pair, FloatArray]
ByName = dict[str, FloatArray]

UNPUBLISHED = (
    *("contact_forces", "presses", "frictions", "pulls", "support_forces"),
    *("slides", "link_overlaps", "planned_clearances"),
)
"""Signals that no topic of a robot carries, and that no recording of its topics contains."""


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
        pulls: Force of a suction cup's vacuum on another body (world xyz) [N], and the number of
            quarters of its rim that touch the body, (N, 4) each; zero where the valve is shut; keys
            (link of the cup, body).
        wrenches: What each sensor of force and torque reads, in its axes: force [N], then torque
            [N m], (N, 6) each; with its noise, held at its rate, less its tare.
        surfaces: The velocity of the surface of each belt and turntable at its origin, in its axes
            [m/s], and its turn about z [rad/s], since the sample before, (N, 4) each.
        support_forces: Upward part of the normal force [N] that the first of two objects exerts on
            the second; negative where the second carries the first. (N,) each; keys as in
            `contact_forces`, of objects alone. A pair that is not in it was recorded without.
        slides: How far two objects slid along each other since the sample before [m]: the largest
            way along the surface of any point at which they press each other. (N,) each; zero
            without contact; keys as in `support_forces`, of pairs with an object that the robot
            touches, or that touches such. A pair that is not in it was recorded without.
        clearances: Distance [m] between the robot (key `robot`), or a held object (its name), and
            an object, or `robot` and itself: (N,) each; NaN while either is absent, and of what the
            hand grips. Capped at `clearance_cutoff`: a value there means "at least that far".
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
    frames: Mapping[str, FloatArray] = field(default_factory=ByName)
    object_poses: Mapping[str, FloatArray] = field(default_factory=ByName)
    contact_forces: Mapping[Pair, FloatArray] = field(default_factory=ByPair)
    presses: Mapping[Pair, FloatArray] = field(default_factory=ByPair)
    frictions: Mapping[Pair, FloatArray] = field(default_factory=ByPair)
    pulls: Mapping[Pair, FloatArray] = field(default_factory=ByPair)
    wrenches: Mapping[str, FloatArray] = field(default_factory=ByName)
    surfaces: Mapping[str, FloatArray] = field(default_factory=ByName)
    support_forces: Mapping[Pair, FloatArray] = field(default_factory=ByPair)
    slides: Mapping[Pair, FloatArray] = field(default_factory=ByPair)
    clearances: Mapping[Pair, FloatArray] = field(default_factory=ByPair)
    clearance_links: Mapping[Pair, IntArray] = field(default_factory=dict[Pair, IntArray])
    planned_clearances: Mapping[Pair, FloatArray] = field(default_factory=ByPair)
    link_overlaps: Mapping[Pair, FloatArray] = field(default_factory=ByPair)
    clearance_cutoff: float = 0.15
