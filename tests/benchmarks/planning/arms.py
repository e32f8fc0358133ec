"""UR5e and UR3e with the meshes of the package airo-models as collision shapes."""

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from harness.core.geometry import Mesh, Shape
from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot

HAND = "tool0"
"""The link that the gripper's meshes are put on."""


def folder() -> Path:
    """Where airo-models is installed."""
    found = find_spec("airo_models")
    assert found is not None
    assert found.origin is not None
    return Path(found.origin).parent


@cache
def arm(model: str) -> RobotDescription:
    """`ur5e` or `ur3e` on the ground, every link but the frames a mesh, with a Robotiq 2F-85."""
    description = load_robot(RobotSpec.model_validate({"model": model}))
    links = []
    for link in description.links:
        if link.name == HAND:
            link = replace(link, collisions=gripper_shapes())
        elif link.collisions:
            link = replace(link, collisions=meshes_of(link.visuals, model))
        links.append(link)
    touching = {("tool0", "wrist_2_link"), ("tool0", "wrist_3_link")}
    allowed = {**description.allowed_collisions, **dict.fromkeys(touching, "mounted on it")}
    return replace(description, links=tuple(links), allowed_collisions=allowed)


def meshes_of(visuals: tuple[Shape, ...], model: str) -> tuple[Shape, ...]:
    """The collision meshes that belong to what a link is drawn with."""
    found = []
    for shape in visuals:
        if not isinstance(shape.geometry, Mesh):
            continue
        path = folder() / "arms" / model / "collision" / shape.geometry.path.name
        if path.exists():
            found.append(replace(shape, geometry=Mesh(path, shape.geometry.scale, exact=True)))
    return tuple(found)


@cache
def gripper_shapes() -> tuple[Shape, ...]:
    """Meshes of the open gripper, in the frame of the flange."""
    source = folder() / "grippers/robotiq_2f_85/urdf/robotiq_2f_85.urdf"
    text = re.sub(r"</?drake:[^>]*>", "", source.read_text())  # a prefix that is not declared
    root = ElementTree.fromstring(text)
    poses = {"base_link": SE3.identity()}
    for _ in root.iter("joint"):  # parents may come after children
        for joint in root.iter("joint"):
            parent, child = joint.find("parent"), joint.find("child")
            if parent is not None and child is not None and parent.get("link") in poses:
                poses[child.get("link")] = poses[parent.get("link")] @ pose_of(joint)
    shapes = []
    for link in root.iter("link"):
        for collision in link.iter("collision"):
            mesh = collision.find("geometry/mesh")
            if mesh is not None and link.get("name") in poses:
                path = (source.parent / mesh.get("filename")).resolve()
                scale = tuple(float(value) for value in mesh.get("scale", "1 1 1").split())
                shapes.append(
                    Shape(
                        Mesh(path, scale, exact=True), poses[link.get("name")] @ pose_of(collision)
                    )
                )
    return tuple(shapes)


def pose_of(element: ElementTree.Element) -> SE3:
    """An element's `origin`."""
    origin = element.find("origin")
    if origin is None:
        return SE3.identity()
    xyz, rpy = (
        np.array([float(value) for value in origin.get(key, "0 0 0").split()])
        for key in ("xyz", "rpy")
    )
    return SE3.from_xyz_rpy(xyz, rpy)
