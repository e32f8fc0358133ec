"""Every expectation a scenario may state. One model a predicate; `check` is its name.

A predicate stands bare, or inside a temporal word. Bare, it is judged by its `judged` word:
`at_end` at the last sample of its step or run, `always` over all of them, `eventually` at any.
"""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, Field, model_validator

from harness.spec.base import (
    Angle,
    AngularVelocity,
    Count,
    Duration,
    Flag,
    Force,
    Fraction,
    JointValue,
    LinearVelocity,
    Name,
    NonNegativeAngle,
    NonNegativeLength,
    Number,
    PositiveDuration,
    PositiveLength,
    Share,
    SpecModel,
)
from harness.spec.formula_parser import readable
from harness.spec.markers import MarkerName
from harness.spec.poses import Pose, PoseTolerance

ColorName = Literal["red", "orange", "yellow", "green", "cyan", "blue", "purple", "pink"]
Judged = Literal["at_end", "always", "eventually"]


class CheckFields(SpecModel):
    """Words that stand in any predicate."""

    judged: ClassVar[Judged] = "at_end"

    for_: PositiveDuration | None = Field(
        default=None, alias="for", description="Must hold this long without a break [s]."
    )
    within: PositiveDuration | None = Field(
        default=None, description="Must come true within this time of the window's start [s]."
    )
    during: Name | None = Field(default=None, description="Judged over the step with this id.")
    points: Annotated[Number, Field(ge=0)] | None = Field(
        default=None, description="Of a graded scenario."
    )
    name: str | None = Field(default=None, description="For people.")


class ObjectCheck(CheckFields):
    """A predicate of one object; `- lifted: red_box` is short for `{object: red_box}`."""

    short = "object"

    object: Name = Field(description="Its name.")


class Lifted(ObjectCheck):
    """The object is higher than at the start and nothing but the gripper holds it up."""

    judged = "eventually"
    check: Literal["lifted"] = "lifted"
    above: PositiveLength = Field(default=0.01, description="Above its own start height [m].")


class Grasped(ObjectCheck):
    """Both finger sides touch the object and it moves with the gripper."""

    check: Literal["grasped"] = "grasped"
    min_force: Annotated[Force, Field(ge=0)] = Field(default=0.05, description="On each side [N].")
    max_slip: PositiveLength = Field(
        default=0.005, description="In the hand since the grasp began [m]."
    )
    max_rotation: NonNegativeAngle = Field(default=0.1, description="In the hand since then [rad].")


class Released(ObjectCheck):
    """No part of the gripper touches the object, and it is not attached."""

    check: Literal["released"] = "released"


class Placed(ObjectCheck):
    """The object rests on a support, released and still, at a pose if one is given.

    A `pose` without a rotation allows every turn about the vertical after which the object looks
    the same, as `place` does.
    """

    check: Literal["placed"] = "placed"
    on: Name | None = Field(
        default=None, description="The supporting object; default: any but the robot."
    )
    pose: Pose | None = Field(
        default=None, description="Where it shall stand; anywhere if not given."
    )
    tolerance: PoseTolerance | None = Field(
        default=None, description="Of `pose`; default 1 cm, turns about the vertical free."
    )
    max_velocity: Annotated[LinearVelocity, Field(gt=0)] = Field(
        default=0.005, description="Slower than this is still [m/s]."
    )
    max_angular_velocity: Annotated[AngularVelocity, Field(gt=0)] = Field(
        default=0.05, description="And turning slower than this [rad/s]."
    )


class On(ObjectCheck):
    """The object stands on another: in contact, above it, its weight carried by it."""

    check: Literal["on"] = "on"
    support: Name = Field(description="What it stands on.")


class In(ObjectCheck):
    """The object's origin is inside the outline of a container that has not tipped over.

    The outline is the smallest box along the container's axes that holds all of its shapes.
    """

    check: Literal["in"] = "in"
    container: Name = Field(description="What it is in.")
    max_lean: Annotated[Angle, Field(gt=0)] = Field(
        default=0.7853981633974483,
        description="A container whose z axis leans further from the vertical has tipped [rad].",
    )


class Displaced(ObjectCheck):
    """The object is away from where it started."""

    check: Literal["displaced"] = "displaced"
    at_least: PositiveLength = Field(
        default=0.01, description="Distance from where it was at the start [m]."
    )


class Upright(ObjectCheck):
    """The object's z axis points up."""

    check: Literal["upright"] = "upright"
    tolerance: Annotated[Angle, Field(gt=0)] = Field(
        default=0.1, description="Angle to the vertical [rad]."
    )


