"""Every step a scenario may say. One model a verb; `do` is the verb."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from harness.core.errors import ErrorCode
from harness.spec.base import (
    Angle,
    AngularVelocity,
    Count,
    Duration,
    Flag,
    Force,
    Fraction,
    JointEffort,
    JointValue,
    Length,
    LinearAcceleration,
    LinearVelocity,
    Name,
    NonNegativeLength,
    Number,
    PositiveDuration,
    PositiveLength,
    SpecModel,
    kind_of,
)
from harness.spec.checks import Expectation
from harness.spec.goals import GOAL_KEYS, GoalFields
from harness.spec.planning import PathConstraints, Planning
from harness.spec.poses import Direction, Pose, Position
from harness.spec.world import ObjectSpec

GripperAction = Literal["friction", "weld"]
PushForce = tuple[Force, Force, Force]


class StepFields(SpecModel):
    """Words that stand beside the verb of any step."""

    id: Name | None = Field(default=None, description="To speak of the step elsewhere; unique.")
    name: str | None = Field(default=None, description="For people.")
    group: Name | None = Field(default=None, description="SRDF planning group; default: the arm's.")
    expect: tuple[Expectation, ...] = Field(default=(), description="Judged over this step.")
    expect_error: ErrorCode | None = Field(
        default=None, description="The step must fail with this moveit_msgs/MoveItErrorCodes name."
    )
    timeout: PositiveDuration | None = Field(default=None, description="In simulated seconds.")
    planning: Planning | None = Field(
        default=None, description="Overrides the scenario's `planning`."
    )


class MoveTo(GoalFields, StepFields):
    """Plan a collision-free motion to a goal, then execute it.

    Where joint positions can be chosen (branches of a pose, several goals, a region), those are
    taken that the arm reaches with the least motion.
    """

    goal_keys: ClassVar[tuple[str, ...]] = (*GOAL_KEYS, "any_of")

    do: Literal["move_to"] = "move_to"
    any_of: Annotated[tuple[GoalFields, ...], Field(min_length=1, max_length=100)] | None = Field(
        default=None, description="Several goals: the one that is cheapest to reach is taken."
    )
    path_constraints: PathConstraints | None = Field(
        default=None, description="Held on every sample of the motion."
    )


class CartesianLimits(SpecModel):
    """Pilz's cartesian limits; given here they hold as they are, whatever the scaling factors.

    What is not given is 1 m/s, 2.25 m/s**2 and 1.57 rad/s times the scaling factors.
    """

    max_trans_vel: Annotated[LinearVelocity, Field(gt=0)] | None = Field(
        default=None, description="Speed of the link [m/s]."
    )
    max_trans_acc: Annotated[LinearAcceleration, Field(gt=0)] | None = Field(
        default=None,
        description="Of the link, towards an arc's centre too [m/s**2].",
    )
    max_rot_vel: Annotated[AngularVelocity, Field(gt=0)] | None = Field(
        default=None, description="Turning speed of the link [rad/s]."
    )


class Ptp(GoalFields, StepFields):
    """Pilz PTP: all joints together, straight in joint space."""

    do: Literal["ptp"] = "ptp"
    duration: PositiveDuration | None = Field(
        default=None, description="Of the motion: a JointTrajectory point's time_from_start [s]."
    )


class LineFields(GoalFields):
    """A straight line of the link to a goal."""

    cartesian_limits: CartesianLimits | None = Field(
        default=None, description="Of the link on its way."
    )


class ArcFields(LineFields):
    """An arc of the link to a goal, through `interim` or about `center`."""

    interim: Position | None = Field(
        default=None, description="A point on the arc, which may be any but a full circle."
    )
    center: Position | None = Field(
        default=None, description="The centre of the shorter arc, which is less than half a circle."
    )

    @model_validator(mode="after")
    def _one_auxiliary(self) -> ArcFields:
        if (self.interim is None) == (self.center is None):
            raise ValueError("an arc has exactly one of `interim` and `center`")
        return self


class Lin(LineFields, StepFields):
    """Pilz LIN: the link moves on a straight line."""

    do: Literal["lin"] = "lin"


class Circ(ArcFields, StepFields):
    """Pilz CIRC: the link moves on an arc, through `interim` or about `center`."""

    do: Literal["circ"] = "circ"


class MoveRelative(StepFields):
    """Task Constructor's MoveRelative: a straight move, or a turn, by a distance."""

    do: Literal["move_relative"] = "move_relative"
    direction: Direction | None = Field(default=None, description="Translate along this.")
    rotation: Direction | None = Field(
        default=None, description="Turn about this axis through the link."
    )
    distance: Annotated[Length, Field(gt=0)] | None = Field(
        default=None, description="Exactly so far [m]."
    )
    min_distance: PositiveLength | None = Field(default=None, description="At least so far [m].")
    max_distance: PositiveLength | None = Field(default=None, description="At most so far [m].")
    angle: Annotated[Angle, Field(gt=0)] | None = Field(
        default=None, description="With `rotation` [rad]."
    )
    link: Name | None = Field(default=None, description="Default: the TCP.")

    @model_validator(mode="after")
    def _one_amount(self) -> MoveRelative:
        if (self.direction is None) == (self.rotation is None):
            raise ValueError("exactly one of `direction` and `rotation`")
        if self.rotation is not None:
            if self.angle is None:
                raise ValueError("a `rotation` has an `angle`")
            if any((self.distance, self.min_distance, self.max_distance)):
                raise ValueError("a `rotation` has an `angle`, a `direction` has a distance")
            return self
        if self.angle is not None:
            raise ValueError("an `angle` goes with `rotation`")
        if self.distance is not None and (self.min_distance or self.max_distance):
            raise ValueError("either `distance`, or `min_distance` and `max_distance`")
        if self.distance is None and self.max_distance is None:
            raise ValueError("a `direction` has a `distance`, or a `max_distance`")
        if self.min_distance and self.max_distance and self.min_distance > self.max_distance:
            raise ValueError("`min_distance` is more than `max_distance`")
        return self


