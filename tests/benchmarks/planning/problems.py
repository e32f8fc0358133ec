"""Planning problems: an arm with meshes, what stands around it, and two free positions."""

# pyright: reportAttributeAccessIssue=false

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from harness.core.geometry import Plane, Shape
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.planning.backend import make_planning
from harness.planning.collision.checker import MotionChecker
from harness.planning.collision.scene import CoalScene
from harness.planning.model.robot_model import GroupSpace
from harness.ports import PoseGoal
from tests.benchmarks.planning.arms import HAND, arm
from tests.benchmarks.planning.layouts import FAMILIES, Layout

GROUP = "ur_manipulator"
SCALE = {"ur5e": 1.0, "ur3e": 0.62}
"""Arms, and how large things are for them."""

READY = np.array([0.0, -2.0, 1.9, -1.5, -1.57, 0.0])
"""Where half of the problems start, TCP in front of the arm, pointing down."""

FINE = 1 / 128  # [rad]
GROUND_HEIGHT = -0.06  # [m]
MOST_DRAWS = 200


@dataclass(frozen=True, eq=False)
class Problem:
    """An arm, what stands around it, and two free joint positions that no straight line joins.

    Attributes:
        obstacles: All in the world frame, but for the ground.
    """

    name: str
    family: str
    model: str
    obstacles: tuple[Shape, ...]
    scene: CoalScene
    space: GroupSpace
    start: np.ndarray
    goal: np.ndarray

    def checker(self) -> MotionChecker:
        """A checker of motions from the start."""
        return MotionChecker(self.scene, self.space, self.start, 0.0)

    def forget(self) -> None:
        """Load the scene anew, as after a change."""
        self.scene.set_allowed((), allowed=True)


class EveryPair:
    """Collision checking as it is usually written in Python: every pair, state by state."""

    def __init__(self, scene: CoalScene, space: GroupSpace) -> None:
        model = scene.collision_model()
        self._robot, self._geometry = model.robot, model.geometry
        self._data = self._robot.model.createData()
        self._geometry_data = self._geometry.createData()
        self._space = space
        self.checks = 0

    def free(self, positions: np.ndarray) -> bool:
        """Whether nothing touches."""
        self.checks += 1
        configuration = self._robot.configuration(self._space.whole(positions))
        return not pin.computeCollisions(
            self._robot.model,
            self._data,
            self._geometry,
            self._geometry_data,
            configuration,
            False,
        )


def make_problems(each: int, first: int = 0) -> Iterator[Problem]:
    """`each` problems of every family for both arms, from a number on."""
    for model in SCALE:
        for family in FAMILIES:
            for number in range(first, first + each):
                yield make_problem(model, family, number)


def make_problem(model: str, family: str, number: int) -> Problem:
    """Draw until start and goal are free and the straight line between them is not.

    Raises:
        AssertionError: `MOST_DRAWS` draws had none.
    """
    seed = [list(SCALE).index(model), list(FAMILIES).index(family), number]
    rng = np.random.default_rng(seed)
    for _ in range(MOST_DRAWS):
        made = FAMILIES[family](rng, SCALE[model])
        problem = _problem(model, family, number, made, rng)
        if problem is not None:
            return problem
    raise AssertionError(f"no problem: {model} {family} {number}")


def _problem(
    model: str, family: str, number: int, made: Layout, rng: np.random.Generator
) -> Problem | None:
    scene, kinematics, _ = make_planning(arm(model))
    for name, shapes, height in (
        ("ground", [Shape(Plane())], GROUND_HEIGHT),
        ("things", made.shapes, 0.0),
    ):
        pose = SE3.from_xyz_rpy((0, 0, height), (0, 0, 0))
        thing = WorldObject(name, tuple(shapes), pose, True, 0.0, np.zeros(3), np.zeros((3, 3)))
        scene.add_object(thing, pose)
    space = GroupSpace(kinematics.robot, GROUP, READY)
    free = EveryPair(scene, space).free
    ends = [READY] if number % 2 == 0 else []
    if ends and not free(READY):
        return None
    goals = list(made.goals)
    rng.shuffle(goals)
    for pose in goals[: 2 - len(ends)]:
        answers = kinematics.solve(GROUP, PoseGoal(HAND, pose), ends[-1] if ends else READY, 0)
        ends += [q for q in answers if _is_usual(q) and free(q)][:1]
    if len(ends) < 2:
        return None
    name = f"{model} {family} {number}"
    found = Problem(name, family, model, tuple(made.shapes), scene, space, ends[0], ends[1])
    return None if found.checker().edge_free(ends[0], ends[1], FINE) else found


def _is_usual(positions: np.ndarray) -> bool:
    """Whether the arm faces what it works at, its upper arm raised: not wound through a shelf."""
    return abs(positions[0]) < np.pi / 2 and -3.0 < positions[1] < -0.1
