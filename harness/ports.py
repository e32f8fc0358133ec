"""What the engine needs from the outside, as protocols: planner, scene, kinematics, physics."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal, Protocol

import numpy as np

from harness.core.details import Detail, Details
from harness.core.registry import Plugin
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.types import BoolArray, FloatArray
from harness.core.world import WorldObject
from harness.recording.run import Signals
from harness.robot.description import RobotDescription

LONGEST_RUN = 600.0
"""Simulated time of one run at most [s]: a file cannot fill the machine's memory or its day."""


@dataclass(frozen=True, eq=False)
class JointGoal:
    """Joint positions of the planning group, shape (dof,)."""

    positions: FloatArray


@dataclass(frozen=True, eq=False)
class PoseGoal:
    """A link at a pose.

    Attributes:
        link: A link that is rigidly attached after the group's last joint.
        pose: The pose T_world_link of the link.
        position_tolerance: Radius around the target [m].
        orientation_tolerance: Largest rotation about each axis [rad].
        axis_tolerances: The tolerances about the goal's own x, y, z instead [rad]; pi and more
            allow any turn.
    """

    link: str
    pose: SE3
    position_tolerance: float = 1e-4
    orientation_tolerance: float = 1e-3
    axis_tolerances: tuple[float, float, float] | None = None


@dataclass(frozen=True, eq=False)
class PositionGoal:
    """A link's origin at a point, its orientation free but for an optional pitch.

    Attributes:
        position: The position in the world [m], shape (3,).
        pitch: Angle of the link's x axis below the horizontal [rad] (pi/2 points down), or None.
    """

    link: str
    position: FloatArray
    pitch: float | None = None
    position_tolerance: float = 1e-4
    pitch_tolerance: float = 1e-3


Goal = JointGoal | PoseGoal | PositionGoal


@dataclass(frozen=True, eq=False)
class AnyGoal:
    """One of several goals, whichever is nearest."""

    goals: tuple[Goal, ...]


@dataclass(frozen=True, eq=False)
class OrientationBand:
    """A link stays turned as given.

    Attributes:
        link: The link of the robot.
        rotation: R_world_link in the middle of the band, shape (3, 3).
        tolerance: The tolerances about its x, y, z [rad]; pi and more allow any turn.
    """

    link: str
    rotation: FloatArray
    tolerance: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class PositionBox:
    """A link's origin stays in a box.

    Attributes:
        link: The link of the robot.
        pose: T_world_box, of its middle.
        size: Along its x, y, z, full [m].
    """

    link: str
    pose: SE3
    size: tuple[float, float, float]


@dataclass(frozen=True)
class JointBand:
    """A joint stays between two positions [rad or m]."""

    joint: str
    lower: float
    upper: float


@dataclass(frozen=True, eq=False)
class PathConstraints:
    """What must hold all along a motion."""

    orientation: OrientationBand | None = None
    position: PositionBox | None = None
    joints: tuple[JointBand, ...] = ()


@dataclass(frozen=True)
class CartesianLimits:
    """What a link may do on a line or an arc; None is Pilz's default times the scaling factors.

    Attributes:
        translation_velocity: The largest speed of the link [m/s].
        translation_acceleration: The largest acceleration [m/s^2], along the path and towards an
            arc's centre together.
        rotation_velocity: The largest turning speed [rad/s]; its acceleration is in proportion, as
            in Pilz.
    """

    translation_velocity: float | None = None
    translation_acceleration: float | None = None
    rotation_velocity: float | None = None


@dataclass(frozen=True)
class JumpThreshold:
    """Farthest that a joint may move from one pose of a path to the next.

    Attributes:
        revolute: The largest step of a revolute joint [rad].
        prismatic: The largest step of a prismatic joint [m].
    """

    revolute: float
    prismatic: float


@dataclass(frozen=True, eq=False)
class ArcPoint:
    """What makes an arc of a start and a goal.

    Attributes:
        kind: A point that the arc passes, or the centre of the shorter one.
        position: The position in the world [m], shape (3,).
    """

    kind: Literal["interim", "center"]
    position: FloatArray


