"""The scenario file as a whole."""

from __future__ import annotations

from typing import Annotated, Any, cast

from pydantic import Field, model_validator

from harness.core.variation import MOST_SAMPLES, count_of
from harness.language.base import (
    Count,
    Flag,
    JointAcceleration,
    JointEffort,
    JointValue,
    JointVelocity,
    Name,
    Number,
    SpecModel,
)
from harness.language.cameras import CameraSpec, VideoSpec
from harness.language.expectation import AnyExpectation
from harness.language.planning import Planning
from harness.language.poses import Pose
from harness.language.step import AnyStep
from harness.language.variation import Distribution, Expected, Parametrize
from harness.language.world import ObjectSpec


class StartState(SpecModel):
    """Where the robot stands at the start."""

    short = "named_target"

    named_target: Name | None = Field(default=None, description="An SRDF group state of the arm.")
    joints: dict[Name, JointValue] | None = Field(
        default=None, description="Joint positions by name."
    )


class JointLimits(SpecModel):
    """MoveIt's joint_limits.yaml words; narrows what the robot's description says."""

    min_position: JointValue | None = Field(default=None, description="Lowest position.")
    max_position: JointValue | None = Field(default=None, description="Highest position.")
    max_velocity: Annotated[JointVelocity, Field(gt=0)] | None = Field(
        default=None, description="Largest speed."
    )
    max_acceleration: Annotated[JointAcceleration, Field(gt=0)] | None = Field(
        default=None, description="Largest acceleration."
    )
    max_effort: Annotated[JointEffort, Field(gt=0)] | None = Field(
        default=None, description="Largest effort."
    )


class MoveItFiles(SpecModel):
    """Files of a MoveIt configuration package."""

    joint_limits: str | None = Field(
        default=None, description="joint_limits.yaml: narrows the robot's limits."
    )
    kinematics: str | None = Field(
        default=None, description="kinematics.yaml: `position_only_ik` of each group."
    )


class RobotSpec(SpecModel):
    """The robot: a bundled model or files, with its gripper and where it stands."""

    short = "model"

    model: str | None = Field(
        default=None, description="A name under robots/, or a path to such a folder."
    )
    urdf: str | None = Field(
        default=None, description="A URDF file, by its path or as package://name/path."
    )
    xacro: str | None = Field(default=None, description="A xacro file, rendered with `args`.")
    args: dict[Name, Any] = Field(
        default_factory=dict, description="Arguments of the xacro files, `srdf` included."
    )
    mjcf: str | None = Field(default=None, description="An MJCF file, as MuJoCo reads it.")
    srdf: str | None = Field(
        default=None,
        description="SRDF file with groups, states and allowed pairs, for `urdf`, `xacro` or "
        "`mjcf`; one with xacro elements is rendered with `args`.",
    )
    packages: tuple[str, ...] = Field(
        default=(), description="Folders where package:// is looked up and meshes may be read."
    )
    group: Name | None = Field(
        default=None, description="The arm's SRDF group; default: the one with most joints."
    )
    tcp_link: Name | None = Field(
        default=None,
        description="The link at the tool's centre; default: a frame of the robot at its gripper's "
        "pads (the end effector's parent or one named as a TCP first), else the arm group's tip.",
    )
    flange_link: Name | None = Field(
        default=None, description="Where `gripper` is mounted; default: the arm group's tip."
    )
    gripper: str | None = Field(
        default=None,
        description="A gripper mounted on the arm's flange; or the SRDF group of the arm's own, "
        "which is found by itself where one joint closes two sides.",
    )
    base: Pose = Field(default=Pose(), description="Where the base stands in the world.")
    kinematics: str | None = Field(
        default=None, description="A UR calibration file, as ur_calibration writes it."
    )
    moveit: MoveItFiles = Field(default=MoveItFiles(), description="Files that MoveIt has.")
    joint_limits: dict[Name, JointLimits] = Field(
        default_factory=dict, description="By joint; narrower than the robot's own."
    )
    named_states: dict[Name, dict[Name, dict[Name, JointValue]]] = Field(
        default_factory=dict, description="Extra group states: group -> state -> joint -> position."
    )
    start_state: StartState | None = Field(
        default=None, description="Default: from the robot's folder."
    )

    @model_validator(mode="before")
    @classmethod
    def _course_word(cls, value: Any) -> Any:
        given: object = value
        robot = cast("dict[str, Any]", given if isinstance(given, dict) else {})
        if "ur_type" not in robot or "model" in robot:
            return value
        return {("model" if key == "ur_type" else key): item for key, item in robot.items()}

    @model_validator(mode="after")
    def _one_source(self) -> RobotSpec:
        given = [
            key for key in ("model", "urdf", "xacro", "mjcf") if getattr(self, key) is not None
        ]
        if len(given) != 1 and not (not given and self.gripper):
            raise ValueError("exactly one of model, urdf, xacro, mjcf (or a gripper alone)")
        return self