class Static(CheckFields):
    """The object, or everything, moves slower than a limit."""

    short = "object"

    check: Literal["static"] = "static"
    object: Name | None = Field(
        default=None, description="Default: every dynamic object and the robot."
    )
    max_velocity: Annotated[LinearVelocity, Field(gt=0)] = Field(
        default=0.005, description="[m/s]; of joints [rad/s] or [m/s]."
    )
    max_angular_velocity: Annotated[AngularVelocity, Field(gt=0)] = Field(
        default=0.05, description="Of objects [rad/s]."
    )


class Between(CheckFields):
    """A predicate of two bodies: links, objects, `robot`, `gripper`."""

    short = "between"

    between: tuple[Name, Name] = Field(
        description="Two of: a link, an object, `robot`, `gripper`, `any`."
    )


class InContact(Between):
    """The two bodies touch."""

    judged = "eventually"
    check: Literal["in_contact"] = "in_contact"
    min_force: Annotated[Force, Field(ge=0)] = Field(default=0.0, description="[N]")


class Collision(CheckFields):
    """A contact that is neither allowed, nor a grasp, nor an object resting on its support."""

    short = "between"

    judged = "eventually"
    check: Literal["collision"] = "collision"
    between: tuple[Name, Name] | None = Field(
        default=None, description="Default: the robot and anything, what it holds and anything."
    )
    count_allowed: Flag = Field(
        default=False, description="Pairs that the SRDF or `allow_collisions` permits count too."
    )


class Clearance(CheckFields):
    """The distance between the two bodies is at least so much, or little less than planned."""

    short = "at_least"

    judged = "always"
    check: Literal["clearance"] = "clearance"
    between: tuple[Name, Name] = Field(
        default=("robot", "any"), description="`robot`, a held object's name, an object, `any`."
    )
    at_least: NonNegativeLength | None = Field(
        default=None, description="Smallest distance allowed [m]."
    )
    max_below_plan: PositiveLength | None = Field(
        default=None,
        description="How much nearer it may come than with the arm at its commands [m].",
    )

    @model_validator(mode="after")
    def _one(self) -> Clearance:
        if self.at_least is None and self.max_below_plan is None:
            raise ValueError("`at_least`, `max_below_plan`, or both")
        return self


class TcpPose(CheckFields):
    """The TCP, or another link, stands at a pose."""

    check: Literal["tcp_pose"] = "tcp_pose"
    pose: Pose = Field(description="Where it shall stand.")
    link: Name | None = Field(default=None, description="Default: the TCP.")
    tolerance: PoseTolerance = Field(
        default=PoseTolerance(), description="Default: 1 mm, 0.01 rad."
    )
    position_only: Flag = Field(default=False, description="Turned as it may.")


class Line(SpecModel):
    """A straight line between two points."""

    start: Pose = Field(description="Only its position counts.")
    end: Pose = Field(description="Only its position counts.")


class Arc(SpecModel):
    """An arc from start to end through a point."""

    start: Pose = Field(description="Only its position counts.")
    interim: Pose = Field(description="A point between.")
    end: Pose = Field(description="Only its position counts.")


class TcpPath(CheckFields):
    """The TCP follows a line or an arc: it stays near it and travels it from start to end.

    Without `line` and `arc` it is the line from where the step starts to its goal; of a `circ` step
    the arc.
    """

    judged = "always"
    check: Literal["tcp_path"] = "tcp_path"
    line: Line | None = Field(default=None, description="Another line.")
    arc: Arc | None = Field(default=None, description="Another arc.")
    max_deviation: PositiveLength = Field(default=0.001, description="Largest distance to it [m].")
    min_fraction: Fraction = Field(
        default=0.95, description="Share of it that must be travelled forwards within the window."
    )

    def corners(self) -> list[tuple[tuple[str, str], Pose]]:
        """Each point of the curve, with the keys that lead to it."""
        curves = (("line", self.line), ("arc", self.arc))
        return [
            ((name, key), getattr(curve, key))
            for name, curve in curves
            if curve is not None
            for key in type(curve).model_fields
        ]

    @model_validator(mode="after")
    def _one(self) -> TcpPath:
        if self.line is not None and self.arc is not None:
            raise ValueError("`line`, or `arc`, or neither for the step's own path: not both")
        return self


class Joints(CheckFields):
    """Joints stand at positions."""

    check: Literal["joints"] = "joints"
    positions: Annotated[dict[Name, JointValue], Field(min_length=1)] = Field(
        description="By name; the others stand as they may."
    )
    tolerance: Annotated[JointValue, Field(gt=0)] = Field(
        default=0.01, description="Of each joint."
    )


