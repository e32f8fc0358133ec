"""The simulator port on a ROS 2 robot: planned here, executed there, recorded from its topics."""

from __future__ import annotations

import time as wall
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np

from harness.cell.program import Program
from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.ports import GripperResult, Kinematics
from harness.recording.execution_failures import ControlFailure
from harness.recording.run import Signals
from harness.ros.action_client import ActionClient, ClientGoal
from harness.ros.action_server import Status
from harness.ros.contents import POINT
from harness.ros.control.cell import ControllerNames
from harness.ros.control.goals import Code
from harness.ros.graph import Graph
from harness.ros.interfaces import FOLLOW, GRIPPER, TRAJECTORY, message, seconds, span

GRID = 0.01
"""Time between the samples of the record [s]; joint states are interpolated onto it."""

UNRECORDED = (
    "joint_commands",
    "joint_command_velocities",
    "contact_forces",
    "presses",
    "frictions",
    "support_forces",
    "link_overlaps",
    "planned_clearances",
)
"""Signals that a robot's topics do not carry."""

PATIENCE = 10.0
"""Wall time in which servers must be found, and joint states must come [s]."""

REASON = 1.0
"""Wall time in which the result of a rejected goal, which may give the reason, must come [s]."""

START_TOLERANCE = 0.01
"""Largest distance of the arm from where a trajectory begins [rad or m], as MoveIt allows."""


@dataclass(frozen=True)
class RemoteOptions:
    """How a robot is reached, and how fast it may move.

    Attributes:
        velocity_scaling: Share of the planned speed, (0, 1].
        confirm: Called with each trajectory before it is sent; whether the arm may move.
    """

    velocity_scaling: float = 1.0
    confirm: Callable[[JointTrajectory], bool] = lambda _: True


