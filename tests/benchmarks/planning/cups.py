"""Problems of carrying a cup: the link that holds it stays upright on the way."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np

from harness.core.errors import PlanningFailed
from harness.core.geometry import Box, CollisionMode, Cylinder, Shape
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.language.scenario import RobotSpec
from harness.planning.backend import make_planning
from harness.planning.collision.checker import MotionChecker
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import OrientationBand, PathConstraints, PoseGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions, PlanningPorts
from harness.ports.motions import FreeMotion
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot
from tests.benchmarks.planning.arms import fr3_files
from tests.planning.seven_joints import SRDF, seven_joint_urdf

CUP = "cup"
TOLERANCES = {"narrow": 0.02, "wide": 0.4}
MOST_DRAWS = 300


@dataclass(frozen=True)
class CupArm:
    """An arm, where it works [m], and how its tool points when a cup in it stands upright.

    Attributes:
        rpy: The tool's orientation at heading 0 [rad].
        radius: The range of distances from the base [m].
        height: The range of heights over the base [m].
    """

    name: str
    robot: Callable[[], RobotSpec]
    link: str
    group: str
    rpy: tuple[float, float, float]
    radius: tuple[float, float]
    height: tuple[float, float]

    @property
    def description(self) -> RobotDescription:
        return _described(self)


@cache
def _described(arm: CupArm, collision: CollisionMode = "parts") -> RobotDescription:
    return load_robot(arm.robot(), collision=collision)


@cache
def _seven() -> RobotSpec:
    folder = Path(mkdtemp(prefix="cups_"))
    (folder / "seven.urdf").write_text(seven_joint_urdf())
    (folder / "seven.srdf").write_text(SRDF)
    return RobotSpec(urdf=str(folder / "seven.urdf"), srdf=str(folder / "seven.srdf"))


AHEAD = (0.0, np.pi / 2, 0.0)
"""The z axis of the tool is horizontal [rad]."""

ARMS = (
    CupArm(
        "UR5e and RH-P12-RN(A)",
        lambda: RobotSpec.model_validate({"model": "ur5e", "gripper": "rh_p12_rn_a"}),
        *("end_effector_link", "ur_manipulator"),
        AHEAD,
        *((0.35, 0.65), (0.15, 0.6)),
    ),
    CupArm(
        "FR3 and its hand",
        lambda: RobotSpec.model_validate(fr3_files()),
        *("fr3_link8", "fr3_arm"),
        AHEAD,
        *((0.35, 0.6), (0.2, 0.65)),
    ),
    CupArm("seven joints", _seven, "tool", "arm", AHEAD, (0.4, 0.65), (0.15, 0.6)),
)


@dataclass(frozen=True, eq=False)
class CupProblem:
    """A start from which a pose is reached while the cup stays upright."""

    arm: CupArm
    kind: str
    number: int
    ports: PlanningPorts
    state: np.ndarray
    goal: PoseGoal
    constraints: PathConstraints

    def request(self, options: PlanningOptions) -> MotionRequest:
        motion = FreeMotion(self.goal, self.constraints)
        return MotionRequest(self.arm.group, self.state, motion, options)

    def space(self) -> GroupSpace:
        return GroupSpace(self.ports.scene.robot, self.arm.group, self.state)

    def checker(self, options: PlanningOptions) -> MotionChecker:
        space = self.space()
        return MotionChecker(self.ports.scene, space, space.part(self.state), options.padding)

    def forget(self) -> None:
        self.ports.scene.set_allowed((), allowed=True)


def obstacles(kind: str, rng: np.random.Generator) -> tuple[list[Shape], float, float]:
    """What stands around the arm, and the headings of start and goal [rad]."""
    side = rng.choice([-1, 1])
    first, second = side * rng.uniform(0.5, 0.9), -side * rng.uniform(0.5, 0.9)
    shapes: list[Shape] = []
    if kind in ("posts", "held", "narrow", "wide"):
        for heading in rng.uniform(-0.4, 0.4, 3):
            far, tall = rng.uniform(0.4, 0.75), rng.uniform(0.3, 0.7)
            place = (far * np.cos(heading), far * np.sin(heading), tall / 2)
            shapes.append(Shape(Box((0.05, 0.05, tall)), SE3.from_xyz_rpy(place, (0, 0, 0))))
    if kind == "turn":
        first, second = side * rng.uniform(1.2, 1.5), -side * rng.uniform(1.2, 1.5)
        place = (0.45, 0.0, 0.2)
        shapes.append(Shape(Box((0.3, 0.1, 0.4)), SE3.from_xyz_rpy(place, (0, 0, 0))))
    if kind == "wall":
        tall = rng.uniform(0.2, 0.35)
        shapes.append(
            Shape(Box((0.4, 0.03, tall)), SE3.from_xyz_rpy((0.65, 0, tall / 2), (0,) * 3))
        )
    if kind == "shelf":
        low, depth, width = rng.uniform(0.15, 0.3), 0.3, 0.5
        x = rng.uniform(0.5, 0.6) + depth / 2
        for z in (low, low + 0.4):
            shapes.append(Shape(Box((depth, width, 0.02)), SE3.from_xyz_rpy((x, 0, z), (0,) * 3)))
        for y in (-width / 2, width / 2):
            pose = SE3.from_xyz_rpy((x, y, low + 0.2), (0,) * 3)
            shapes.append(Shape(Box((depth, 0.02, 0.4)), pose))
        second = rng.uniform(-0.15, 0.15)
    return shapes, first, second


KINDS = ("posts", "held", "narrow", "wide", "turn", "wall", "shelf")


def cup_problems(each: int, seed: int) -> Iterator[CupProblem]:
    """`each` problems of every arm and kind."""
    for place, arm in enumerate(ARMS):
        for index, kind in enumerate(KINDS):
            rng = np.random.default_rng([seed, place, index])
            for number in range(each):
                yield _drawn(arm, kind, number, rng)


def _drawn(arm: CupArm, kind: str, number: int, rng: np.random.Generator) -> CupProblem:
    for _ in range(MOST_DRAWS):
        problem = _problem(arm, kind, number, rng)
        if problem is not None:
            return problem
    raise AssertionError(f"no problem of {arm.name}, {kind}")


def _problem(arm: CupArm, kind: str, number: int, rng: np.random.Generator) -> CupProblem | None:
    ports = make_planning(arm.description)
    scene, kinematics = ports.scene, ports.kinematics
    shapes, *headings = obstacles(kind, rng)
    for index, shape in enumerate(shapes):
        _add(scene, f"thing{index}", shape, SE3.identity())
    poses = [_tool_pose(arm, heading, rng) for heading in headings]
    if kind == "shelf":
        board = shapes[0].pose.translation
        reach = board[0] - 0.1 - poses[1].translation[0]
        poses[1] = SE3.from_xyz_rpy((reach, 0, 0), (0,) * 3) @ poses[1]
        lift = board[2] + 0.2 - poses[1].translation[2]
        poses[1] = SE3.from_xyz_rpy((0, 0, lift), (0,) * 3) @ poses[1]
    state = np.array(arm.description.start_positions())
    starts = kinematics.solve(arm.group, PoseGoal(arm.link, poses[0]), state, 0)
    indices = list(arm.description.group_indices(arm.group))
    options = PlanningOptions(padding=0.002)
    for start in starts:
        state[indices] = start
        if not scene.touches(state, 0.002):
            break
    else:
        return None
    link = arm.link
    middle = SE3.from_xyz_rpy((0, 0, 0), arm.rpy).rotation
    axis = int(np.argmax(np.abs(middle[2])))
    if kind == "held":
        offset = SE3.from_xyz_rpy((0, 0, -0.05), (0,) * 3)
        here = SE3(np.eye(3), poses[0].translation) @ offset
        _add(scene, CUP, Shape(Cylinder(0.03, 0.1)), here)
        scene.attach_object(CUP, arm.link, tuple(arm.description.link_names), state)
        link, middle, axis = CUP, np.eye(3), 2
        if scene.touches(state, 0.002):
            return None
    tolerance = [TOLERANCES.get(kind, 0.1)] * 3
    tolerance[axis] = 3.15
    constraints = PathConstraints(OrientationBand(link, middle, tuple(tolerance)))
    problem = CupProblem(
        arm, kind, number, ports, state.copy(), PoseGoal(arm.link, poses[1]), constraints
    )
    try:
        ports.planner.check_goal(problem.request(options))
    except PlanningFailed:
        return None
    return problem


def _tool_pose(arm: CupArm, heading: float, rng: np.random.Generator) -> SE3:
    far, high = rng.uniform(*arm.radius), rng.uniform(*arm.height)
    turned = SE3.from_xyz_rpy((0, 0, 0), (0, 0, heading))
    return turned @ SE3.from_xyz_rpy((far, 0, high), arm.rpy)


def _add(scene, name: str, shape: Shape, pose: SE3) -> None:
    scene.add_object(
        WorldObject(name, (shape,), pose, True, 0.0, np.zeros(3), np.zeros((3, 3))), pose
    )
