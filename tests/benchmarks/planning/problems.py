"""Planning problems: an arm and its gripper, objects around it, and two free positions."""

# pyright: reportAttributeAccessIssue=false

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
from harness.ports.goals import PoseGoal
from tests.benchmarks.planning.arms import ARM_GROUP, FLANGE, arm
from tests.benchmarks.planning.layouts import FAMILIES, Layout


@dataclass(frozen=True)
class Route:
    """How the robot's shapes are taken.

    Attributes:
        name: What tables call it.
        exact: Whether meshes are surfaces; otherwise they are their hulls, as for every user.
        padding: The distance kept from objects [m].
    """

    name: str
    exact: bool
    padding: float


DEFAULT = Route("hulls, padding of 2 mm", exact=False, padding=0.002)
EXACT = Route("exact meshes", exact=True, padding=0.0)

HELD_OUT = 100
"""Problems with this number and higher are measured, but the planner is never tuned on them."""

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
    route: Route
    obstacles: tuple[Shape, ...]
    scene: CoalScene
    space: GroupSpace
    start: np.ndarray
    goal: np.ndarray

    def checker(self) -> MotionChecker:
        """A checker of motions from the start."""
        return MotionChecker(self.scene, self.space, self.start, self.route.padding)

    def forget(self) -> None:
        """Load the scene anew, as after a change."""
        self.scene.set_allowed((), allowed=True)


class EveryPair:
    """Collision checking as it is usually written in Python: every pair, state by state."""

    def __init__(self, scene: CoalScene, space: GroupSpace, padding: float) -> None:
        model = scene.collision_model()
        self._robot, self._geometry = model.robot, model.geometry
        self._data = self._robot.model.createData()
        self._geometry_data = self._geometry.createData()
        self._space = space
        self.checks = 0
        margins = [padding if pair.keeps_padding else 0.0 for pair in model.pairs]
        found = model.margin_map(margins)
        self._geometry_data.setSecurityMargins(self._geometry, found, True, False)

    def free(self, positions: np.ndarray) -> bool:
        """Whether nothing is nearer than its margin."""
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


def make_problems(route: Route, each: int, first: int = 0) -> list[Problem]:
    """`each` problems of every family, from a number on."""
    return [
        make_problem(route, family, number)
        for family in FAMILIES
        for number in range(first, first + each)
    ]


def make_problem(route: Route, family: str, number: int) -> Problem:
    """Draw until start and goal are free and the straight line between them is not.

    Raises:
        AssertionError: `MOST_DRAWS` draws had none.
    """
    rng = np.random.default_rng([list(FAMILIES).index(family), number])
    for _ in range(MOST_DRAWS):
        problem = _problem(route, family, number, FAMILIES[family](rng, 1.0), rng)
        if problem is not None:
            return problem
    raise AssertionError(f"no problem: {family} {number}")


def _problem(
    route: Route, family: str, number: int, made: Layout, rng: np.random.Generator
) -> Problem | None:
    description = arm(exact=route.exact)
    scene, kinematics, _ = make_planning(description)
    add_object(scene, "ground", Shape(Plane()), GROUND_HEIGHT)
    for index, shape in enumerate(made.shapes):
        add_object(scene, f"thing{index}", shape)
    whole = np.array(description.start_positions())
    whole[: len(READY)] = READY
    space = GroupSpace(kinematics.robot, ARM_GROUP, whole)
    free = EveryPair(scene, space, route.padding).free
    ends = [READY] if number % 2 == 0 else []
    if ends and not free(READY):
        return None
    goals = list(made.goals)
    rng.shuffle(goals)
    for pose in goals[: 2 - len(ends)]:
        seed = space.whole(ends[-1]) if ends else whole
        answers = kinematics.solve(ARM_GROUP, PoseGoal(FLANGE, pose), seed, 0)
        ends += [q for q in answers if _is_usual(q) and free(q)][:1]
    if len(ends) < 2:
        return None
    name = f"{family} {number}"
    found = Problem(name, family, route, tuple(made.shapes), scene, space, ends[0], ends[1])
    return None if found.checker().edge_free(ends[0], ends[1], FINE) else found


def add_object(scene: CoalScene, name: str, shape: Shape, height: float = 0.0) -> None:
    """Add an object of one shape, as a world file does."""
    pose = SE3.from_xyz_rpy((0, 0, height), (0, 0, 0))
    scene.add_object(
        WorldObject(name, (shape,), pose, True, 0.0, np.zeros(3), np.zeros((3, 3))), pose
    )


def _is_usual(positions: np.ndarray) -> bool:
    """Whether the arm faces what it works at, its upper arm raised: not wound through a shelf."""
    return abs(positions[0]) < np.pi / 2 and -3.0 < positions[1] < -0.1