class RemoteArm:
    """Sends trajectories to the servers of a robot's controllers, one after the other.

    Attributes:
        overlaps_at_start: Nothing is known of overlaps.
    """

    overlaps_at_start = ()
    unrecorded = UNRECORDED
    timestep = GRID

    def __init__(
        self,
        graph: Graph,
        program: Program,
        kinematics: Kinematics,
        names: ControllerNames,
        options: RemoteOptions,
    ) -> None:
        """Find the robot's controllers and its joints.

        Raises:
            StepFailed: COMMUNICATION_FAILURE; a server or a joint is missing.
        """
        self._graph, self._kinematics, self._options = graph, kinematics, options
        self.description, self._program = program.description, program
        self._times: list[float] = []
        self._rows: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        self._offset: float | None = None
        self._command: FloatArray | None = None
        self._frames = (self.description.tcp_link,)
        graph.subscribe("/joint_states", "sensor_msgs/msg/JointState", self._take_state)
        self._arms = {
            name: ActionClient(graph, f"/{name}/follow_joint_trajectory", FOLLOW)
            for name in names.arm
        }
        self._gripper = None
        if names.gripper:
            self._gripper = ActionClient(graph, f"/{names.gripper}/gripper_cmd", GRIPPER)
        found = self._wait(lambda: any(a.is_ready for a in self._arms.values()), PATIENCE)
        if not found:
            required = " or ".join(f"/{name}/follow_joint_trajectory" for name in self._arms)
            served = ", ".join(graph.names()[1].actions) or "no action"
            _unreachable(f"{required} is not served in this domain; served are: {served}")
        self._arm = next(arm for arm in self._arms.values() if arm.is_ready)
        if not self._wait(lambda: bool(self._times), PATIENCE):
            _unreachable(
                "/joint_states brings no message with all joints:"
                f" {', '.join(self.description.joint_names)}"
            )

    # -- where things are ---------------------------------------------------------------------

    @property
    def time(self) -> float:
        """Time of the robot since the first joint state [s]."""
        return (self.sample_count - 1) * GRID

    @property
    def sample_count(self) -> int:
        """Samples on the grid so far."""
        return int(self._times[-1] / GRID + 1e-9) + 1

    @property
    def faults(self) -> NoReturn:
        """Nothing of a real robot is broken on purpose."""
        raise StepFailed("ABORT", "faults are injected into simulated robots alone")

    def joint_positions(self) -> FloatArray:
        """Measured, description order."""
        self._graph.spin(wall.monotonic())
        return self._rows[-1][0].copy()

    def commanded_positions(self) -> FloatArray:
        """The end of the last trajectory, or where the robot stood."""
        return self.joint_positions() if self._command is None else self._command.copy()

    def object_pose(self, name: str) -> SE3:
        """T_world_object as the scenario has it; it is not measured."""
        return next(obj.pose for obj in self._program.all_objects() if obj.name == name)

    # -- motion -------------------------------------------------------------------------------

    def track(self, trajectory: JointTrajectory) -> None:
        """Send a trajectory and watch the arm on its way.

        Raises:
            StepFailed: CONTROL_FAILED, when the server ends the goal with an error, or a joint
                strays from its tolerance, upon which the goal is canceled; PREEMPTED, when the user
                does not confirm.
        """
        self._refuse_other_start(trajectory)
        if not self._options.confirm(trajectory):
            raise StepFailed("PREEMPTED", "the motion was not confirmed, so nothing moved")
        scaled = slowed(trajectory, self._options.velocity_scaling)
        client = self._arm
        goal = client.send(self._goal(scaled))
        if not self._wait(lambda: goal.is_accepted is not None, PATIENCE):
            _unreachable(f"{client.name} does not answer")
        limit = wall.monotonic() + 10.0 * scaled.duration + PATIENCE
        while not goal.is_over:
            self._graph.spin(wall.monotonic() + GRID)
            self._refuse_stray(goal)
            if wall.monotonic() > limit:
                client.cancel(goal)
                _unreachable(f"{client.name} does not end its goal")
        self._refuse_failure(goal, client)
        end = self.commanded_positions()
        for name, position in zip(scaled.joint_names, scaled.positions[-1], strict=True):
            end[self.description.joint_index[name]] = position
        self._command = self.description.with_mimics(end)

    def command_gripper(
        self, position: float, max_effort: float, *, timeout: float
    ) -> GripperResult:
        """Send a GripperCommand; what it holds is not measured, a stall is taken for an object."""
        client, gripper = self._gripper, self.description.gripper
        if client is None or gripper is None or not self._wait(lambda: client.is_ready, PATIENCE):
            _unreachable("no server of GripperCommand answers in this domain")
        command = message(
            "control_msgs/msg/GripperCommand", position=position, max_effort=max_effort
        )
        goal = client.send(message(f"{GRIPPER}_Goal", command=command))
        if not self._wait(lambda: goal.is_over, 3.0 * timeout + PATIENCE):
            client.cancel(goal)
            raise StepFailed("TIMED_OUT", f"{client.name} does not end its goal")
        if goal.is_accepted is False:
            raise StepFailed("CONTROL_FAILED", f"{client.name} rejected the goal")
        held = self._graspable() if goal.result.stalled else ()
        return GripperResult(
            position=goal.result.position,
            effort=goal.result.effort,
            stalled=goal.result.stalled,
            reached_goal=goal.result.reached_goal,
            contacts=dict.fromkeys(gripper.sides, held),
            between=held,
        )

    def start_gripper(self, position: float, max_effort: float) -> None:
        """Refuse: motions of arm and gripper are sent one after the other."""
        del position, max_effort
        raise StepFailed("ABORT", "arm and gripper of a ROS 2 robot do not move in parallel here")

    def hold(self, duration: float) -> None:
        """Let the robot's time pass [s]."""
        end = self._times[-1] + duration
        if not self._wait(lambda: self._times[-1] >= end, 10.0 * duration + PATIENCE):
            _unreachable("/joint_states has stopped")

    def settle(self, max_velocity: float, timeout: float) -> bool:
        """Wait until every joint is slower than a limit.

        Raises:
            StepFailed: TIMED_OUT; one still moves.
        """
        end = self._times[-1] + timeout
        self._wait(
            lambda: bool(np.abs(self._rows[-1][1]).max() < max_velocity) or self._times[-1] > end,
            10.0 * timeout + PATIENCE,
        )
        if np.abs(self._rows[-1][1]).max() >= max_velocity:
            raise StepFailed("TIMED_OUT", f"the robot still moves after {timeout:g} s")
        return True

    # -- objects: a program does not change those of a real cell --------------------------------

    def add_object(self, name: str, pose: SE3) -> None:
        del pose
        raise StepFailed("ABORT", f"'{name}' would have to appear in the real cell: `in: planning`")

    def remove_object(self, name: str) -> None:
        raise StepFailed("ABORT", f"'{name}' cannot be taken out of the real cell by a program")

    def move_object(self, name: str, pose: SE3) -> None:
        del pose
        raise StepFailed("ABORT", f"'{name}' cannot be moved in the real cell by a program")

    def weld(self, name: str, link: str) -> None:
        del link
        raise StepFailed("ABORT", f"'{name}' cannot be welded to the gripper of a real robot")

    def unweld(self, name: str) -> None:
        del name

    # -- the record ---------------------------------------------------------------------------

    def finish(self) -> Signals:
        """What `/joint_states` brought, on an even grid; poses follow from the joints."""
        count = self.sample_count
        times = np.arange(count, dtype=np.float64) * GRID
        positions, velocities, efforts = (
            np.column_stack([np.interp(times, self._times, column) for column in part.T])
            for part in (np.array([row[index] for row in self._rows]) for index in range(3))
        )
        nothing = np.full_like(positions, np.nan)
        missing = np.full((count, 7), np.nan)
        objects: dict[str, FloatArray] = {}
        for obj in self._program.all_objects():
            if obj.in_simulation:
                known = np.tile(obj.pose.as_vector(), (count, 1))
                objects[obj.name] = known if obj.is_static else missing
        links = dict.fromkeys((self.description.tcp_link, *self._frames))
        poses = {
            link: np.array([self._kinematics.link_pose(q, link).as_vector() for q in positions])
            for link in links
        }
        return Signals(
            times=times,
            joint_positions=positions,
            joint_velocities=velocities,
            joint_efforts=efforts,
            joint_commands=nothing,
            joint_command_velocities=nothing,
            tcp_pose=poses[self.description.tcp_link],
            frames=poses,
            object_poses=objects,
        )

    def observe_frames(self, links: tuple[str, ...]) -> None:
        """Name the links whose poses are recorded in addition to the TCP's."""
        self._frames = links

    def _take_state(self, state: Any) -> None:
        """Keep a message that has every joint that is no mimic joint."""
        place = {str(name): index for index, name in enumerate(state.name)}
        joints = self.description.movable_joints
        if any(joint.mimic is None and joint.name not in place for joint in joints):
            return
        stamp = seconds(state.header.stamp) or wall.monotonic()
        self._offset = stamp if self._offset is None else self._offset
        moment = stamp - self._offset
        if self._times and moment <= self._times[-1]:
            return

        def column(values: FloatArray) -> FloatArray:
            if len(values) < len(place):
                return np.zeros(len(joints))
            return np.array([values[place[j.name]] if j.name in place else 0.0 for j in joints])

        positions = self.description.with_mimics(column(state.position))
        self._times.append(moment)
        self._rows.append((positions, column(state.velocity), column(state.effort)))

    # -- inside -------------------------------------------------------------------------------

    def _wait(self, holds: Callable[[], bool], timeout: float) -> bool:
        """Spin until something holds, or the wall time is over [s]."""
        deadline = wall.monotonic() + timeout
        while not holds():
            if wall.monotonic() > deadline:
                return False
            self._graph.spin(wall.monotonic() + 0.005)
        return True

    def _goal(self, trajectory: JointTrajectory) -> Any:
        rows = zip(
            trajectory.times,
            trajectory.positions,
            trajectory.velocities,
            trajectory.accelerations,
            strict=True,
        )
        points = [
            message(POINT, positions=p, velocities=v, accelerations=a, time_from_start=span(t))
            for t, p, v, a in rows
        ]
        points[-1].velocities = np.zeros_like(points[-1].velocities)
        names = list(trajectory.joint_names)
        content = message(TRAJECTORY, joint_names=names, points=points)
        return message(f"{FOLLOW}_Goal", trajectory=content)

    def _refuse_other_start(self, trajectory: JointTrajectory) -> None:
        now = self.joint_positions()
        places = [self.description.joint_index[name] for name in trajectory.joint_names]
        errors = np.abs(now[places] - trajectory.positions[0])
        worst = int(np.argmax(errors))
        if errors[worst] > START_TOLERANCE:
            raise StepFailed(
                "START_STATE_INVALID",
                f"'{trajectory.joint_names[worst]}' stands {errors[worst]:.3g} from where the"
                f" trajectory begins (tolerance {START_TOLERANCE:g})",
            )

    def _refuse_stray(self, goal: ClientGoal) -> None:
        """Cancel a goal whose feedback shows a joint beyond its tolerance."""
        tolerance = self.description.tracking.trajectory
        for feedback in goal.feedback:
            errors = np.abs(feedback.error.positions)
            if len(errors) and errors.max() > tolerance:
                worst = int(np.argmax(errors))
                self._arm.cancel(goal)
                self._wait(lambda: goal.is_over, PATIENCE)
                name = str(feedback.joint_names[worst])
                self._fail(name, float(errors[worst]), tolerance, "the goal was canceled")
        goal.feedback.clear()

    def _refuse_failure(self, goal: ClientGoal, client: ActionClient) -> None:
        if goal.is_accepted is False:
            self._wait(lambda: goal.result is not None, REASON)
        code = goal.result.error_code if goal.result else Code.SUCCESSFUL
        if goal.is_accepted and goal.status is Status.SUCCEEDED and code == Code.SUCCESSFUL:
            return
        how = f"ended with {goal.status.name}" if goal.is_accepted else "rejected the trajectory"
        name = Code(code).name if code in list(Code) else str(code)
        reason = f", {name}" if code or goal.is_accepted else ""
        if goal.result and goal.result.error_string:
            reason += f": {goal.result.error_string}"
        raise StepFailed("CONTROL_FAILED", f"{client.name} {how}{reason}")

    def _fail(self, joint: str, error: float, tolerance: float, said: str) -> NoReturn:
        unit = "m" if self.description.joint_by_name[joint].kind == "prismatic" else "rad"
        raise StepFailed(
            "CONTROL_FAILED",
            f"{joint} is {error:.3g} {unit} off its trajectory (tolerance {tolerance:g} {unit});"
            f" {said}",
            ControlFailure(joint, error, tolerance, unit, self.time, ()),
        )

    def _graspable(self) -> tuple[str, ...]:
        return tuple(
            obj.name
            for obj in self._program.all_objects()
            if obj.in_simulation and not obj.is_static
        )


def slowed(trajectory: JointTrajectory, share: float) -> JointTrajectory:
    """The same path at a share of the speed."""
    return JointTrajectory(
        trajectory.joint_names,
        trajectory.times / share,
        trajectory.positions,
        trajectory.velocities * share,
        trajectory.accelerations * share**2,
    )


def _unreachable(why: str) -> NoReturn:
    raise StepFailed("COMMUNICATION_FAILURE", why)
