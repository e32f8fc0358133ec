"""The lesson's robots and objects, made by hand for the planning tests."""

from functools import cache
from pathlib import Path

import numpy as np

from harness.core.geometry import Box, Cylinder, Plane, Shape
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.language.scenario import RobotSpec
from harness.planning.backend import make_planning
from harness.ports.goals import PoseGoal
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot
from tests.second_opinion.runs import SRDF, URDF

GRASP_QUAT_WXYZ = (0.0, 0.924, -0.383, 0.0)
ARM = "ur_manipulator"
TCP = "end_effector_link"


@cache
def ur(model: str) -> RobotDescription:
    """The lesson's arm with its gripper, on the table."""
    spec = {"model": model, "gripper": "rh_p12_rn_a", "base": {"xyz": [0, 0, 1.02]}}
    return load_robot(RobotSpec.model_validate(spec))


@cache
def open_manipulator() -> RobotDescription:
    """OpenMANIPULATOR-X, on the table."""
    spec = {"model": "open_manipulator_x", "base": {"xyz": [0, 0, 1.02]}}
    return load_robot(RobotSpec.model_validate(spec))


def at(x, y, z, rpy=(0, 0, 0)) -> SE3:
    return SE3.from_xyz_rpy((x, y, z), rpy)


def thing(name, pose, *shapes, static=True) -> WorldObject:
    return WorldObject(name, shapes, pose, static, 0.0, np.zeros(3), np.zeros((3, 3)))


def tables() -> list[WorldObject]:
    """The two tables and the ground of the lesson's worlds."""
    shapes = [Shape(Box((1.5, 0.8, 0.03)), at(0, 0, 1))]
    shapes += [
        Shape(Cylinder(0.02, 1), at(x, y, 0.5)) for x in (0.68, -0.68) for y in (0.38, -0.38)
    ]
    return [
        thing("Table", at(0.4, 0.4, 0), *shapes),
        thing("Table_0", at(0.4, -0.4, 0), *shapes),
        thing("ground_plane", at(0, 0, 0), Shape(Plane())),
    ]


def boxes(*items) -> WorldObject:
    """One object of boxes (size, xyz in base_link), as the lesson adds them."""
    return thing("boxes", at(0, 0, 1.02), *(Shape(Box(size), at(*xyz)) for size, xyz in items))


FIRST_BOXES = (((0.05, 0.3, 0.2), (0, -0.6, 0.5)), ((0.05, 0.3, 0.2), (0.3, 0.3, 0.7)))
SECOND_BOX = (((0.03, 0.3, 0.04), (0.2, -0.3, 0.02)),)


class Cell:
    """A planning scene with the lesson's tables."""

    def __init__(self, description: RobotDescription, *, with_tables: bool = True) -> None:
        self.description = description
        self.scene, self.kinematics, self.planner = make_planning(description)
        for item in tables() if with_tables else ():
            self.scene.add_object(item, item.pose)
        self.state = description.start_positions()

    def named(self, name: str) -> np.ndarray:
        """A named state of the arm, in the group's order."""
        group = self.description.arm_group
        positions = self.description.states_of(group)[name].positions
        return np.array([positions[joint] for joint in self.description.groups[group].joint_names])

    def with_arm(self, positions) -> np.ndarray:
        """The whole robot with the arm somewhere."""
        state = self.state.copy()
        state[list(self.description.group_indices(self.description.arm_group))] = positions
        return state

    def add(self, item: WorldObject) -> None:
        self.scene.add_object(item, item.pose)


def grasp_goal(x, y, z, **tolerances) -> PoseGoal:
    """The lesson's downward pose of the TCP, given in base_link."""
    return PoseGoal(
        TCP, at(0, 0, 1.02) @ SE3.from_xyz_quat((x, y, z), GRASP_QUAT_WXYZ), **tolerances
    )


def gantry_cell(folder: Path) -> Cell:
    """A gantry of prismatic joints with two fingers, its files in a folder."""
    files = {"urdf": folder / "gantry.urdf", "srdf": folder / "gantry.srdf"}
    files["urdf"].write_text(URDF)
    files["srdf"].write_text(SRDF)
    spec = RobotSpec.model_validate({name: str(file) for name, file in files.items()})
    cell = Cell(load_robot(spec), with_tables=False)
    cell.state = cell.with_arm([-0.2, 0.3])
    return cell