class JumpThreshold(SpecModel):
    """Largest joint step between neighbouring waypoints."""

    revolute: Annotated[Angle, Field(gt=0)] = Field(
        default=0.5, description="Of a turning joint [rad]."
    )
    prismatic: PositiveLength = Field(default=0.1, description="Of a sliding joint [m].")


class Waypoint(Pose):
    """A pose; without a rotation the link stays turned as it is."""


class CartesianPath(StepFields):
    """MoveIt's computeCartesianPath: straight lines of the link through waypoints.

    Corners are rounded within the precision, so that the link need not stop there. The step reports
    the `fraction` of the path that was followed, the `largest_joint_step` from one pose to the
    next, and the `deviation` of the final samples from the lines.
    """

    do: Literal["cartesian_path"] = "cartesian_path"
    waypoints: Annotated[tuple[Waypoint, ...], Field(min_length=1, max_length=1000)] = Field(
        description="Poses of the link, in order; without a rotation it stays turned as it is."
    )
    link: Name | None = Field(default=None, description="Default: the TCP.")
    max_step: Annotated[Length, Field(ge=1e-4)] = Field(
        default=0.005, description="Distance between the poses solved for [m]."
    )
    precision: Annotated[Length, Field(ge=1e-4)] = Field(
        default=0.001,
        description="Largest deviation from the straight lines, corners included [m].",
    )
    min_fraction: Fraction = Field(
        default=1.0, description="Share of the path that must be reached."
    )
    jump_threshold: JumpThreshold = Field(
        default=JumpThreshold(), description="Ends a path where a joint jumps."
    )
    cartesian_limits: CartesianLimits | None = Field(
        default=None, description="Of the link on its way."
    )


class SequenceItem(SpecModel):
    """One motion of a sequence, and how it blends into the next."""

    ptp: GoalFields | None = Field(default=None, description="A joint motion: see `ptp`.")
    lin: LineFields | None = Field(default=None, description="A straight line: see `lin`.")
    circ: ArcFields | None = Field(default=None, description="An arc: see `circ`.")
    blend_radius: NonNegativeLength = Field(
        default=0.0,
        description="Inside this distance of its goal it goes over into the next motion [m]; 0: "
        "it stops there.",
    )

    @model_validator(mode="after")
    def _one_motion(self) -> SequenceItem:
        if sum(motion is not None for motion in (self.ptp, self.lin, self.circ)) != 1:
            raise ValueError("an item is exactly one of ptp, lin, circ")
        return self


