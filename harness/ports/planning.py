"""The ports that plan for one robot."""

from __future__ import annotations

from typing import NamedTuple

from harness.ports.kinematics import Kinematics
from harness.ports.motion_planning import MotionPlanner
from harness.ports.scene import PlanningScene


class PlanningPorts(NamedTuple):
    """A planning scene, and the kinematics and the motion planner that work with it."""

    scene: PlanningScene
    kinematics: Kinematics
    planner: MotionPlanner
