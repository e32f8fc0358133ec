"""What a robot's folder says beside URDF and SRDF: `robot.yaml`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import Field, ValidationError, model_validator

from harness.core.errors import Problem, SpecError
from harness.robot.description import IkSolver
from harness.spec.base import Length, Name, Rpy, SpecModel, Xyz
from harness.spec.cameras import CameraFields
from harness.spec.scenario import JointLimits, StartState
from harness.spec.source import Loc, Source, SourceMap
from harness.spec.yaml_file import LOADER, parse_yaml, read_text

FILE = "robot.yaml"


class JointFacts(JointLimits):
    """Limits of a joint that URDF cannot say or says wrongly, with the source of its effort."""

    effort_source: str = ""


class XacroFile(SpecModel):
    """A URDF that is rendered first.

    `variant_arg` is given the variant's name; `mesh_arg` is given whether `mesh_package` is
    installed and has the variant among `mesh_variants`.
    """

    file: str
    variant_arg: Name | None = None
    mesh_arg: Name | None = None
    mesh_package: Name | None = None
    mesh_variants: tuple[Name, ...] = ()


class FingerSide(SpecModel):
    """Links of one side of a gripper, and the one of them that touches."""

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
        description="Rows of joint position and gap between the pads [m], position rising."
    )


class Placement(SpecModel):
    """Where something stands on something else."""

    xyz: Xyz = (0.0, 0.0, 0.0)
    rpy: Rpy = (0.0, 0.0, 0.0)


class ToolCenterPoint(Placement):
    """A frame that a gripper adds, in its root link's axes."""

    link: Name
    joint: Name


class Mount(Placement):
    """How a gripper's root link stands on an arm's flange, and the TCP it brings."""

    joint: Name
    tcp: ToolCenterPoint


class Flange(Placement):
    """Where another gripper goes in place of the arm's own; grippers point along its +z."""

    link: Name


class CameraFacts(CameraFields):
    """A camera on a link, in the words of SDF's camera sensor; looks along +x of its pose."""

    link: Name
    pose: Placement = Placement()


class Tracking(SpecModel):
    """Tolerances of the trajectory controller [rad or m], and how long it may settle [s]."""

    trajectory: Annotated[float, Field(gt=0)] = 0.2
    goal: Annotated[float, Field(gt=0)] = 0.01
    goal_time: Annotated[float, Field(ge=0)] = 1.0


class RobotYaml(SpecModel):
    """A robot's folder.

    Attributes of an arm: `arm_group`, `tcp_link`, `flange_link` (where grippers go; absent when
    none can), `flange` (where one goes in place of its own), `ik_solver`. Of a gripper: `mount`.
    Either may have a `gripper` section.
    """

    robot: Name
    kind: Literal["arm", "gripper"]
    description: str = ""
    urdf: str | None = None
    xacro: XacroFile | None = None
    srdf: str
    packages: tuple[str, ...] = Field(
        default=(), description="Folders where package:// is looked up and meshes may be read."
    )
    variants: tuple[Name, ...] = ()
    arm_group: Name | None = None
    tcp_link: Name | None = None
    flange_link: Name | None = None
    flange: Flange | None = None
    ik_solver: IkSolver = "numeric"
    start_state: StartState = StartState()
    max_acceleration: Annotated[float, Field(gt=0)] = Field(
        5.0, description="Of every joint that `joints` gives none [rad/s^2 or m/s^2]."
    )
    effort_source: str = Field("", description="Of every effort limit that `joints` gives none.")
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
        SpecError: The file is not there, no YAML, or says something that cannot be meant; every
            problem at its place.
    """
    text = read_text(folder / FILE)
    try:
        content: Any = yaml.load(text, Loader=LOADER)
        return RobotYaml.model_validate(content)
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        errors = error.errors(include_url=False) if isinstance(error, ValidationError) else []
        problems = [(item["loc"], item["msg"]) for item in errors]
        raise robot_yaml_error(folder, problems or [((), str(error))]) from error


def robot_yaml_error(folder: Path, problems: Iterable[tuple[Loc, str]]) -> SpecError:
    """Mistakes of a robot.yaml, each at its place.

    Raises:
        SpecError: The file is no YAML.
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