class Sequence(StepFields):
    """Pilz's motion sequence: all motions or none, blended into each other.

    The blend radii of two motions that follow each other are together less than the distance
    between their goals.
    """

    short = "items"
    short_is_list = True

    do: Literal["sequence"] = "sequence"
    items: Annotated[tuple[SequenceItem, ...], Field(min_length=1, max_length=1000)] = Field(
        description="In order."
    )


class Gripper(StepFields):
    """GripperCommand: a named state, `position`, or `width`."""

    short = "named_target"

    do: Literal["gripper"] = "gripper"
    named_target: Name | None = Field(
        default=None, description="An SRDF group state of the gripper."
    )
    position: JointValue | None = Field(default=None, description="Of the gripper's joint.")
    width: NonNegativeLength | None = Field(default=None, description="Gap between the pads [m].")
    max_effort: Annotated[JointEffort, Field(gt=0)] | None = Field(
        default=None, description="Effort limit of the gripper's joint; default from the robot."
    )

    @model_validator(mode="after")
    def _one_target(self) -> Gripper:
        given = [k for k in ("named_target", "position", "width") if getattr(self, k) is not None]
        if len(given) != 1:
            raise ValueError("exactly one of a named state, `position`, `width`")
        return self


class Grasp(StepFields):
    """Close until both finger sides touch the object, verify, attach it in the planning scene."""

    short = "object"

    do: Literal["grasp"] = "grasp"
    object: Name = Field(description="Its name.")
    mode: GripperAction = Field(
        default="friction", description="`weld` fixes it in the physics too."
    )
    max_effort: Annotated[JointEffort, Field(gt=0)] | None = Field(
        default=None,
        description="Effort limit of the gripper's joint while it holds; default from the robot.",
    )
    position: JointValue | None = Field(
        default=None, description="Closes to here at most; default closed."
    )


class Release(StepFields):
    """Open, verify that nothing is held, detach in the planning scene."""

    short = "object"

    do: Literal["release"] = "release"
    object: Name | None = Field(default=None, description="Default: what was grasped last.")
    named_target: Name | None = Field(
        default=None, description="Default: the gripper's open position."
    )
    position: JointValue | None = Field(
        default=None, description="Of the gripper's joint; instead of `named_target`."
    )


class AttachObject(StepFields):
    """Fix an object to a link, in the planning scene alone."""

    short = "object"

    do: Literal["attach_object"] = "attach_object"
    object: Annotated[
        Annotated[Name, Tag("one")] | Annotated[ObjectSpec, Tag("many")], Discriminator(kind_of)
    ] = Field(description="A name in the scene, or a new object.")
    link: Name | None = Field(default=None, description="Default: the TCP link.")
    touch_links: tuple[Name, ...] | None = Field(
        default=None, description="Links that may touch it; default: the gripper's."
    )
    represents: Name | None = Field(
        default=None,
        description="The physical object it stands for; leaves the planning scene until detached.",
    )


class DetachObject(StepFields):
    """Let go of an attached object, in the planning scene alone."""

    short = "object"

    do: Literal["detach_object"] = "detach_object"
    object: Name = Field(description="Its name.")


class AddObject(StepFields):
    """Add one or several objects."""

    short = "objects"
    short_is_list = True

    do: Literal["add_object"] = "add_object"
    objects: Annotated[tuple[ObjectSpec, ...], Field(min_length=1)] = Field(
        description="One or several; a physical one falls from where it is put."
    )


class RemoveObject(StepFields):
    """Remove one or several objects."""

    short = "objects"
    short_is_list = True

    do: Literal["remove_object"] = "remove_object"
    objects: Annotated[tuple[Name, ...], Field(min_length=1)] = Field(description="Their names.")


class MoveObject(StepFields):
    """Put an object somewhere else, at rest."""

    do: Literal["move_object"] = "move_object"
    object: Name = Field(description="Its name.")
    pose: Pose = Field(description="Where it shall be.")