class WorldChoice(SpecModel):
    """The world: a bundled one, or a file."""

    short = "name"

    name: str = Field(description="A name under worlds/, or the path of a .yaml or .sdf file.")
    model_path: tuple[str, ...] = Field(
        default=(),
        description="Folders where an SDF world's models are looked up and may be read;"
        " before those of GZ_SIM_RESOURCE_PATH.",
    )


class Scenario(SpecModel):
    """One test of an arm application."""

    scenario: Annotated[str, Field(min_length=1, max_length=200)] = Field(description="Its title.")
    description: str = Field(default="", description="For people.")
    tags: tuple[Name, ...] = Field(default=(), description="pytest marks.")
    points: Annotated[Number, Field(ge=0)] | None = Field(
        default=None, description="Of a graded scenario."
    )
    verifies: tuple[str, ...] = Field(default=(), description="Requirements.")
    robot: RobotSpec = Field(description="A model's name, or its keys.")
    world: WorldChoice = Field(
        default=WorldChoice(name="empty"), description="A world's name, or its keys."
    )
    objects: tuple[ObjectSpec, ...] = Field(
        default=(), description="Added to, or replacing, the world's."
    )
    cameras: tuple[CameraSpec, ...] = Field(
        default=(), description="Added to the world's and the robot's."
    )
    videos: tuple[VideoSpec, ...] = Field(
        default=(), description="Cameras that are recorded all through the run."
    )
    seed: Annotated[Count, Field(ge=0, le=2**31 - 1)] = Field(
        default=0, description="Of everything random; each step's seed follows from it."
    )
    params: dict[Name, Any] = Field(default_factory=dict, description="For ${name} in the file.")
    planning: Planning = Field(
        default=Planning(), description="For all steps that do not say otherwise."
    )
    deterministic: Flag = Field(
        default=True, description="`false` allows planners that cannot be repeated."
    )
    steps: Annotated[tuple[AnyStep, ...], Field(min_length=1)] = Field(
        description="What the arm does, in order."
    )
    expect: tuple[AnyExpectation, ...] = Field(default=(), description="Judged over the whole run.")
    parametrize: Parametrize | None = Field(
        default=None,
        description="Cases: a grid `{robot.model: [ur3e, ur5e]}`, or a list of named ones.",
    )
    randomize: dict[str, Distribution] | None = Field(
        default=None,
        description="Dotted path -> distribution of that value. Items of lists go by index or by"
        " name: `objects.cube.pose.xyz.0`.",
    )
    samples: Annotated[Count, Field(ge=1, le=MOST_SAMPLES)] | None = Field(
        default=None, description="How many random cases; default 20 where something is random."
    )
    redraw_overlaps: Flag | None = Field(
        default=None,
        description="Draws a sample again, up to 100 times, while objects overlap at the start.",
    )
    expect_rate: Expected | None = Field(
        default=None, description="Of the samples; without it every one must pass."
    )

    @model_validator(mode="after")
    def _rate_of_samples(self) -> Scenario:
        if self.expect_rate is not None and self.samples is None and self.randomize is None:
            raise ValueError("`expect_rate` is of `samples`: say how many, or what is random")
        return self

    @model_validator(mode="after")
    def _redraws_of_random_values(self) -> Scenario:
        if self.redraw_overlaps and self.randomize is None:
            raise ValueError("`redraw_overlaps` draws the values of `randomize`: nothing is random")
        return self

    @model_validator(mode="after")
    def _bounded_cases(self) -> Scenario:
        if self.parametrize is not None and self.samples is not None:
            count = count_of(self.parametrize) * self.samples
            if count > MOST_SAMPLES:
                raise ValueError(f"{count} samples of all cases; at most {MOST_SAMPLES} are run")
        return self
