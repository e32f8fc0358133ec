"""The bundled robots, and a collision check of their own for the tests."""

from collections.abc import Mapping

import coal
import numpy as np
import pinocchio as pin

from harness.core.geometry import Box, Capsule, Cylinder, Shape, Sphere
from harness.language.scenario import RobotSpec
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot, robot_names

UR_TYPES = tuple(name for name in robot_names() if name.startswith("ur"))


def robot(**spec) -> RobotDescription:
    """The robot that a scenario's `robot:` names."""
    return load_robot(RobotSpec.model_validate(spec))


def coal_geometry(shape: Shape) -> coal.CollisionGeometry:
    match shape.geometry:
        case Box(size=size):
            return coal.Box(*size)
        case Cylinder(radius=radius, length=length):
            return coal.Cylinder(radius, length)
        case Sphere(radius=radius):
            return coal.Sphere(radius)
        case Capsule(radius=radius, length=length):
            return coal.Capsule(radius, length)
    raise AssertionError(shape)


class Arm:
    """Forward kinematics and self-collision of a description by Pinocchio and Coal."""

    def __init__(self, description: RobotDescription) -> None:
        self.description = description
        self.model = pin.buildModelFromXML(description.urdf)
        self.data = self.model.createData()
        self.geometry = pin.GeometryModel()
        self.links = []
        for link in description.links:
            frame = self.model.frames[self.model.getBodyId(link.name)]
            for shape in link.collisions:
                pose = frame.placement * pin.SE3(shape.pose.rotation, shape.pose.translation)
                name = f"{link.name} {len(self.links)}"
                self.geometry.addGeometryObject(
                    pin.GeometryObject(name, frame.parentJoint, pose, coal_geometry(shape))
                )
                self.links.append(link.name)
        for second in range(len(self.links)):
            for first in range(second):
                if self._is_checked(self.links[first], self.links[second]):
                    self.geometry.addCollisionPair(pin.CollisionPair(first, second))
        self.geometry_data = self.geometry.createData()

    def _is_checked(self, first: str, second: str) -> bool:
        pair = (min(first, second), max(first, second))
        static = self.description.static_links
        return (
            first != second
            and pair not in self.description.allowed_collisions
            and not (first in static and second in static)
        )

    def configuration(self, positions: Mapping[str, float]) -> np.ndarray:
        """Pinocchio's vector of joint positions by name, mimic joints set, others at zero."""
        names = self.description.joint_names
        values = np.array([positions.get(name, 0.0) for name in names])
        configuration = pin.neutral(self.model)
        for name, value in zip(names, self.description.with_mimics(values), strict=True):
            configuration[self.model.joints[self.model.getJointId(name)].idx_q] = value
        return configuration

    def pose(self, link: str, positions: Mapping[str, float], frame: str = "world") -> pin.SE3:
        """T_frame_link."""
        pin.framesForwardKinematics(self.model, self.data, self.configuration(positions))
        T_world = [self.data.oMf[self.model.getBodyId(name)] for name in (frame, link)]
        return T_world[0].inverse() * T_world[1]

    def touching(self, positions: Mapping[str, float]) -> tuple[str, str] | None:
        """The first pair of links that touch, if any."""
        configuration = self.configuration(positions)
        if not pin.computeCollisions(
            self.model, self.data, self.geometry, self.geometry_data, configuration, True
        ):
            return None
        results = self.geometry_data.collisionResults
        for pair, result in zip(self.geometry.collisionPairs, results, strict=True):
            if result.isCollision():
                return self.links[pair.first], self.links[pair.second]
        raise AssertionError("a collision without a pair")
