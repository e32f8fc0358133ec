"""The scenario file as a whole."""

from __future__ import annotations

from typing import Annotated, Any, cast

from pydantic import Field, model_validator

from harness.spec.base import (
    Count,
    Flag,
    Fraction,
    JointAcceleration,
    JointEffort,
    JointValue,
    JointVelocity,
    Name,
    Number,
    SpecModel,
)
from harness.spec.checks import Expectation
from harness.spec.planning import Planning
from harness.spec.poses import Pose
from harness.spec.steps import Step
from harness.spec.world import ObjectSpec


class StartState(SpecModel):
    """Where the robot stands at the start."""

    short = "named_target"

    named_target: Name | None = None
    joints: dict[Name, JointValue] | None = None


class JointLimits(SpecModel):
    """MoveIt's joint_limits.yaml words; narrows what the robot's description says."""

    min_position: JointValue | None = None
    max_position: JointValue | None = None
    max_velocity: Annotated[JointVelocity, Field(gt=0)] | None = None
    max_acceleration: Annotated[JointAcceleration, Field(gt=0)] | None = None
    max_effort: Annotated[JointEffort, Field(gt=0)] | None = None


class RobotSpec(SpecModel):
    """The robot: a bundled model or files, with its gripper and where it stands."""

    short = "model"

    model: str | None = Field(
        default=None, description="A name under robots/, or a path to such a folder."
    )
    urdf: str | None = None
    xacro: str | None = None
    args: dict[Name, Any] = Field(default_factory=dict, description="Of the xacro file.")
    mjcf: str | None = None
    srdf: str | None = None
    gripper: str | None = Field(
        default=None, description="A gripper's name, mounted on the arm's flange."
    )
    base: Pose = Field(default=Pose(), description="Where the base stands in the world.")
    kinematics: str | None = Field(default=None, description="A UR calibration file.")
    joint_limits: dict[Name, JointLimits] = Field(default_factory=dict)
    named_states: dict[Name, dict[Name, dict[Name, JointValue]]] = Field(
        default_factory=dict, description="Extra group states: group -> state -> joint -> position."
    )
    start_state: StartState | None = None

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


class Expected(SpecModel):
    """A success rate to be shown by sampled cases."""

    at_least: Fraction
    confidence: Annotated[Number, Field(gt=0, lt=1)] = 0.95


class Scenario(SpecModel):
    """One test of an arm application."""

    scenario: Annotated[str, Field(min_length=1, max_length=200)] = Field(description="Its title.")
    description: str = ""
    tags: tuple[Name, ...] = Field(default=(), description="pytest marks.")
    points: Annotated[Number, Field(ge=0)] | None = None
    verifies: tuple[str, ...] = Field(default=(), description="Requirements.")
    robot: RobotSpec
    world: str = Field(
        default="empty", description="A name under worlds/, a .yaml path, or an .sdf path."
    )
    objects: tuple[ObjectSpec, ...] = Field(
        default=(), description="Added to, or replacing, the world's."
    )
    seed: Annotated[Count, Field(ge=0, le=2**31 - 1)] = 0
    params: dict[Name, Any] = Field(default_factory=dict, description="For ${name} in the file.")
    planning: Planning = Planning()
    deterministic: Flag = True
    steps: Annotated[tuple[Step, ...], Field(min_length=1)]
    expect: tuple[Expectation, ...] = Field(default=(), description="Judged over the whole run.")
    parametrize: dict[str, Any] | list[Any] | None = None
    randomize: dict[str, Any] | None = None
    samples: Annotated[Count, Field(ge=1, le=100_000)] | None = None
    expect_rate: Expected | None = None
