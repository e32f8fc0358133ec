"""The scenario file as a whole."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, ValidationError, model_validator

from harness.core.errors import RobotError
from harness.core.geometry import CollisionMode
from harness.language.base import (
    JointAcceleration,
    JointEffort,
    JointValue,
    JointVelocity,
    Name,
    Number,
    SpecModel,
    kind_of,
)
from harness.language.cameras import CameraSpec
from harness.language.expectation import AnyExpectation
from harness.language.planning import Planning
from harness.language.plugin_field import KeyModel, PluginModel, PluginName
from harness.language.poses import Pose
from harness.language.step import AnyStep
from harness.language.variation import CaseKeys
from harness.language.world import ObjectSpec

if TYPE_CHECKING:
    from harness.core.wrench_sensor import WrenchSensor


class StartState(SpecModel):
    """The state in which the robot starts."""

    short = "named_target"

    named_target: Name | None = Field(
        default=None, description="The arm starts at this SRDF group state."
    )
    joints: dict[Name, JointValue] | None = Field(
        default=None, description="The joints start at these positions, by name."
    )


class JointLimits(SpecModel):
    """Limits of a joint in the words of MoveIt's joint_limits.yaml; narrower than the robot's."""

    min_position: JointValue | None = Field(
        default=None, description="The lowest position that planning uses."
    )
    max_position: JointValue | None = Field(
        default=None, description="The highest position that planning uses."
    )
    max_velocity: Annotated[JointVelocity, Field(gt=0)] | None = Field(
        default=None, description="The largest velocity that planning uses."
    )
    max_acceleration: Annotated[JointAcceleration, Field(gt=0)] | None = Field(
        default=None, description="The largest acceleration that planning uses."
    )
    max_effort: Annotated[JointEffort, Field(gt=0)] | None = Field(
        default=None, description="The largest effort of the joint's motor."
    )


class WrenchSensorKey(KeyModel):
    """A sensor of force and torque between a link and the link before it."""

    def sensor(self, name: str) -> WrenchSensor:
        """The sensor under a name."""
        raise NotImplementedError


IkSolverName = Annotated[Name, PluginName("ik_solver", also=("auto",))]
ControllerName = Annotated[Name, PluginName("controller")]


class RobotSpec(SpecModel):
    """The robot: a bundled model or files, with its gripper and its start state."""

    short = "model"

    model: str | None = Field(
        default=None, description="The name of a folder under robots/, or the path of one."
    )
    urdf: str | None = Field(
        default=None, description="The URDF file, by its path or as package://name/path."
    )
    xacro: str | None = Field(default=None, description="A xacro file, rendered with `args`.")
    args: dict[Name, Any] = Field(
        default_factory=dict, description="Arguments of the xacro files, `srdf` included."
    )
    mjcf: str | None = Field(default=None, description="An MJCF file, as MuJoCo reads it.")
    sdf: str | None = Field(default=None, description="An SDF file with the model of a robot.")
    srdf: str | None = Field(
        default=None,
        description="SRDF file with groups, states and allowed pairs, for `urdf`, `xacro`, "
        "`mjcf` or `sdf`; one with xacro elements is rendered with `args`.",
    )
    packages: tuple[str, ...] = Field(
        default=(), description="The folders where package:// is looked up and meshes may be read."
    )
    group: Name | None = Field(
        default=None, description="The arm's SRDF group; the default is the group with most joints."
    )
    tcp_link: Name | None = Field(
        default=None,
        description="The link at the tool's centre; default: a frame of the robot at its gripper's "
        "pads (the end effector's parent or one named as a TCP first), else the arm group's tip.",
    )
    flange_link: Name | None = Field(
        default=None,
        description="The link on which `gripper` is mounted; the default is the arm group's tip.",
    )
    gripper: str | None = Field(
        default=None,
        description="A gripper mounted on the arm's flange; or the SRDF group of the arm's own, "
        "which is found by itself where one joint closes two sides.",
    )
    friction: Annotated[float, Field(ge=0)] | None = Field(
        default=None,
        description="The sliding friction coefficient of the gripper's pads; the default is that "
        "of the robot's files. A contact has the smaller one of its two surfaces.",
    )
    base: Pose = Field(default=Pose(), description="The pose of the base in the world.")
    mount: Annotated[KeyModel, PluginModel("mount")] | None = Field(
        default=None,
        description="What the base stands on: rails, which are joints of the arm, or a pedestal.",
    )
    kinematics: str | None = Field(
        default=None, description="The UR calibration file, as ur_calibration writes it."
    )
    moveit: Annotated[KeyModel, PluginModel("moveit")] | None = Field(
        default=None, description="The files of the robot's MoveIt configuration."
    )
    ik_solver: IkSolverName | None = Field(
        default=None,
        description="The inverse kinematics solver, built-in or a plug-in; `auto` is the closed "
        "form that fits, else `numeric`. By default the one that the robot's folder names; "
        "`harness list ik-solvers` has the names.",
    )
    joint_controller: ControllerName | None = Field(
        default=None,
        description="The controller of the arm's joints in the physics, built-in or a plug-in; the "
        "default is `position_servo`. `harness list controllers` has the names.",
    )
    collision: (
        Annotated[
            Annotated[CollisionMode, Tag("one")]
            | Annotated[dict[Name, CollisionMode], Tag("many")],
            Discriminator(kind_of),
        ]
        | None
    ) = Field(
        default=None,
        description="How the meshes of the robot's links collide, as the `collision` of a mesh; "
        "one word, or one for each link. By default as the scenario's `collision` says.",
    )
    joint_limits: dict[Name, JointLimits] = Field(
        default_factory=dict,
        description="Limits by joint name; they are narrower than the robot's own.",
    )
    named_states: dict[Name, dict[Name, dict[Name, JointValue]]] = Field(
        default_factory=dict,
        description="Additional group states: group -> state -> joint -> position.",
    )
    wrench_sensors: dict[Name, Annotated[WrenchSensorKey, PluginModel("wrench_sensor")]] = Field(
        default_factory=dict,
        description="Sensors of force and torque between links, by name; they are added to those "
        "of the robot's files, or replace them.",
    )
    start_state: StartState | None = Field(
        default=None, description="The start state; the default comes from the robot's folder."
    )

    @model_validator(mode="after")
    def _one_source(self) -> RobotSpec:
        sources = ("model", "urdf", "xacro", "mjcf", "sdf")
        given = [key for key in sources if getattr(self, key) is not None]
        if len(given) != 1 and not (not given and self.gripper):
            known = ", ".join(f"`{key}`" for key in sources)
            raise ValueError(f"`robot` needs exactly one of {known}, or `gripper` alone")
        return self

    @classmethod
    def of_options(cls, words: Mapping[str, Any]) -> Self:
        """The robot of a command's options; a RobotError for a word that is no name."""
        try:
            return cls.model_validate(words)
        except ValidationError as error:
            first = error.errors()[0]
            raise RobotError(f"robot `{first['loc'][0]}`: {first['msg']}") from None


