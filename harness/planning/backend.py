"""Creates the planning ports for a composed robot."""

from __future__ import annotations

from harness.planning.collision.scene import CoalScene
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.motion_planner import VerifiedPlanner
from harness.ports.motion_planning import PlanningPorts
from harness.robot.description import RobotDescription


def make_planning(description: RobotDescription) -> PlanningPorts:
    """Create a planning scene that contains only the robot, its kinematics, and a planner."""
    scene = CoalScene(description)
    kinematics = PinocchioKinematics(description)
    return PlanningPorts(scene, kinematics, VerifiedPlanner(scene, kinematics))