@dataclass(frozen=True, eq=False)
class SequenceItem:
    """One motion of a sequence.

    Attributes:
        kind: The kind of the motion.
        goal: The goal at which it ends.
        point: What makes the arc of a circ; None for others.
        blend_radius: Around its end, inside which it goes over into the next one [m].
        cartesian_limits: The cartesian limits of lines and arcs.
    """

    kind: Literal["ptp", "lin", "circ"]
    goal: Goal
    point: ArcPoint | None = None
    blend_radius: float = 0.0
    cartesian_limits: CartesianLimits = CartesianLimits()


@dataclass(frozen=True)
class CartesianPathOptions:
    """The requirements on a Cartesian path.

    Attributes:
        max_step: Between the poses that are solved [m].
        precision: Largest distance from the straight lines, corners included [m].
        min_fraction: Least share of the path.
        jump: What no joint may exceed from one pose to the next.
    """

    max_step: float
    precision: float
    min_fraction: float
    jump: JumpThreshold


@dataclass(frozen=True)
class PlanningOptions:
    """How to plan; every number known.

    Attributes:
        pipeline: The planning pipeline, a plug-in of the kind `planner`.
        planner_id: A planner of the pipeline; of `ompl`: `auto`, or OMPL's or MoveIt's name.
        max_state_checks: Budget of state validity checks for one attempt.
        attempts: Plans tried, each with a seed of its own.
        velocity_scaling: The share of the joint velocity limits, (0, 1].
        acceleration_scaling: The share of the joint acceleration limits, (0, 1].
        padding: Distance kept between robot (and what it holds) and every object [m].
        seed: The seed of this step.
        root_seed: The seed that the seeds of nested steps follow from.
        pose_resolution: Measured positions are rounded to multiples of it before they are planned
            with [m, and the same number in rad]; 0 takes them as they are.
        parameters: The parameters of the planner: `range`, `goal_bias` ...
        max_jerk: The max jerk of every joint [rad/s^3 or m/s^3]; inf for none.
        cartesian_limits: The cartesian limits of the link, on lines and arcs.
        path_only: Leave out the times: the plan jumps from its start to its end.
    """

    pipeline: str = "ompl"
    planner_id: str = "auto"
    max_state_checks: int = 200_000
    attempts: int = 1
    velocity_scaling: float = 1.0
    acceleration_scaling: float = 1.0
    padding: float = 0.0
    seed: int = 0
    root_seed: int = 0
    pose_resolution: float = 0.0
    parameters: Mapping[str, float] = field(default_factory=dict[str, float])
    max_jerk: float = float("inf")
    cartesian_limits: CartesianLimits = CartesianLimits()
    path_only: bool = False


@dataclass(frozen=True, eq=False)
class MotionPlan:
    """A motion that was found, timed and verified.

    Attributes:
        trajectory: The trajectory to be commanded.
        statistics: The planner_id, state checks, attempts, lengths before and after shortening ...
        explanation: IK solutions and what became of each, pairs whose margin was lowered ...
        result: What the step reports of it: the fraction reached, a distance ...
    """

    trajectory: JointTrajectory
    statistics: Mapping[str, Any]
    explanation: Details
    result: Details = field(default_factory=Details)


@dataclass(frozen=True, eq=False)
class CheckedGoal:
    """A goal that can be reached.

    Attributes:
        positions: The group positions of the free solution that is tried first, shape (dof,).
        explanation: The solutions of inverse kinematics, and what rules each of them out.
    """

    positions: FloatArray
    explanation: Details


@dataclass(frozen=True)
class Touch:
    """Two bodies closer than allowed.

    Attributes:
        first: Name of a link or an object.
        second: The name of another body.
        distance: Negative for penetration [m].
        required: The smallest distance that is allowed [m].
    """

    first: str
    second: str
    distance: float
    required: float = 0.0