class ClearObjects(StepFields):
    """Remove what steps added; with `world: true` the world's objects too."""

    do: Literal["clear_objects"] = "clear_objects"
    world: Flag = Field(default=False, description="The world's objects too.")


class AllowCollisions(StepFields):
    """Allow collisions of pairs while the nested steps run."""

    do: Literal["allow_collisions"] = "allow_collisions"
    pairs: Annotated[tuple[tuple[Name, Name], ...], Field(min_length=1)] = Field(
        description="Two names each: links or objects."
    )
    during: Annotated[tuple[Step, ...], Field(min_length=1)] = Field(
        description="The steps for which this holds."
    )


class Travel(SpecModel):
    """A straight move of a pick or place."""

    direction: Direction | None = Field(
        default=None, description="Default: as said where this stands."
    )
    min_distance: PositiveLength | None = Field(default=None, description="At least so far [m].")
    max_distance: PositiveLength | None = Field(default=None, description="At most so far [m].")
    distance: PositiveLength | None = Field(default=None, description="Exactly so far [m].")


class Pick(StepFields):
    """Approach, grasp, lift; expands into the steps it is made of.

    Without a `grasp_pose` the object's shape gives the grasps from above that are as good as each
    other: half a turn of the gripper, a box's other side if it fits, eight turns about what is
    round. With a `grasp_pose` that has no rotation the same rotations are tried at its point. The
    first grasp that the arm can approach, and lift from, is taken; the step reports which `grasp`
    of how many `grasps`.

    An arm of fewer than six joints turns to the object by itself: it grasps the middle of the
    object, or its upper part, with the first pitch of the gripper that works, from level (0) to
    straight down (90 deg); `pitch` states one.

    The planner's `padding` does not apply between the gripper and the object to grasp.
    """

    short = "object"

    do: Literal["pick"] = "pick"
    object: Name = Field(description="Its name.")
    grasp_pose: Pose | None = Field(
        default=None,
        description="Pose of the TCP, or its position alone; default: from the object's shape.",
    )
    pitch: Angle | None = Field(
        default=None,
        description="Angle of the gripper below the horizontal, for arms of fewer than six joints;"
        " default: the first of 0 to 90 deg that works.",
    )
    approach: Travel | None = Field(
        default=None,
        description="Default: along the gripper, 10 cm or as much as the arm can follow, at least"
        " 3 cm.",
    )
    lift: Travel | None = Field(default=None, description="Default: 10 cm up.")
    mode: GripperAction = Field(default="friction", description="How it is held: see `grasp`.")
    max_effort: Annotated[JointEffort, Field(gt=0)] | None = Field(
        default=None,
        description="Effort limit of the gripper's joint while it holds; default from the robot.",
    )

    @model_validator(mode="after")
    def _one_rotation(self) -> Pick:
        if self.pitch is not None and self.grasp_pose is not None and self.grasp_pose.has_rotation:
            raise ValueError(
                "`pitch` goes with a `grasp_pose` without rotation; this one has its own rotation"
            )
        return self


class Place(StepFields):
    """Approach, lower, release, retreat; expands into the steps it is made of.

    Where the arm cannot lower the object to a `pose` without a rotation, or not open its hand
    there, the object is turned about the vertical, if it looks the same then: by a half, what is
    square by quarters, what is round by eighths; the step reports which `turn` of how many `turns`.
    A `pose` with a rotation is kept to. An arm of fewer than six joints brings the object to the
    position alone, with the pitch that the gripper has: the object turns with the arm.
    """

    do: Literal["place"] = "place"
    object: Name | None = Field(default=None, description="Default: what was picked last.")
    pose: Pose = Field(description="Where the object shall stand.")
    approach: Travel | None = Field(
        default=None,
        description="Default: straight down, 10 cm or as much as the arm can follow, at least 3"
        " cm.",
    )
    retreat: Travel | None = Field(
        default=None, description="Default: 3 to 10 cm back along the gripper."
    )


