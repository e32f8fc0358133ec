"""`robot.yaml`: the properties of a robot that URDF and SRDF lack."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, ValidationError, field_validator, model_validator
from pydantic_core import ErrorDetails

from harness.core.errors import Problem, SpecError
from harness.core.geometry import CollisionMode
from harness.language.base import Length, Name, RosName, Rpy, SpecModel, Xyz
from harness.language.cameras import CameraFields
from harness.language.files.source import Loc, Source, SourceMap
from harness.language.files.yaml_file import parse_yaml, read_text
from harness.language.plugin_field import PluginModel
from harness.language.scenario import IkSolverName, JointLimits, StartState, WrenchSensorKey

FILE = "robot.yaml"


class JointFacts(JointLimits):
    """Limits of a joint that its URDF lacks or has wrong, with the source of the effort limit."""

    effort_source: str = Field(
        default="", description="The source of `max_effort`, which reports name."
    )


class XacroFile(SpecModel):
    """A URDF in xacro format.

    The argument `variant_arg` gets the variant's name; `mesh_arg` gets whether `mesh_package` is
    installed and has the variant among `mesh_variants`.
    """

    file: str = Field(description="The path of the xacro file, from the folder.")
    variant_arg: Name | None = Field(
        default=None, description="The xacro argument that gets the name of the variant."
    )
    mesh_arg: Name | None = Field(
        default=None,
        description="The xacro argument that gets `true` where the variant's meshes are installed.",
    )
    mesh_package: Name | None = Field(
        default=None,
        pattern=r"^[A-Za-z_]\w*$",  # the parents of a dotted name would be imported
        description="The Python package that has the meshes.",
    )
    mesh_variants: tuple[Name, ...] = Field(
        default=(), description="The variants of which the package has meshes."
    )


class FingerSide(SpecModel):
    """Links of one side of a gripper; `pad` is the one that touches objects."""

    links: Annotated[tuple[Name, ...], Field(min_length=1)] = Field(
        description="The links of this side of the gripper."
    )
    pad: Name = Field(description="The link of this side that touches objects.")


class CupFacts(SpecModel):
    """A suction cup; the z axis of its link leaves the gripper, and z = 0 is the plane of the rim.

    The rim is a circle that is rigid in contact, with a lip that closes gaps.
    """

    link: Name = Field(description="The link of the cup, whose collision shapes are its rim.")
    radius: Annotated[float, Field(gt=0)] = Field(description="The radius of the rim [m].")
    lip: Annotated[float, Field(gt=0)] = Field(
        description="The largest gap between rim and surface that the lip closes [m]; on a slope it"
        " bends by as much across the rim."
    )
    depth: Annotated[float, Field(gt=0)] = Field(
        description="How far a surface may bulge into the cup [m]."
    )


class GripperFacts(SpecModel):
    """Two finger sides closed by one joint, or suction cups with one valve.

    Efforts are in N m or N at the joint. The joint of suction cups is that of their valve, whose
    open share is the share of the vacuum.
    """

    group: Name = Field(description="The SRDF group of the gripper.")
    joint: Name = Field(
        description="The joint that is driven; the other joints of the gripper mimic it."
    )
    palm_link: Name = Field(
        description="The link that carries the fingers; of a single jaw also the pad of a side."
    )
    sides: Annotated[dict[Name, FingerSide], Field(min_length=2, max_length=2)] | None = Field(
        default=None, description="The two sides of fingers, by name; or `cups`."
    )
    cups: Annotated[dict[Name, CupFacts], Field(min_length=1)] | None = Field(
        default=None, description="The suction cups by name, in place of `sides`."
    )
    vacuum: Annotated[float, Field(gt=0)] | None = Field(
        default=None,
        description="The pressure below the atmosphere's in sealed cups with the valve open [Pa].",
    )
    open_position: float = Field(
        description="The position of the joint at which the pads are widest apart."
    )
    closed_position: float = Field(
        description="The position of the joint at which the pads are closest."
    )
    grip_effort: Annotated[float, Field(gt=0)] = Field(
        description="The effort of the joint where a step states none [N m or N]."
    )
    max_effort: Annotated[float, Field(gt=0)] = Field(
        description="The largest effort of the joint [N m or N]."
    )
    friction: Annotated[float, Field(ge=0)] = Field(
        default=1.0, description="The sliding friction coefficient of the pads."
    )
    approach_axis: Xyz | None = Field(
        default=None,
        description="The direction in which the gripper approaches an object, in the axes of the "
        "TCP; by default from the palm to the pads.",
    )
    widths: Annotated[tuple[tuple[float, Length], ...], Field(min_length=2)] | None = Field(
        default=None,
        description="Rows of joint position and gap between the pads [m], with rising position;"
        " required of fingers.",
    )

    @model_validator(mode="after")
    def _fingers_or_cups(self) -> GripperFacts:
        if (self.sides is None) == (self.cups is None):
            raise ValueError("a gripper has `sides` of fingers, or `cups`")
        needed, other = ("widths", "vacuum") if self.cups is None else ("vacuum", "widths")
        if getattr(self, needed) is None or getattr(self, other) is not None:
            kind = "fingers need" if self.cups is None else "cups need"
            raise ValueError(f"{kind} `{needed}`, and have no `{other}`")
        return self

    @property
    def links_by_side(self) -> dict[str, tuple[str, ...]]:
        """The links of each finger side, or of each cup."""
        if self.cups is not None:
            return {name: (cup.link,) for name, cup in self.cups.items()}
        return {name: side.links for name, side in (self.sides or {}).items()}

    @property
    def pads(self) -> dict[str, str]:
        """The link of each side that touches objects."""
        if self.cups is not None:
            return {name: cup.link for name, cup in self.cups.items()}
        return {name: side.pad for name, side in (self.sides or {}).items()}

    @field_validator("approach_axis")
    @classmethod
    def _some_direction(cls, axis: Xyz | None) -> Xyz | None:
        if axis is not None and not any(axis):
            raise ValueError("(0, 0, 0) is no direction")
        return axis


class Placement(SpecModel):
    """A pose as position and roll, pitch, yaw."""

    xyz: Xyz = Field(default=(0.0, 0.0, 0.0), description="The position along x, y, z [m].")
    rpy: Rpy = Field(
        default=(0.0, 0.0, 0.0), description="The rotation as fixed-axis roll, pitch, yaw [rad]."
    )


class ToolCenterPoint(Placement):
    """A frame that a gripper adds, in its root link's axes."""

    link: Name = Field(description="The name of the TCP frame.")
    joint: Name = Field(description="The name of the fixed joint that holds the frame.")