class PlanningScene(Protocol):
    """The planner's belief: robot, objects, attachments, allowed pairs.

    Joint vectors are in description order. Objects of the physics alone are never added here.
    """

    def add_object(self, obj: WorldObject, pose: SE3) -> None:
        """Put an object into the scene, at T_world_object."""
        ...

    def remove_object(self, name: str) -> None:
        """Take an object out of the scene."""
        ...

    def move_object(self, name: str, pose: SE3) -> None:
        """Set T_world_object of an object that is not attached."""
        ...

    def attach_object(
        self, name: str, link: str, touch_links: Sequence[str], joint_positions: FloatArray
    ) -> SE3:
        """Fix an object of the scene to a link where both stand now; returns T_link_object."""
        ...

    def detach_object(self, name: str, joint_positions: FloatArray) -> SE3:
        """Let go of an attached object; it stays in the scene at the returned T_world_object."""
        ...

    def set_allowed(self, pairs: Sequence[tuple[str, str]], *, allowed: bool) -> None:
        """Allow, or check again, collisions of pairs: links, objects, `robot` for all links."""
        ...

    def set_unpadded(self, pairs: Sequence[tuple[str, str]]) -> None:
        """Apply no padding to these pairs of a link and an object, and to no others."""
        ...

    def is_ground(self, name: str) -> bool:
        """Whether an object is solid without end below a plane."""
        ...

    def object_names(self) -> tuple[str, ...]:
        """Objects in the scene, attached ones included, in order of adding."""
        ...

    def attached(self) -> Mapping[str, str]:
        """Link of each attached object."""
        ...

    def object_pose(self, name: str, joint_positions: FloatArray) -> SE3:
        """T_world_object, attached or not."""
        ...

    def touches(self, joint_positions: FloatArray, padding: float = 0.0) -> Sequence[Touch]:
        """Pairs closer than allowed at a state, nearest first."""
        ...

    def corners(self, body: str) -> FloatArray:
        """Corners of the boxes around a body's shapes, in its frame, shape (n, 3) [m]."""
        ...

    def distance_to_link(self, link: str, point: FloatArray) -> float:
        """Distance between a point in a link's frame and the link's shapes, 0 inside [m]."""
        ...


class Kinematics(Protocol):
    """Where the robot's links are, and which joint positions put them somewhere."""

    def link_pose(self, joint_positions: FloatArray, link: str) -> SE3:
        """T_world_link at joint positions in description order."""
        ...

    def link_poses(self, joint_positions: FloatArray, links: Sequence[str]) -> FloatArray:
        """T_world_link of many samples: (N, n) -> (N, len(links), 7) as xyz, quat wxyz."""
        ...

    def solve(
        self,
        group: str,
        goal: PoseGoal | PositionGoal,
        seed_positions: FloatArray,
        seed: int,
        *,
        enough: int | None = None,
    ) -> Sequence[FloatArray]:
        """Every known solution within position limits, nearest to `seed_positions` first.

        Args:
            group: The name of a chain group.
            goal: What the link must do.
            seed_positions: Description order; joints outside the group stay there.
            seed: The seed of the restarts of numeric solvers.
            enough: The number of solutions with which a numeric solver stops; None for a spread.

        Returns:
            Group joint positions, shape (dof,) each; empty when there is none.
        """
        ...


class JointSpace(Protocol):
    """The joints of a planning group and their limits; the rest of the robot stands still."""

    joint_names: tuple[str, ...]
    lower: FloatArray
    """Position limits, shape (dof,) [rad or m]; -inf for continuous joints."""
    upper: FloatArray
    """The upper ones, shape (dof,)."""
    wraps: BoolArray
    """Which joints turn, so that a whole turn more is the same place, shape (dof,)."""
    metric: FloatArray
    """Weights of joint-space distances, shape (dof,): 1 for radians, more for metres."""

    @property
    def dof(self) -> int:
        """Number of joints."""
        ...

    def distance(self, first: FloatArray, second: FloatArray) -> float:
        """Joint-space distance in the metric [rad]."""
        ...


