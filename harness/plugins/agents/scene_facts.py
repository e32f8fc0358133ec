"""What stands where in a scenario at its start, as plain data for JSON and for text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.cell.cell import Cell
from harness.cell.grasping import level_sides
from harness.cell.program import Program, ProgramStep
from harness.core.errors import StepFailed
from harness.core.geometry import Shape, bounds_of
from harness.core.spatial import SE3, xyzw_from_wxyz
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.planning.backend import make_planning
from harness.planning.collision.scene import CoalScene
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.ports.motion_planning import PlanningPorts
from harness.recording.explanation import Explanation
from harness.robot.random_positions import sample_robot_positions
from harness.session.dry_run import DrySimulator
from harness.session.execute import ProgramExecution
from harness.session.predict import predict
from harness.session.prepare import Prepared
from harness.steps.pick import GraspChoice, Pick

FORMAT = "armharness-describe/1"
REACH_SAMPLES = 2000  # random joint positions among which the farthest TCP is found
DECIMALS = 6  # a micrometre: more digits are noise to a reader

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class PoseFacts:
    """A pose in the world: position [m] and quaternion."""

    xyz: Numbers
    quat_xyzw: Numbers


@dataclass(frozen=True)
class JointFacts:
    """A joint that can be commanded: where it starts, and its limits [rad or m]; None: no limit."""

    start: float
    lower: float | None
    upper: float | None
    unit: str


@dataclass(frozen=True)
class GripperFacts:
    """The gripper: its joint, and the smallest and the largest gap between its pads [m]."""

    joint: str
    closes_to: float
    opens_to: float


@dataclass(frozen=True)
class ReachFacts:
    """Where the TCP comes in random joint positions.

    Attributes:
        farthest: The largest distance of the TCP from the arm's first link [m].
        low: The least coordinates in the world [m].
        high: The largest coordinates in the world [m].
    """

    farthest: float
    low: Numbers
    high: Numbers


@dataclass(frozen=True)
class RobotFacts:
    """The robot at the start of the run."""

    name: str
    base_link: str
    base: PoseFacts
    tcp_link: str
    tcp: PoseFacts
    arm_group: str
    joints: Mapping[str, JointFacts]
    named_states: Mapping[str, tuple[str, ...]]
    gripper: GripperFacts | None
    reach: ReachFacts | None


@dataclass(frozen=True)
class SideFacts:
    """A level side of an object: its width [m], and whether the gripper can close on it."""

    width: float
    fits: bool


@dataclass(frozen=True)
class PickFacts:
    """Whether a step `pick` of the object, as the first one, finds a grasp; else its error.

    Grasp, approach and lift are tried without physics. That a path leads there is not known.
    """

    is_possible: bool
    grasps: int = 0
    error_code: str = ""
    message: str = ""
    advice: str = ""


@dataclass(frozen=True)
class ClearanceFacts:
    """The robot's link nearest to an object, and the distance [m]; negative where they overlap."""

    link: str
    distance: float


@dataclass(frozen=True)
class LaterFacts:
    """An object that a step adds.

    Attributes:
        name: The name of the object.
        shape: `box`, `cylinder`, `sphere`, `capsule`, `plane`, `mesh`, or the number of shapes.
        size: Lengths of the box around its shapes, along its own axes [m]; None for a plane.
        mass: The mass [kg]; None for what never moves.
        is_in: Where it exists: `planning`, `simulation`.
    """

    name: str
    shape: str
    size: Numbers | None
    mass: float | None
    is_in: tuple[str, ...]


@dataclass(frozen=True)
class ObjectFacts(LaterFacts):
    """An object of the scene.

    Attributes:
        pose: The pose of its frame at the start.
        low: The least coordinates of the box around it in the world [m]; None for a plane.
        high: The largest coordinates; `high[2]` is where something stands on it.
        clearance: The distance from the robot at the start; None where the planner ignores it.
        level_sides: Widths between which the gripper chooses; empty where none is known.
        pick: The result of picking it; None for what never moves, and without a gripper.
    """

    pose: PoseFacts
    low: Numbers | None
    high: Numbers | None
    clearance: ClearanceFacts | None = None
    level_sides: tuple[SideFacts, ...] = ()
    pick: PickFacts | None = None


@dataclass(frozen=True)
class SceneFacts:
    """A scenario at its start. Lengths in m, angles in rad, poses in the world."""

    format: str
    file: str
    scenario: str
    robot: RobotFacts
    objects: tuple[ObjectFacts, ...]
    added_later: tuple[LaterFacts, ...]
    cameras: tuple[str, ...]


def scene_facts(prepared: Prepared, file: str) -> SceneFacts:
    """Everything that is known of a scene before anything moves.

    Args:
        prepared: The scenario, whose planning scene contains the robot alone.
        file: The name of its file.
    """
    program = prepared.program
    simulator = DrySimulator(program, prepared.ports.scene)
    execution = ProgramExecution(program, prepared.ports, simulator, lambda *_: None)
    clearances = _clearances(prepared.ports, program)
    return SceneFacts(
        format=FORMAT,
        file=file,
        scenario=program.title,
        robot=_robot(program, prepared.ports),
        objects=tuple(
            _of_object(obj, execution.cell, clearances.get(obj.name), prepared)
            for obj in program.world.objects
        ),
        added_later=tuple(_later(obj) for obj in program.later_objects.values()),
        cameras=tuple(program.cameras),
    )