class Mount(Placement):
    """Pose of a gripper's root link on an arm's flange, and the gripper's TCP."""

    joint: Name = Field(description="The name of the fixed joint between flange and gripper.")
    tcp: ToolCenterPoint = Field(description="The TCP frame that the gripper adds.")


class Flange(Placement):
    """Flange for a gripper that replaces the arm's own one; grippers point along its +z."""

    link: Name = Field(description="The link that carries the flange.")


class CameraFacts(CameraFields):
    """A camera on a link, with the parameters of SDF's sensor; it looks along its +x axis."""

    link: Name = Field(description="The link that carries the camera.")
    pose: Placement = Field(default=Placement(), description="The pose of the camera on the link.")


class Tracking(SpecModel):
    """Tolerances of a trajectory controller [rad or m], and its settling time [s]."""

    trajectory: Annotated[float, Field(gt=0)] = Field(
        default=0.2, description="The largest deviation of a joint during a motion [rad or m]."
    )
    goal: Annotated[float, Field(gt=0)] = Field(
        default=0.01, description="The largest deviation of a joint at the goal [rad or m]."
    )
    goal_time: Annotated[float, Field(ge=0)] = Field(
        default=1.0,
        description="The time after the end of a motion until the goal must be kept [s].",
    )


class Controllers(SpecModel):
    """Names of the robot's ROS 2 controllers; `GROUP_controller` where there are none."""

    arm: tuple[RosName, ...] = Field(
        default=(), description="The arm's trajectory controller; several names lead to the same."
    )
    gripper: tuple[RosName, ...] = Field(
        default=(), description="The controller of the gripper; several names lead to the same."
    )