@dataclass(frozen=True, eq=False)
class PathRequest:
    """What a planning pipeline must find: a free path from a start to one of several goals.

    The checks answer for the planning scene as it is now, with attached objects, allowed
    collisions and padding; each costs state checks. After the budget is used up, a check ends the
    search of a third-party planner: the search has failed.

    Attributes:
        planner_id: The name of the planner, as `PathPlanner.check` returned it.
        space: The joints that move.
        start: Joint positions, shape (dof,), free.
        goals: Joint positions, shape (dof,) each, free; nearest first.
        is_state_free: Whether joint positions are free of collisions.
        is_edge_free: Whether the straight line from free joint positions to others is free.
        state_checks: The number of state checks used by this search.
        max_state_checks: The budget of this search.
        resolution: Largest distance between the states that an edge check checks [rad].
        seed: The only source of randomness; the same request must give the same path.
        parameters: The planner's parameters, by name.
    """

    planner_id: str
    space: JointSpace
    start: FloatArray
    goals: tuple[FloatArray, ...]
    is_state_free: Callable[[FloatArray], bool]
    is_edge_free: Callable[[FloatArray, FloatArray], bool]
    state_checks: Callable[[], int]
    max_state_checks: int
    resolution: float
    seed: int
    parameters: Mapping[str, float]

    @property
    def rng(self) -> np.random.Generator:
        """A generator of random numbers at the start of its sequence."""
        return np.random.default_rng(self.seed)


@dataclass(frozen=True, eq=False)
class PathResult:
    """What a planning pipeline found.

    Attributes:
        waypoints: Joint positions, shape (N, dof), from the start to a goal; None: no path.
        vertices: The number of vertices of its trees or graph, for statistics.
        gap: The joint-space distance that was left to a goal [rad]; None when it is not known.
        planner_id: The planner that found it, where `planner_id` left that open.
    """

    waypoints: FloatArray | None
    vertices: int = 0
    gap: float | None = None
    planner_id: str = ""


class PathPlanner(Plugin, ABC):
    """A planning pipeline, selected by `planning: {pipeline: NAME}`.

    Its paths are checked anew, shortened, timed and verified like those of every other pipeline.

    Attributes:
        planner_ids: Names that `planner_id` may have; empty for a pipeline of one planner.
        parameters: Names that `parameters` may have.
    """

    plugin_kind: ClassVar[str] = "planner"
    planner_ids: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def check(cls, planner_id: str, parameters: Mapping[str, float]) -> str:
        """Check a file's `planner_id` and `parameters`.

        Args:
            planner_id: The name in the file; empty where the file has none.
            parameters: The parameters in the file, by name.

        Returns:
            The planner's name; by default the first of `planner_ids`.

        Raises:
            ValueError: There is no such planner, or it takes no such parameter; says what there is.
        """
        name = planner_id or next(iter(cls.planner_ids), "")
        if name and name not in cls.planner_ids:
            known = ", ".join(cls.planner_ids) or "none, leave out `planner_id`"
            raise ValueError(
                f"the planning pipeline `{cls.name}` has no planner '{name}'; planners: {known}"
            )
        for each in parameters:
            if each not in cls.parameters:
                known = ", ".join(cls.parameters) or "none"
                raise ValueError(
                    f"the planning pipeline `{cls.name}` has no parameter '{each}' (it has: "
                    f"{known})"
                )
        return name

    @abstractmethod
    def find_path(self, request: PathRequest) -> PathResult:
        """Search a path; a new object of the class is made for every search."""


@dataclass(frozen=True, eq=False)
class IkRequest:
    """What an inverse kinematics solver must find: joint positions that put a link somewhere.

    Attributes:
        goal: The link and its pose, or its position; in world axes.
        space: The joints that move, and their limits.
        seed_positions: Joint positions to start from, shape (dof,).
        description: The robot, with its URDF and SRDF.
        link_pose: T_world_link of the goal's link at joint positions of shape (dof,).
        seed: The only source of randomness; the same request must give the same answer.
        enough: The number of solutions with which a search may stop; None for a spread.
    """

    goal: PoseGoal | PositionGoal
    space: JointSpace
    seed_positions: FloatArray
    description: RobotDescription
    link_pose: Callable[[FloatArray], SE3]
    seed: int
    enough: int | None = None

    @property
    def rng(self) -> np.random.Generator:
        """A generator of random numbers at the start of its sequence."""
        return np.random.default_rng(self.seed)