class Capture(StepFields):
    """Wait for a camera's next picture and keep it; it is drawn after the run."""

    short = "camera"

    do: Literal["capture"] = "capture"
    camera: Name = Field(description="Its name.")
    kinds: Annotated[
        tuple[Literal["color", "depth", "segmentation"], ...], Field(min_length=1, max_length=3)
    ] = Field(default=("color",), description="Which images.")


class Wait(StepFields):
    """Let simulated time pass."""

    short = "duration"

    do: Literal["wait"] = "wait"
    duration: PositiveDuration = Field(description="[s]")


class Settle(StepFields):
    """Wait until everything is slower than a limit."""

    short = "max_velocity"

    do: Literal["settle"] = "settle"
    max_velocity: Annotated[LinearVelocity, Field(gt=0)] = Field(
        default=1e-3, description="Of objects [m/s] and joints [rad/s]."
    )


class Inject(StepFields):
    """A fault of the physics, with a receipt: `landed`, or `no_effect` and why.

    A push lasts `push_duration`; every other fault lasts until another `inject` sets it back.
    """

    do: Literal["inject"] = "inject"
    friction: dict[Name, Annotated[Number, Field(ge=0, le=100)]] | None = Field(
        default=None, description="Object -> coefficient of sliding friction of its surface."
    )
    gripper_effort: Fraction | None = Field(
        default=None, description="Share of its effort that the gripper has left; 1 sets it back."
    )
    joint_stall: Name | None = Field(
        default=None, description="The joint that stays where it is from now on."
    )
    push: dict[Name, PushForce] | None = Field(
        default=None, description="Object -> force [N] along the world's x, y, z."
    )
    push_duration: PositiveDuration = Field(
        default=0.1, description="How long a push lasts; the step takes so long [s]."
    )
    sensor_noise: Annotated[Angle, Field(ge=0)] | None = Field(
        default=None,
        description="Standard deviation of measured joint positions [rad or m]; 0 sets it back.",
    )
    command_latency: Annotated[Duration, Field(le=1)] | None = Field(
        default=None, description="Commands reach the motors so much later [s]; 0 sets it back."
    )

    @model_validator(mode="after")
    def _any(self) -> Inject:
        faults = self.model_fields_set - StepFields.model_fields.keys() - {"do", "push_duration"}
        if not faults:
            raise ValueError(
                "say which fault: friction, gripper_effort, joint_stall, push, sensor_noise,"
                " command_latency"
            )
        if "push_duration" in self.model_fields_set and self.push is None:
            raise ValueError("`push_duration` goes with `push`")
        return self


class Repeat(StepFields):
    """The same steps several times; an `id` inside gets `#1`, `#2` ... behind it."""

    do: Literal["repeat"] = "repeat"
    times: Annotated[Count, Field(ge=1, le=1000)] = Field(description="How often.")
    steps: Annotated[tuple[Step, ...], Field(min_length=1)] = Field(description="What is repeated.")


class Parallel(StepFields):
    """One motion of the arm and one `gripper` step at once; it ends when both have."""

    short = "steps"
    short_is_list = True

    do: Literal["parallel"] = "parallel"
    steps: Annotated[tuple[Step, ...], Field(min_length=2)] = Field(
        description="A motion of the arm, and a `gripper` step."
    )


class Include(StepFields):
    """The steps of another file; with an `id`, theirs get it and a dot in front.

    The file has `steps`, and `params` with their defaults; it knows no others.
    """

    short = "file"

    do: Literal["include"] = "include"
    file: str = Field(description="Path from this file.")
    params: dict[Name, Any] = Field(default_factory=dict, description="For `${name}` in that file.")


AnyStep = (
    MoveTo
    | Ptp
    | Lin
    | Circ
    | MoveRelative
    | CartesianPath
    | Sequence
    | Gripper
    | Grasp
    | Release
    | AttachObject
    | DetachObject
    | AddObject
    | RemoveObject
    | MoveObject
    | ClearObjects
    | AllowCollisions
    | Pick
    | Place
    | Capture
    | Wait
    | Settle
    | Inject
    | Repeat
    | Parallel
    | Include
)
Step = Annotated[AnyStep, Field(discriminator="do")]

for _model in (AllowCollisions, Repeat, Parallel):
    _model.model_rebuild()