class NamedTarget(CheckFields):
    """A group stands at its named state."""

    short = "state"

    check: Literal["named_target"] = "named_target"
    state: Name = Field(description="An SRDF group state.")
    group: Name | None = Field(default=None, description="Default: the arm.")
    tolerance: Annotated[JointValue, Field(gt=0)] = Field(
        default=0.01, description="Of each joint."
    )


class GripperState(CheckFields):
    """The gripper stands at a named state, a position or a width, or is stalled."""

    short = "named_target"

    check: Literal["gripper"] = "gripper"
    named_target: Name | None = Field(
        default=None, description="An SRDF group state of the gripper."
    )
    position: JointValue | None = Field(default=None, description="Of the gripper's joint.")
    width: NonNegativeLength | None = Field(default=None, description="Gap between the pads [m].")
    tolerance: Annotated[JointValue, Field(gt=0)] = Field(
        default=0.02, description="Of the joint, or of the width."
    )
    stalled: Flag | None = Field(default=None, description="What the last gripper step reported.")

    @model_validator(mode="after")
    def _one(self) -> GripperState:
        given = [
            key
            for key in ("named_target", "position", "width", "stalled")
            if getattr(self, key) is not None
        ]
        if len(given) != 1:
            raise ValueError("exactly one of named_target, position, width, stalled")
        return self


class WithinLimits(CheckFields):
    """Joints stay within their limits.

    A controller that holds a joint at its limit deviates a little to either side: a measured
    position may exceed the limit by 0.001 rad or 0.1 mm, a measured velocity by 0.1 %. Commands and
    efforts have no tolerance. The gripper's joints and idle ones may sink into their stops by 2 %
    of their range.
    """

    judged = "always"
    check: Literal["within_limits"] = "within_limits"
    position: Flag = Field(default=True, description="Measured and commanded positions.")
    velocity: Flag = Field(default=True, description="Measured velocities.")
    acceleration: Flag = Field(default=False, description="Of the commanded trajectory.")
    effort: Flag = Field(default=True, description="Efforts of the motors.")


class TrackingError(CheckFields):
    """Joints stay near their commands."""

    short = "max"

    judged = "always"
    check: Literal["tracking_error"] = "tracking_error"
    max: Annotated[JointValue, Field(gt=0)] = Field(
        default=0.05, description="Of the worst joint: measured position against command."
    )


class Effort(CheckFields):
    """Joint efforts stay below a share of their limits."""

    short = "max_fraction"

    judged = "always"
    check: Literal["effort"] = "effort"
    max_fraction: Annotated[Share, Field(gt=0)] = Field(
        default=1.0, description="Of the worst joint; 1 is its limit."
    )


class DurationCheck(CheckFields):
    """The step, or the run, takes at most (at least) so long."""

    short = "at_most"

    check: Literal["duration"] = "duration"
    at_most: Duration | None = Field(default=None, description="Simulated time [s].")
    at_least: Duration | None = Field(default=None, description="Simulated time [s].")

    @model_validator(mode="after")
    def _one(self) -> DurationCheck:
        if self.at_most is None and self.at_least is None:
            raise ValueError("`at_most`, `at_least`, or both")
        return self


class PathLength(CheckFields):
    """The TCP travels at most (at least) so far."""

    short = "at_most"

    check: Literal["path_length"] = "path_length"
    at_most: PositiveLength | None = Field(default=None, description="Largest length [m].")
    at_least: PositiveLength | None = Field(default=None, description="Smallest length [m].")

    @model_validator(mode="after")
    def _one(self) -> PathLength:
        if self.at_most is None and self.at_least is None:
            raise ValueError("`at_most`, `at_least`, or both")
        return self


class FractionCheck(CheckFields):
    """Every `cartesian_path` of the window was followed at least so far."""

    short = "at_least"

    check: Literal["fraction"] = "fraction"
    at_least: Annotated[Share, Field(ge=0, le=1)] = Field(
        default=1.0, description="Share of the path."
    )


