"""Planning problems: an arm and its gripper, objects around it, and two free positions."""

# pyright: reportAttributeAccessIssue=false

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from harness.core.geometry import CollisionMode, Plane, Shape
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.planning.backend import make_planning
from harness.planning.collision.checker import MotionChecker
from harness.planning.collision.scene import CoalScene
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import PoseGoal
from tests.benchmarks.planning.arms import ARMS, Arm
from tests.benchmarks.planning.layouts import FAMILIES, Layout


@dataclass(frozen=True)
class Route:
    """How the robot's meshes are taken.

    Attributes:
        name: What tables call it.
        padding: The distance kept from objects [m].
    """

    name: str
    collision: CollisionMode
    padding: float


DEFAULT = Route("convex parts, padding of 2 mm", "parts", 0.002)
"""What scenarios have when they say nothing."""

EXACT = Route("exact meshes", "exact", 0.0)

FINE = 1 / 128  # [rad]
GROUND_HEIGHT = -0.06  # [m]
MOST_DRAWS = 200


@dataclass(frozen=True, eq=False)
class Problem:
    """An arm, what stands around it, and two free joint positions that no straight line joins.

    Attributes:
        number: The problem's place among those of its arm and family, from 0.
        obstacles: All in the world frame, but for the ground.
        ground: The height of the ground [m]; None where there is none.
    """

    arm: Arm
    family: str
    number: int
    route: Route
    obstacles: tuple[Shape, ...]
    scene: CoalScene
    space: GroupSpace
    start: FloatArray
    goal: FloatArray
    ground: float | None = GROUND_HEIGHT

    def checker(self) -> MotionChecker:
        """A checker of motions from the start."""
        return MotionChecker(self.scene, self.space, self.start, self.route.padding)

    def forget(self) -> None:
        """Load the scene anew, as after a change."""
        self.scene.set_allowed((), allowed=True)


def free_by_pairs(problem: Problem) -> Callable[[FloatArray], bool]:
    """Collision checking as it is usually written in Python: all pairs, state by state."""
    check = _CoalCheck(problem.scene, problem.space, problem.route.padding)
    model, data, geometry, found = check.arrays
    return lambda positions: (
        not pin.computeCollisions(
            model, data, geometry, found, check.configuration(positions), True
        )
    )


def free_by_broad_phase(problem: Problem) -> Callable[[FloatArray], bool]:
    """Collision checking by those who know Pinocchio well: a tree of boxes sorts pairs out."""
    return free_by_margins(problem, 0.0)


def free_by_margins(problem: Problem, extra: FloatArray | float) -> Callable[[FloatArray], bool]:
    """The same with larger margins: what is added for each pair [m], shape (K,)."""
    check = _CoalCheck(problem.scene, problem.space, problem.route.padding, extra)
    model, data, geometry, found = check.arrays
    manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(model, geometry, found)
    return lambda positions: (
        not pin.computeCollisions(model, data, manager, check.configuration(positions), True)
    )


class _CoalCheck:
    """What Pinocchio needs for checks with margins, apart from the data of the scene."""

    def __init__(
        self,
        scene: CoalScene,
        space: GroupSpace,
        padding: float,
        extra: FloatArray | float = 0.0,
    ) -> None:
        model = scene.collision_model()
        self._robot, self._space = model.robot, space
        found = model.check_data(model.margins(padding) + extra)
        self.arrays = self._robot.model, self._robot.model.createData(), model.geometry, found

    def configuration(self, positions: FloatArray) -> FloatArray:
        return self._robot.configuration(self._space.whole(positions))


def make_problems(route: Route, each: int, seed: int) -> list[Problem]:
    """`each` problems of every arm and family."""
    return [
        make_problem(route, arm, family, number, seed)
        for arm in ARMS
        for family in FAMILIES
        for number in range(each)
    ]


def make_problem(route: Route, arm: Arm, family: str, number: int, seed: int) -> Problem:
    """Draw until start and goal are free and the straight line between them is not.

    Raises:
        AssertionError: `MOST_DRAWS` draws had none.
    """
    rng = np.random.default_rng([seed, ARMS.index(arm), list(FAMILIES).index(family), number])
    for _ in range(MOST_DRAWS):
        drawn = FAMILIES[family](rng, arm.scale)
        problem = _problem(route, arm, family, number, drawn, rng)
        if problem is not None:
            return problem
    raise AssertionError(f"no problem: {arm.name}, {family} {number} of the seed {seed}")


def _problem(
    route: Route, arm: Arm, family: str, number: int, drawn: Layout, rng: np.random.Generator
) -> Problem | None:
    description = arm.description(route.collision)
    scene, kinematics, _ = make_planning(description)
    add_object(scene, "ground", Shape(Plane()), GROUND_HEIGHT)
    for index, shape in enumerate(drawn.shapes):
        add_object(scene, f"thing{index}", shape)
    whole, ready = np.array(description.start_positions()), np.array(arm.ready)
    whole[list(description.group_indices(arm.group))] = ready
    space = GroupSpace(kinematics.robot, arm.group, whole)
    made = Problem(arm, family, number, route, tuple(drawn.shapes), scene, space, ready, ready)
    free = free_by_broad_phase(made)
    ends = [ready] if rng.random() < 0.5 else []
    if ends and not free(ready):
        return None
    goals = list(drawn.goals)
    rng.shuffle(goals)
    for pose in goals[: 2 - len(ends)]:
        seed = space.whole(ends[-1]) if ends else whole
        answers = kinematics.solve(arm.group, PoseGoal(arm.flange, pose), seed, 0)
        ends += [q for q in answers if _is_usual(arm, q) and free(q)][:1]
    if len(ends) < 2:
        return None
    found = Problem(arm, family, number, route, made.obstacles, scene, space, *ends)
    return None if found.checker().edge_free(ends[0], ends[1], FINE) else found


def add_object(scene: CoalScene, name: str, shape: Shape, height: float = 0.0) -> None:
    """Add an object of one shape, as a world file does."""
    pose = SE3.from_xyz_rpy((0, 0, height), (0, 0, 0))
    scene.add_object(
        WorldObject(name, (shape,), pose, True, 0.0, np.zeros(3), np.zeros((3, 3))), pose
    )


def _is_usual(arm: Arm, positions: FloatArray) -> bool:
    """Whether the arm faces what it works at: not wound through a shelf."""
    return all(low < positions[joint] < high for joint, (low, high) in arm.usual.items())