class RobotYaml(SpecModel):
    """The robot.yaml of a robot's folder.

    An arm has `arm_group`, `tcp_link`, `flange_link` (where grippers are mounted; absent when none
    can be), `flange` (for a gripper that replaces its own one) and `ik_solver`. A gripper has
    `mount`. Both may have a `gripper` section.
    """

    one_of = ("urdf", "xacro")

    robot: Name = Field(description="The name of the robot in lists and messages.")
    kind: Literal["arm", "gripper"] = Field(
        description="Whether the folder holds an arm or a gripper."
    )
    description: str = Field(default="", description="A description of the robot for people.")
    urdf: str | None = Field(
        default=None, description="The path of the URDF file, from the folder."
    )
    xacro: XacroFile | None = Field(
        default=None, description="The xacro file that is rendered, instead of `urdf`."
    )
    srdf: str = Field(description="The path of the SRDF file, from the folder; xacro is rendered.")
    packages: tuple[str, ...] = Field(
        default=(),
        description="Folders that are searched for package:// and from which meshes may be read.",
    )
    variants: tuple[Name, ...] = Field(
        default=(), description="Names of the models of a family; each is a name for `model`."
    )
    arm_group: Name | None = Field(
        default=None, description="The arm's SRDF group; required of an arm."
    )
    tcp_link: Name | None = Field(
        default=None, description="The link at the tool's centre; required of an arm."
    )
    flange_link: Name | None = Field(
        default=None, description="The link on which grippers are mounted."
    )
    flange: Flange | None = Field(
        default=None, description="The flange for a gripper that replaces the arm's own one."
    )
    ik_solver: IkSolverName = Field(
        default="numeric",
        description="The inverse kinematics solver; `auto` is the first of the others that fits.",
    )
    collision: dict[Name, CollisionMode] = Field(
        default_factory=dict[Name, CollisionMode],
        description="How the meshes of links collide, by link: `hull`, `parts` or `exact`, where a "
        "scenario's `robot: {collision: ...}` does not state it.",
    )
    start_state: StartState = Field(
        default=StartState(), description="The state in which the robot starts a run."
    )
    max_acceleration: Annotated[float, Field(gt=0)] = Field(
        default=5.0,
        description="The acceleration limit of joints without one in `joints` [rad/s^2 or m/s^2].",
    )
    effort_source: str = Field(
        default="", description="The source of effort limits that have none in `joints`."
    )
    joints: dict[Name, JointFacts] = Field(
        default_factory=dict[str, JointFacts],
        description="The limits that the URDF lacks or has wrong, by joint.",
    )
    gripper: GripperFacts | None = Field(
        default=None, description="The fingers of the gripper, or of an arm that has its own."
    )
    mount: Mount | None = Field(
        default=None, description="How the gripper is mounted on an arm; required of a gripper."
    )
    cameras: dict[Name, CameraFacts] = Field(
        default_factory=dict[str, CameraFacts],
        description="The cameras on links of the robot, by name.",
    )
    wrench_sensors: dict[Name, Annotated[WrenchSensorKey, PluginModel("wrench_sensor")]] = Field(
        default_factory=dict,
        description="The sensors of force and torque between links of the robot, by name.",
    )
    tracking: Tracking = Field(
        default=Tracking(), description="The tolerances of the scenario's own motions."
    )
    controller_tolerances: Tracking | None = Field(
        default=None,
        description="The tolerances that the file of the robot's ROS 2 controllers has, for "
        "trajectories of nodes; without them a node's goal has those that it names.",
    )
    controllers: Controllers = Field(
        default=Controllers(), description="The names of the robot's ROS 2 controllers."
    )

    @model_validator(mode="after")
    def _whole(self) -> RobotYaml:
        if self.kind == "arm" and not (self.arm_group and self.tcp_link):
            raise ValueError("an arm has an `arm_group` and a `tcp_link`")
        if self.kind == "gripper" and not (self.gripper and self.mount):
            raise ValueError("a gripper has a `gripper` section and a `mount`")
        return self


def read_robot_yaml(folder: Path) -> RobotYaml:
    """The folder's robot.yaml.

    Raises:
        SpecError: The file does not exist, is not YAML, or has mistakes; all of them, located.
    """
    text = read_text(folder / FILE)
    content = parse_yaml(text, Source.of_text(str(folder / FILE), text)).plain()
    try:
        return RobotYaml.model_validate(content)
    except ValidationError as error:
        problems = [(item["loc"], _message(item)) for item in error.errors(include_url=False)]
        raise robot_yaml_error(folder, problems) from error


def _message(error: ErrorDetails) -> str:
    """A mistake with what to do instead, where its validator says that."""
    hint = getattr(error.get("ctx", {}).get("error"), "hint", "")
    return f"{error['msg']}; {hint}" if hint else error["msg"]


def robot_yaml_error(folder: Path, problems: Iterable[tuple[Loc, str]]) -> SpecError:
    """Located mistakes of a robot.yaml.

    Raises:
        SpecError: The file is not YAML.
    """
    path = folder / FILE
    text = read_text(path)
    places = SourceMap(parse_yaml(text, Source.of_text(str(path), text)))
    found: list[Problem] = []
    for loc, message in problems:
        value = places.find(loc)
        key = ".".join(map(str, loc)) or FILE
        place = value.item.place if value.is_whole else value.key or value.item.place
        found.append(place.problem(f"{key}: {message}"))
    return SpecError(found)