@dataclass(frozen=True, eq=False)
class IkResult:
    """What an inverse kinematics solver found.

    Attributes:
        solutions: Joint positions, shape (dof,) each, in any order; whole turns are shifted into
            the limits by the caller. Empty when the goal is not reached.
        excess: How far the goal is beyond the chain's reach [m]; 0 when unknown or within reach.
    """

    solutions: tuple[FloatArray, ...]
    excess: float = 0.0


class IkSolver(Plugin, ABC):
    """An inverse kinematics solver, selected by `robot: {ik_solver: NAME}`.

    Its answers are compared with forward kinematics, and those that miss the goal are refused.

    Attributes:
        is_refined: Answers are exact only for an ideal arm, and are refined by Newton steps.
    """

    plugin_kind: ClassVar[str] = "ik_solver"
    is_refined: ClassVar[bool] = False

    @classmethod
    def fits(cls, request: IkRequest) -> bool:
        """Whether the solver is made for such an arm and goal; otherwise `numeric` is used."""
        del request
        return True

    @abstractmethod
    def solve(self, request: IkRequest) -> IkResult:
        """Find joint positions; a new object of the class is made for every goal."""


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """A collision-free motion on any path; with constraints, every sample of it holds them."""

    goal: Goal | AnyGoal
    constraints: PathConstraints | None = None


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Pilz's PTP: all joints together, straight in joint space.

    Attributes:
        positions: The joint positions at the end, shape (dof,).
        duration: The exact duration [s]; the shortest possible one without it.
    """

    positions: FloatArray
    duration: float | None = None

    @property
    def goal(self) -> JointGoal:
        """The end of the motion."""
        return JointGoal(np.asarray(self.positions, dtype=float))


@dataclass(frozen=True, eq=False)
class LinearMotion:
    """Pilz's LIN: the link on a straight line, turning at an even rate.

    The line of a joint goal ends where it puts the TCP; with a position goal the link keeps its
    orientation.
    """

    goal: Goal


@dataclass(frozen=True, eq=False)
class CircularMotion:
    """Pilz's CIRC: the link on an arc through a point or about a centre."""

    goal: Goal
    point: ArcPoint


@dataclass(frozen=True, eq=False)
class RelativeMotion:
    """A link moves along a direction as far as possible between two distances.

    Attributes:
        link: A link that is rigidly attached after the group's last joint.
        twist: Unit translation or rotation in world axes, shape (6,): linear, then angular.
        distances: Least and most [m or rad]; equal for a fixed distance.
    """

    link: str
    twist: FloatArray
    distances: tuple[float, float]


@dataclass(frozen=True, eq=False)
class MotionSequence:
    """Pilz's sequence: motions blended into each other, all of them or none."""

    items: Sequence[SequenceItem]


@dataclass(frozen=True, eq=False)
class WaypointMotion:
    """Straight lines through waypoints, as far as they can be followed.

    The plan's result has `fraction`, `largest_joint_step` [rad or m] and `deviation` [m].
    """

    goals: Sequence[PoseGoal | PositionGoal]
    path_options: CartesianPathOptions


PlannedMotion = (
    FreeMotion
    | JointMotion
    | LinearMotion
    | CircularMotion
    | RelativeMotion
    | MotionSequence
    | WaypointMotion
)


@dataclass(frozen=True, eq=False)
class MotionRequest:
    """What a motion planner must plan.

    Attributes:
        group: The name of a planning group.
        start: The start positions of all movable joints, in description order.
        motion: The kind of motion, and where it goes.
        options: The options of the planning call.
    """

    group: str
    start: FloatArray
    motion: PlannedMotion
    options: PlanningOptions

    @property
    def goal(self) -> Goal | AnyGoal | None:
        """Where the motion ends; None for one that has no goal of its own."""
        return getattr(self.motion, "goal", None)


