"""`robot.yaml`: the properties of a robot that URDF and SRDF lack."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import Field, ValidationError, model_validator
from pydantic_core import ErrorDetails

from harness.core.errors import Problem, SpecError
from harness.language.base import Length, Name, Rpy, SpecModel, Xyz
from harness.language.cameras import CameraFields
from harness.language.files.source import Loc, Source, SourceMap
from harness.language.files.yaml_file import LOADER, parse_yaml, read_text
from harness.language.scenario import IkSolverName, JointLimits, StartState

FILE = "robot.yaml"


class JointFacts(JointLimits):
    """Limits of a joint that its URDF lacks or has wrong, with the source of the effort limit."""

    effort_source: str = ""


class XacroFile(SpecModel):
    """A URDF in xacro format.

    The argument `variant_arg` gets the variant's name; `mesh_arg` gets whether `mesh_package` is
    installed and has the variant among `mesh_variants`.
    """

    file: str
    variant_arg: Name | None = None
    mesh_arg: Name | None = None
    mesh_package: Name | None = None
    mesh_variants: tuple[Name, ...] = ()


class FingerSide(SpecModel):
    """Links of one side of a gripper; `pad` is the one that touches objects."""

    links: Annotated[tuple[Name, ...], Field(min_length=1)]
    pad: Name


class GripperFacts(SpecModel):
    """Two finger sides closed by one joint; efforts in N m or N at that joint."""

    group: Name
    joint: Name
    palm_link: Name
    sides: Annotated[dict[Name, FingerSide], Field(min_length=2, max_length=2)]
    open_position: float
    closed_position: float
    grip_effort: Annotated[float, Field(gt=0)]
    max_effort: Annotated[float, Field(gt=0)]
    friction: Annotated[float, Field(ge=0)] = 1.0
    widths: Annotated[tuple[tuple[float, Length], ...], Field(min_length=2)] = Field(
        description="Rows of joint position and gap between the pads [m], with rising position."
    )


class Placement(SpecModel):
    """A pose as position and roll, pitch, yaw."""

    xyz: Xyz = (0.0, 0.0, 0.0)
    rpy: Rpy = (0.0, 0.0, 0.0)


class ToolCenterPoint(Placement):
    """A frame that a gripper adds, in its root link's axes."""

    link: Name
    joint: Name


class Mount(Placement):
    """Pose of a gripper's root link on an arm's flange, and the gripper's TCP."""

    joint: Name
    tcp: ToolCenterPoint


class Flange(Placement):
    """Flange for a gripper that replaces the arm's own one; grippers point along its +z."""

    link: Name


class CameraFacts(CameraFields):
    """A camera on a link, with the parameters of SDF's sensor; it looks along its +x axis."""

    link: Name
    pose: Placement = Placement()


class Tracking(SpecModel):
    """Tolerances of the trajectory controller [rad or m], and its settling time [s]."""

    trajectory: Annotated[float, Field(gt=0)] = 0.2
    goal: Annotated[float, Field(gt=0)] = 0.01
    goal_time: Annotated[float, Field(ge=0)] = 1.0


class RobotYaml(SpecModel):
    """The robot.yaml of a robot's folder.

    An arm has `arm_group`, `tcp_link`, `flange_link` (where grippers are mounted; absent when none
    can be), `flange` (for a gripper that replaces its own one) and `ik_solver`. A gripper has
    `mount`. Both may have a `gripper` section.
    """

    robot: Name
    kind: Literal["arm", "gripper"]
    description: str = ""
    urdf: str | None = None
    xacro: XacroFile | None = None
    srdf: str
    packages: tuple[str, ...] = Field(
        default=(),
        description="Folders that are searched for package:// and from which meshes may be read.",
    )
    variants: tuple[Name, ...] = ()
    arm_group: Name | None = None
    tcp_link: Name | None = None
    flange_link: Name | None = None
    flange: Flange | None = None
    ik_solver: IkSolverName = "numeric"
    start_state: StartState = StartState()
    max_acceleration: Annotated[float, Field(gt=0)] = Field(
        5.0, description="Acceleration limit of joints without one in `joints` [rad/s^2 or m/s^2]."
    )
    effort_source: str = Field("", description="Source of effort limits without one in `joints`.")
    joints: dict[Name, JointFacts] = Field(default_factory=dict[str, JointFacts])
    gripper: GripperFacts | None = None
    mount: Mount | None = None
    cameras: dict[Name, CameraFacts] = Field(default_factory=dict[str, CameraFacts])
    tracking: Tracking = Tracking()

    @model_validator(mode="after")
    def _whole(self) -> RobotYaml:
        if (self.urdf is None) == (self.xacro is None):
            raise ValueError("exactly one of `urdf` and `xacro`")
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
    try:
        content: Any = yaml.load(text, Loader=LOADER)
        return RobotYaml.model_validate(content)
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        errors = error.errors(include_url=False) if isinstance(error, ValidationError) else []
        problems = [(item["loc"], _message(item)) for item in errors]
        raise robot_yaml_error(folder, problems or [((), str(error))]) from error


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
