"""Processor time until motions among many objects can be checked."""

import statistics
import time
from dataclasses import dataclass

import numpy as np

from harness.core.geometry import Box, Cylinder, Shape
from harness.core.spatial import SE3
from harness.planning.backend import make_planning
from harness.planning.collision.checker import MotionChecker
from harness.planning.collision.scene import CoalScene
from harness.planning.model.robot_model import GroupSpace
from tests.benchmarks.planning.arms import Arm
from tests.benchmarks.planning.problems import DEFAULT, add_object

REPETITIONS = 7


@dataclass(frozen=True)
class SceneTimes:
    """Medians of a scene's set-up [s].

    Attributes:
        first: From a scene with the robot alone until a first motion is checked.
        moved: The same after one of the objects was moved.
    """

    first: float
    moved: float


def scene_times(arm: Arm, count: int, seed: int) -> SceneTimes:
    """Set up scenes with boxes and cylinders at random places in front of an arm."""
    rng = np.random.default_rng([seed, count])
    timed = [_timed(arm, count, rng) for _ in range(REPETITIONS)]
    return SceneTimes(*(statistics.median(column) for column in zip(*timed, strict=True)))


def _timed(arm: Arm, count: int, rng: np.random.Generator) -> tuple[float, float]:
    description = arm.description(DEFAULT.collision)
    scene, kinematics, _ = make_planning(description)
    whole = np.array(description.start_positions())
    whole[list(description.group_indices(arm.group))] = arm.ready
    space, begin = GroupSpace(kinematics.robot, arm.group, whole), time.process_time()
    for number, shape in enumerate(_objects(count, rng)):
        add_object(scene, f"thing{number}", shape)
    _check(scene, space, arm)
    first = time.process_time() - begin
    begin = time.process_time()
    scene.move_object("thing0", SE3.from_xyz_rpy((0.0, 0.0, 0.01), (0, 0, 0)))
    _check(scene, space, arm)
    return first, time.process_time() - begin


def _check(scene: CoalScene, space: GroupSpace, arm: Arm) -> None:
    start = np.array(arm.ready)
    MotionChecker(scene, space, start, DEFAULT.padding).edge_free(start, start, 1.0)


def _objects(count: int, rng: np.random.Generator) -> list[Shape]:
    """Beyond the arm's reach, so that the start is free."""
    found: list[Shape] = []
    for number in range(count):
        angle, far, high = rng.uniform(-2.5, 2.5), rng.uniform(0.9, 2.0), rng.uniform(0.0, 1.0)
        size = rng.uniform(0.03, 0.1, size=3)
        geometry = Cylinder(size[0] / 2, size[2]) if number % 2 else Box(tuple(size.tolist()))
        pose = SE3.from_xyz_rpy(
            (far * np.cos(angle), far * np.sin(angle), high), (0, 0, rng.uniform(0, 3))
        )
        found.append(Shape(geometry, pose))
    return found