class MotionPlanner(Protocol):
    """Finds motions of a group that can be trusted, or raises PlanningFailed and says why."""

    def plan(self, request: MotionRequest, /) -> MotionPlan:
        """Plan a motion without collision, timed and verified."""
        ...

    def check_goal(self, request: MotionRequest, /) -> CheckedGoal:
        """Explain the goal of a free motion without planning to it: each IK solution.

        Raises:
            PlanningFailed: NO_IK_SOLUTION, GOAL_IN_COLLISION ...
        """
        ...


@dataclass(frozen=True)
class GripperResult:
    """What GripperCommand's result says, and more.

    Attributes:
        position: The position of the gripper's joint at the end.
        effort: The effort of the gripper's joint at the end.
        stalled: Stopped before the goal (contact).
        reached_goal: Whether it is at the commanded position within tolerance.
        contacts: Object names in contact with each finger side at the end, by side name.
        between: Names of objects that two finger sides press from opposite sides at the end.
    """

    position: float
    effort: float
    stalled: bool
    reached_goal: bool
    contacts: Mapping[str, tuple[str, ...]]
    between: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class ControlRequest:
    """What a joint controller must follow until its next call.

    Joints are those of the robot that have a motor, without the gripper's, m in number. Set points
    have a row for each physics step, the first of them for now.

    Attributes:
        joint_names: The joints, in the order of all columns.
        time: The simulated time now [s].
        timestep: The time from one row to the next [s].
        positions: Measured joint positions [rad or m], shape (m,).
        velocities: Measured joint velocities, shape (m,).
        set_positions: Commanded positions, shape (N + 1, m).
        set_velocities: Commanded velocities, shape (N + 1, m).
        set_accelerations: Commanded accelerations, shape (N + 1, m).
        stiffness: Stiffness of a critically damped servo of this arm [N m/rad or N/m], shape (m,).
        damping: Its damping [N m s/rad or N s/m], shape (m,).
        effort_limits: The largest efforts [N m or N], shape (m,); the physics enforces them.
        feed_forward: Efforts that the set points take, of the robot without payload, (N + 1, m).
        inverse_dynamics: The same for other positions, velocities and accelerations, (k, m) each.
    """

    joint_names: tuple[str, ...]
    time: float
    timestep: float
    positions: FloatArray
    velocities: FloatArray
    set_positions: FloatArray
    set_velocities: FloatArray
    set_accelerations: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    effort_limits: FloatArray
    feed_forward: Callable[[], FloatArray]
    inverse_dynamics: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class ControlResult:
    """The efforts of the motors until the next call: a constant part, and a servo around it.

    At every physics step a motor's effort is `efforts + stiffness * (set position - position) +
    damping * (set velocity - velocity)`, within the limits of its joint.

    Attributes:
        efforts: The efforts at each row of the set points, shape (N + 1, m), or at all, (m,).
        stiffness: The stiffness of the servos, shape (m,); None for none.
        damping: Their damping, shape (m,); None for none.
    """

    efforts: FloatArray
    stiffness: FloatArray | None = None
    damping: FloatArray | None = None


class JointController(Plugin, ABC):
    """A joint controller, selected by `robot: {joint_controller: NAME}`.

    It moves the joints of the arm; the gripper keeps a servo of its own. Effort limits, tolerances
    and faults apply to every controller alike. One object of the class lasts for a whole run, so it
    may have a state.

    Attributes:
        period: Simulated time between two calls [s]; None: one call for each stretch of set points,
            of a controller that needs no measurement.
    """

    plugin_kind: ClassVar[str] = "controller"
    period: ClassVar[float | None] = None

    @abstractmethod
    def control(self, request: ControlRequest) -> ControlResult:
        """The efforts of the motors until the next call."""


class Faults(Protocol):
    """What can be broken in the physics while a run goes on.

    Each call returns what stood before, so that a receipt can distinguish a fault from no change.
    """

    def set_friction(self, name: str, sliding: float) -> float:
        """Change the sliding friction of an object's surface, its other frictions alike."""
        ...

    def weaken_gripper(self, share: float) -> float:
        """Leave the gripper a share of its effort, (0, 1]."""
        ...

    def stall_joint(self, joint: str) -> bool:
        """Hold a joint where it is for the rest of the run, whatever its motor does."""
        ...

    def push(self, forces: Mapping[str, FloatArray], duration: float) -> None:
        """Push free objects at their centres of mass [N, world axes] for some time [s], at once."""
        ...

    def disturb_sensors(self, deviation: float, seed: int) -> float:
        """Add white noise to the joint positions that the controllers measure [rad or m]."""
        ...

    def delay_commands(self, latency: float) -> float:
        """Let set points reach the motors later [s]."""
        ...