class HueRange(SpecModel):
    """Pixels of a colour: a named one, or a range of hues."""

    short = "named"

    named: ColorName | None = Field(
        default=None,
        description="From, to in degrees: red 340 18, orange 18 45, yellow 45 75, green 75 165,"
        " cyan 165 200, blue 200 255, purple 255 295, pink 295 340.",
    )
    hue: tuple[Angle, Angle] | None = Field(
        default=None,
        description="From, to on the colour circle: 0 is red, 120 deg green, 240 deg blue;"
        " `[340 deg, 20 deg]` goes through 0.",
    )
    min_saturation: Annotated[Share, Field(ge=0, le=1)] = Field(
        default=0.4, description="0 is grey, 1 the pure colour."
    )
    min_value: Annotated[Share, Field(ge=0, le=1)] = Field(
        default=0.15, description="0 is black, 1 the brightest."
    )

    @model_validator(mode="after")
    def _one(self) -> HueRange:
        if (self.named is None) == (self.hue is None):
            raise ValueError("exactly one of `named` and `hue`")
        return self


class Sees(CheckFields):
    """A camera's picture shows a blob of a colour, an ArUco marker, or an object.

    Judged from the picture at the window's end; beside a temporal word, `for` or `within` from
    pictures all along, at the camera's `update_rate`, at most 5 a second.
    """

    check: Literal["sees"] = "sees"
    camera: Name = Field(description="Its name.")
    object: Name | None = Field(default=None, description="Either an object, by segmentation,")
    color: HueRange | None = Field(default=None, description="or the largest blob of a colour,")
    marker: MarkerName | None = Field(default=None, description="or a marker.")
    min_area: Annotated[Count, Field(ge=1)] = Field(
        default=100, description="Pixels of the object, the blob or the marker."
    )
    min_visible: Fraction = Field(
        default=0.5,
        description="Share of the object's outline that nothing hides and that is in the picture.",
    )

    @model_validator(mode="after")
    def _one(self) -> Sees:
        given = [key for key in ("object", "color", "marker") if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError("`sees` is of exactly one of object, color, marker")
        if "min_visible" in self.model_fields_set and self.object is None:
            raise ValueError("`min_visible` is of an object; say `min_area` here")
        return self


class Slip(ObjectCheck):
    """Where the planner believes a held object to be, against where it is."""

    judged = "always"
    check: Literal["slip"] = "slip"
    max_distance: PositiveLength = Field(default=0.003, description="[m]")
    max_rotation: Annotated[Angle, Field(gt=0)] = Field(
        default=0.05235987755982988,
        description="Turns about the axis of a round object do not count.",
    )


AnyPredicate = (
    Lifted
    | Grasped
    | Released
    | Placed
    | On
    | In
    | Displaced
    | Upright
    | Static
    | InContact
    | Collision
    | Clearance
    | TcpPose
    | TcpPath
    | Joints
    | NamedTarget
    | GripperState
    | WithinLimits
    | TrackingError
    | Effort
    | DurationCheck
    | PathLength
    | FractionCheck
    | Sees
    | Slip
)
Predicate = Annotated[AnyPredicate, Field(discriminator="check")]


class TemporalFields(SpecModel):
    """Words that stand beside a temporal word."""

    for_: PositiveDuration | None = Field(
        default=None, alias="for", description="Held this long [s]."
    )
    within: PositiveDuration | None = Field(
        default=None, description="Deadline from the window's start [s]."
    )
    during: Name | None = Field(default=None, description="Judged over the step with this id.")
    points: Annotated[Number, Field(ge=0)] | None = None
    name: str | None = None


class Always(TemporalFields):
    """At every sample of the window."""

    check: Literal["always"] = "always"
    predicate: Predicate


class Never(TemporalFields):
    """At no sample of the window."""

    check: Literal["never"] = "never"
    predicate: Predicate


class Eventually(TemporalFields):
    """At some sample of the window; with `for`, for that long."""

    check: Literal["eventually"] = "eventually"
    predicate: Predicate


class Until(TemporalFields):
    """The first holds until the second does, and the second does."""

    check: Literal["until"] = "until"
    predicate: Predicate
    until: Predicate

    @model_validator(mode="after")
    def _words_are_of_what_comes(self) -> Until:
        if self.predicate.for_ is not None or self.predicate.within is not None:
            raise ValueError(
                "what holds until then has no `for` and no `within`; write them inside `until:`"
            )
        return self


class Formula(SpecModel):
    """Signal temporal logic over recorded signals, judged at the window's first sample."""

    short = "formula"

    check: Literal["formula"] = "formula"
    formula: Annotated[str, AfterValidator(readable)] = Field(
        description="As `always (z(box) > 5 cm implies force(robot, box) > 0.1 N)`."
    )
    during: Name | None = Field(default=None, description="Judged over the step with this id.")
    points: Annotated[Number, Field(ge=0)] | None = None
    name: str | None = None


AnyExpectation = AnyPredicate | Always | Never | Eventually | Until | Formula
Expectation = Annotated[AnyExpectation, Field(discriminator="check")]