ArmName = Annotated[Name, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=40)]


class WorldChoice(SpecModel):
    """The world: a bundled one, or a file."""

    short = "name"

    name: str = Field(
        description="The name of a world under worlds/, or the path of a .yaml, .sdf or MJCF file."
    )
    model_path: tuple[str, ...] = Field(
        default=(),
        description="Folders where an SDF world's models are looked up and may be read;"
        " before those of GZ_SIM_RESOURCE_PATH. An MJCF scene may read files in them.",
    )


class ScenarioContent(SpecModel):
    """The keys of a scenario that every case of it has."""

    @classmethod
    def unknown_key_hint(cls, key: str, content: Mapping[str, Any]) -> str:
        return ObjectSpec.unknown_key_hint(key, content)

    scenario: Annotated[str, Field(min_length=1, max_length=200)] = Field(
        description="The title of the scenario."
    )
    description: str = Field(default="", description="A description of the scenario for people.")
    tags: tuple[Name, ...] = Field(default=(), description="The tags become pytest marks.")
    points: Annotated[Number, Field(ge=0)] | None = Field(
        default=None, description="Points awarded when this scenario passes."
    )
    verifies: tuple[str, ...] = Field(
        default=(),
        description="The requirements that this scenario verifies, by their identifiers.",
    )
    robot: RobotSpec | None = Field(
        default=None, description="The robot: the name of a model, or its keys."
    )
    robots: Annotated[dict[ArmName, RobotSpec], Field(min_length=1, max_length=8)] | None = Field(
        default=None,
        description="The arms by their names, as `left` and `right`, which become one robot, in "
        "place of `robot`. The name and `_` stand in front of the names of an arm's links, joints "
        "and groups; its planning group has the name alone.",
    )
    world: WorldChoice = Field(
        default=WorldChoice(name="empty"),
        description="The world: its name, or its keys. The default `empty` has a floor at z = 0.",
    )
    objects: tuple[ObjectSpec, ...] = Field(
        default=(), description="Objects that are added to the world's, or replace them."
    )
    collision: CollisionMode = Field(
        default="parts",
        description="How meshes collide that have no `collision` of their own: as convex `parts`, "
        "which are one hull where that is within 10 mm of the mesh (or a tenth of its longest "
        "side); as convex `hull`; or `exact` in the planner and as parts in the physics.",
    )
    cameras: tuple[CameraSpec, ...] = Field(
        default=(), description="Cameras that are added to those of the world and the robot."
    )
    videos: tuple[Annotated[KeyModel, PluginModel("video")], ...] = Field(
        default=(), description="Cameras that are recorded all through the run."
    )
    params: dict[Name, Any] = Field(
        default_factory=dict, description="The values that ${name} in the file stands for."
    )
    planning: Planning = Field(
        default=Planning(),
        description="Planning parameters of all steps that have none of their own.",
    )
    ros2: Annotated[KeyModel, PluginModel("ros2")] | None = Field(
        default=None, description="Names that `harness bridge` serves on the ROS 2 graph."
    )
    steps: Annotated[tuple[AnyStep, ...], Field(min_length=1)] = Field(
        description="The steps that the arm executes, in order."
    )
    expect: tuple[AnyExpectation, ...] = Field(
        default=(), description="Expectations that are judged over the whole run."
    )

    @property
    def robot_key(self) -> Literal["robot", "robots"]:
        """The key that says what the robot is."""
        return "robot" if self.robots is None else "robots"

    @model_validator(mode="after")
    def _one_robot(self) -> Self:
        if self.robot is None and self.robots is None:
            raise ValueError("`robot` is missing")
        if self.robot is not None and self.robots is not None:
            raise ValueError("`robot` is one arm, and `robots` are several: give one of the two")
        return self


class Scenario(CaseKeys, ScenarioContent):
    """A scenario: one test of an arm application."""

    def expectation_names(self) -> list[str]:
        """The names of the expectations that have one."""
        found = [*self.expect, *(each for step in self.steps for each in step.expect)]
        return [each.name for each in found if each.name]