class Simulator(Protocol):
    """The physics; time only moves inside these calls, and every sample of it is recorded.

    A call that would take the run beyond `LONGEST_RUN`, or its record beyond what the memory is
    sized for, raises StepFailed TIMED_OUT.
    """

    @property
    def time(self) -> float:
        """Simulation time [s]."""
        ...

    @property
    def sample_count(self) -> int:
        """Samples recorded so far."""
        ...

    @property
    def faults(self) -> Faults:
        """What can be broken."""
        ...

    def joint_positions(self) -> FloatArray:
        """Measured, description order."""
        ...

    def commanded_positions(self) -> FloatArray:
        """Last commanded set point, description order, mimic joints consistent."""
        ...

    def object_pose(self, name: str) -> SE3:
        """T_world_object of a simulated object, as it is now."""
        ...

    def track(self, trajectory: JointTrajectory) -> None:
        """Follow a trajectory from where the command stands, then hold its end for the goal time.

        Raises:
            StepFailed: CONTROL_FAILED, when a joint leaves the controller's tolerances; says which
                joint, by how much, what it touched.
        """
        ...

    def command_gripper(
        self, position: float, max_effort: float, *, timeout: float
    ) -> GripperResult:
        """Drive the gripper's joint under an effort limit until it arrives or stalls."""
        ...

    def start_gripper(self, position: float, max_effort: float) -> None:
        """Let the gripper set out while time is moved by other calls; `command_gripper` follows."""
        ...

    def hold(self, duration: float) -> None:
        """Keep the last commands for some simulated time [s]."""
        ...

    def settle(self, max_velocity: float, timeout: float) -> bool:
        """Hold until joints and objects stay slower than a limit [m/s, rad/s]; True.

        Raises:
            StepFailed: TIMED_OUT; says what still moves, and how fast.
        """
        ...

    def add_object(self, name: str, pose: SE3) -> None:
        """Let a prepared object appear at T_world_object."""
        ...

    def remove_object(self, name: str) -> None:
        """Park an object without contacts."""
        ...

    def move_object(self, name: str, pose: SE3) -> None:
        """Set T_world_object, at rest."""
        ...

    def weld(self, name: str, link: str) -> None:
        """Fix an object to a link where it stands (grasp mode `weld`)."""
        ...

    def unweld(self, name: str) -> None:
        """Undo `weld`."""
        ...

    def finish(self) -> Signals:
        """Everything recorded, without clearances."""
        ...


@dataclass(frozen=True)
class ExternalRequest:
    """What a step requires of external programs.

    Attributes:
        step: Id of the step.
        line: Its line in the file.
        timeout: Simulated time after which it has failed [s].
        until: The expectation (`harness.assertions.expectation.Expectation`) whose passing ends
            it; None: it ends with the launched program.
        launch: Name of the command that is started; empty for none.
    """

    step: str
    line: int
    timeout: float
    until: object | None = None
    launch: str = ""


@dataclass(frozen=True)
class ExternalResult(Detail):
    """How external programs' time ended.

    Attributes:
        ended_by: `until`, `timeout`, `exit` (of the launched program) or `stopped` (by the user).
        commands: Number of commands that arrived.
        detail: One sentence for a person; empty where there is nothing to add.
    """

    ended_by: Literal["until", "timeout", "exit", "stopped"]
    commands: int
    detail: str = ""


class ExternalControl(Protocol):
    """Hands the robot over to programs outside, or to a recording of their commands."""

    def hand_over(self, request: ExternalRequest) -> ExternalResult:
        """Let them command the robot until the request's end.

        Raises:
            StepFailed: COMMUNICATION_FAILURE; no program can be reached.
        """
        ...