def _robot(program: Program, ports: PlanningPorts) -> RobotFacts:
    description, start = program.description, program.description.start_positions()
    hand = description.gripper
    link = description.tcp_link or description.links[-1].name
    return RobotFacts(
        name=description.name,
        base_link=description.base_link,
        base=_pose(ports.kinematics.link_pose(start, description.base_link)),
        tcp_link=link,
        tcp=_pose(ports.kinematics.link_pose(start, link)),
        arm_group=description.arm_group,
        joints={
            joint.name: JointFacts(
                _rounded(start[index]),
                _limit(joint.lower),
                _limit(joint.upper),
                joint.position_unit,
            )
            for index, joint in enumerate(description.movable_joints)
            if joint.mimic is None
        },
        named_states={name: tuple(description.states_of(name)) for name in description.groups},
        gripper=hand
        and GripperFacts(
            hand.joint,
            _rounded(np.interp(hand.closed_position, hand.widths[:, 0], hand.widths[:, 1])),
            _rounded(hand.widths[:, 1].max()),
        ),
        reach=_reach(program, ports),
    )


def _reach(program: Program, ports: PlanningPorts) -> ReachFacts | None:
    description, kinematics = program.description, ports.kinematics
    if not (description.arm_group and description.tcp_link):
        return None
    assert isinstance(kinematics, PinocchioKinematics)
    samples = sample_robot_positions(description, REACH_SAMPLES, np.random.default_rng(0))
    links = (description.base_link, description.tcp_link)
    points = kinematics.link_poses(samples, links)[:, :, :3]
    away = float(np.linalg.norm(points[:, 1] - points[:, 0], axis=1).max())
    low, high = points[:, 1].min(axis=0), points[:, 1].max(axis=0)
    return ReachFacts(round(away, 3), _numbers(low, 3), _numbers(high, 3))


def _clearances(ports: PlanningPorts, program: Program) -> dict[str, ClearanceFacts]:
    """The link nearest to each object, of the pairs that planning checks."""
    scene, found = ports.scene, dict[str, ClearanceFacts]()
    assert isinstance(scene, CoalScene)
    names = {*scene.object_names()}
    for touch, _ in scene.distances(program.description.start_positions()):
        if touch.second in names and touch.first not in names:
            found.setdefault(touch.second, ClearanceFacts(touch.first, _rounded(touch.distance)))
    return found


def _of_object(
    obj: WorldObject, cell: Cell, clearance: ClearanceFacts | None, prepared: Prepared
) -> ObjectFacts:
    placed = bounds_of(Shape(each.geometry, obj.pose @ each.pose) for each in obj.shapes)
    facts = ObjectFacts(
        **vars(_later(obj)),
        pose=_pose(obj.pose),
        low=_numbers(placed[0]) if placed else None,
        high=_numbers(placed[1]) if placed else None,
        clearance=clearance,
    )
    description = cell.description
    if description.gripper is None or obj.is_static or not (obj.in_simulation and obj.in_planning):
        return facts
    sides = tuple(SideFacts(_rounded(width), fits) for width, fits in _sides(obj, cell))
    return replace(facts, level_sides=sides, pick=_pick(obj.name, prepared))


def _sides(obj: WorldObject, cell: Cell) -> Iterator[tuple[float, bool]]:
    try:
        yield from level_sides(obj, obj.pose, cell)
    except StepFailed:  # it leans, or its shape has no sides; `pick` reports which
        return


def _pick(name: str, prepared: Prepared) -> PickFacts | None:
    """What `harness check` would report of a scenario whose only step picks the object."""
    program = prepared.program
    if not program.description.arm_group or not program.steps:
        return None
    step = ProgramStep(f"pick {name}", "pick", Pick(object=name), name, 0, program.steps[0].options)
    alone = replace(program, steps=(step,))
    records, _ = predict(alone, make_planning(program.description))
    record = records[0]
    choice = record.result.find(GraspChoice)
    explanation = record.explanation.find(Explanation)
    return PickFacts(
        is_possible=not record.error_code,
        grasps=choice.grasps if choice else 0,
        error_code=record.error_code,
        message=record.message,
        advice=(explanation.advice or "") if explanation else "",
    )


def _later(obj: WorldObject) -> LaterFacts:
    """What is known of an object wherever it is."""
    own = bounds_of(obj.shapes)
    kinds = {type(each.geometry).__name__.lower() for each in obj.shapes}
    is_single = len(obj.shapes) == 1 or kinds == {"mesh"}
    where = {"planning": obj.in_planning, "simulation": obj.in_simulation}
    return LaterFacts(
        name=obj.name,
        shape=kinds.pop() if kinds and is_single else f"{len(obj.shapes)} shapes",
        size=_numbers(own[1] - own[0]) if own else None,
        mass=None if obj.is_static else _rounded(obj.mass),
        is_in=tuple(name for name, is_there in where.items() if is_there),
    )


def _pose(pose: SE3) -> PoseFacts:
    return PoseFacts(_numbers(pose.translation), _numbers(xyzw_from_wxyz(pose.quat_wxyz)))


def _limit(value: float) -> float | None:
    return _rounded(value) if np.isfinite(value) else None


def _numbers(values: FloatArray, decimals: int = DECIMALS) -> Numbers:
    return tuple(round(float(value), decimals) + 0.0 for value in values)


def _rounded(value: float) -> float:
    return round(float(value), DECIMALS)
