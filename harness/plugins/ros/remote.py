"""A scenario on a ROS 2 robot: planned here, executed by its controllers, judged by its topics."""

from __future__ import annotations

import time as wall
from collections.abc import Callable
from typing import NoReturn

import numpy as np

from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.plugins.ros.actions import ActionClient, ClientGoal, Status
from harness.plugins.ros.bag.messages import message, trajectory_message
from harness.plugins.ros.control.goals import Code
from harness.plugins.ros.interfaces import COMMAND, FOLLOW, GRIPPER
from harness.plugins.ros.joint_states import GRID, JointStates
from harness.plugins.ros.names import actions
from harness.plugins.ros.one_arm import refuse_several_arms
from harness.plugins.ros.prefix import Prefix
from harness.plugins.ros.rtps.graph import Graph
from harness.ports.simulation import ExpectedGrasp, Faults, GripperResult
from harness.recording.execution_failures import ControlFailure
from harness.recording.signals import UNPUBLISHED, Signals
from harness.reporting.result import CaseResult
from harness.session.prepare import Prepared, prepare
from harness.session.progress import Notify
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from harness.session.start import Start
from harness.session.timing import Clock

MEASURED = ("position", "effort", "stalled", "reached_goal")  # what GripperCommand's result says
PATIENCE = 10.0  # wall time in which servers must be found, and joint states must come [s]
SILENCE = 3.0  # wall time without joint states after which a robot in motion counts as lost [s]
UNKNOWN = np.full(7, np.nan)  # the pose of an object that is not measured
REASON = 1.0  # [s], in which the result of a rejected goal, with its reason, must come
Confirm = Callable[[JointTrajectory], bool]  # before it is sent: whether the arm may move
START_TOLERANCE = 0.01  # [rad or m], of the arm from a trajectory's begin, as MoveIt allows


def run_on_robot(
    request: RunRequest, connect: Callable[[Prepared], RemoteArm], notify: Notify
) -> CaseResult:
    """Run a case on the robot of a ROS 2 domain.

    What its topics do not show, such as contacts and the poses of objects, is not observable.

    Args:
        connect: Finds the robot of the scenario.

    Raises:
        StepFailed: COMMUNICATION_FAILURE; the robot cannot be reached.
    """

    def start(request: RunRequest, _: Clock) -> Start[RemoteArm]:
        prepared = prepare(request.file, request.overrides, request.seed, request.text)
        refuse_several_arms(prepared)
        return Start(prepared, connect(prepared))

    return run_case(request, notify, start=start)


def _refuses(why: str) -> Callable[..., NoReturn]:
    def refuse(*_: object) -> NoReturn:
        raise StepFailed("ABORT", why)

    return refuse


class RemoteArm:
    """Sends trajectories to the servers of a robot's controllers, one after the other."""

    overlaps_at_start = ()
    unrecorded = ("joint_commands", "joint_command_velocities", *UNPUBLISHED)
    timestep = GRID

    def __init__(
        self, graph: Graph, velocity_scaling: float, confirm: Confirm, prepared: Prepared
    ) -> None:
        """Find the robot's controllers and its joints.

        Args:
            velocity_scaling: Share of the planned speed, (0, 1].

        Raises:
            StepFailed: COMMUNICATION_FAILURE; a server or a joint is missing.
        """
        self._graph, self._share, self._confirm = graph, velocity_scaling, confirm
        self._kinematics, self._program = prepared.ports.kinematics, prepared.program
        self.description = self._program.description
        self._frames = tuple(dict.fromkeys((self.description.tcp_link, *prepared.observed_links)))
        names = self._program.controllers
        own = names.by_arm[""]
        prefix = Prefix(names.prefix, self.description)
        graph.outward, graph.inward = prefix.outward, prefix.inward
        self._states = JointStates(graph, self.description)
        arms = [ActionClient(graph, f"/{arm}/follow_joint_trajectory", FOLLOW) for arm in own.arm]
        finger = f"/{own.gripper}/gripper_cmd"
        self._gripper = ActionClient(graph, finger, GRIPPER) if own.gripper else None
        if not self._wait(lambda: any(arm.is_ready for arm in arms), PATIENCE):
            served = ", ".join(actions(graph.uses()[1])) or "no action"
            required = " or ".join(arm.name for arm in arms)
            _unreachable(f"{required} is not served in this domain; served are: {served}")
        self._arm = next(arm for arm in arms if arm.is_ready)
        if not self._wait(lambda: self._states.time >= 0, PATIENCE):
            joints = ", ".join(names.prefix + each for each in self.description.joint_names)
            _unreachable(f"/joint_states brings no message with all joints: {joints}")

    @property
    def time(self) -> float:
        """Time of the robot since the first joint state [s]."""
        return (self.sample_count - 1) * GRID

    @property
    def sample_count(self) -> int:
        return self._states.sample_count

    def joint_positions(self) -> FloatArray:
        """Measured, description order."""
        self._graph.spin(wall.monotonic())
        return self._states.positions

    def commanded_positions(self) -> FloatArray:
        """Where the robot stands: the next motion begins there."""
        return self.joint_positions()

    def object_pose(self, name: str) -> SE3:
        """T_world_object as the scenario has it; it is not measured."""
        return next(obj.pose for obj in self._program.all_objects() if obj.name == name)

    def track(self, trajectory: JointTrajectory) -> None:
        """Send a trajectory and watch the arm on its way.

        Raises:
            StepFailed: CONTROL_FAILED, when the server ends the goal with an error, or a joint
                strays from its tolerance, upon which the goal is canceled; PREEMPTED, when the user
                does not confirm.
        """
        if not self._confirm(trajectory):
            raise StepFailed("PREEMPTED", "the motion was not confirmed, so nothing moved")
        self._refuse_other_start(trajectory)
        client, slowed = self._arm, _slowed(trajectory, self._share)
        goal = client.send(message(f"{FOLLOW}_Goal", trajectory=trajectory_message(slowed)))
        self._follow(client, goal, 10.0 * slowed.duration + PATIENCE)
        self._refuse_failure(goal, client)

    def command_gripper(
        self,
        position: float,
        max_effort: float,
        *,
        timeout: float,
        expected: ExpectedGrasp | None = None,
        joint: str = "",
    ) -> GripperResult:
        """Send a GripperCommand; what it holds is not measured, a stall is taken for an object."""
        del expected, joint  # robots of several arms are refused
        client, gripper = self._gripper, self.description.gripper
        if client is None or gripper is None or not self._wait(lambda: client.is_ready, PATIENCE):
            _unreachable("no server of GripperCommand answers in this domain")
        command = message(COMMAND, position=position, max_effort=max_effort)
        goal = client.send(message(f"{GRIPPER}_Goal", command=command))
        self._follow(client, goal, 3.0 * timeout + PATIENCE)
        if goal.is_accepted is False:
            raise StepFailed("CONTROL_FAILED", f"{client.name} rejected the goal")
        loose = [o for o in self._program.all_objects() if o.in_simulation and not o.is_static]
        held = tuple(each.name for each in loose) if goal.result.stalled else ()
        measured = {key: getattr(goal.result, key) for key in MEASURED}
        return GripperResult(**measured, contacts=dict.fromkeys(gripper.sides, held), between=held)

    def hold(self, duration: float) -> None:
        """Let the robot's time pass [s]."""
        end = self._states.time + duration
        if not self._wait(lambda: self._states.time >= end, 10.0 * duration + PATIENCE):
            _unreachable("/joint_states has stopped")

    def settle(self, max_velocity: float, timeout: float) -> bool:
        """Wait until every joint is slower than a limit.

        Raises:
            StepFailed: TIMED_OUT; one still moves.
        """
        states, end = self._states, self._states.time + timeout
        limit = 10.0 * timeout + PATIENCE
        self._wait(lambda: states.speed < max_velocity or states.time > end, limit)
        if states.speed >= max_velocity:
            raise StepFailed("TIMED_OUT", f"the robot still moves after {timeout:g} s")
        return True

    @property
    def faults(self) -> Faults:
        """Nothing can be broken in a real robot."""
        raise StepFailed("ABORT", "faults are injected into simulated robots alone")

    start_gripper = _refuses("arm and gripper of a ROS 2 robot do not move in parallel here")
    add_object = _refuses("an object would have to appear in the real cell; add it `in: planning`")
    remove_object = _refuses("an object cannot be taken out of the real cell by a program")
    move_object = _refuses("an object cannot be moved in the real cell by a program")
    drive_surface = _refuses("a belt of the real cell is not driven by a scenario")
    force_on_robot = _refuses("the forces on a ROS 2 robot are not known here")
    use_controller = _refuses("a robot of ROS 2 keeps the joint controller that it has")
    wrench = _refuses("the sensors of a ROS 2 robot are not read here")
    tare = _refuses("the sensors of a ROS 2 robot are not set to zero here")
    weld = _refuses("an object cannot be welded to the gripper of a real robot")

    def surface_motion(self, name: str) -> SurfaceMotion:
        """A surface as the scenario has it; it is not measured."""
        belts = (each for each in self._program.all_objects() if each.name == name)
        return next(belt.surface_motion for belt in belts if belt.surface_motion is not None)

    def unweld(self, name: str, believed: SE3 | None = None) -> None:
        del name, believed

    def finish(self, first: int = 0) -> Signals:
        """What `/joint_states` brought, on an even grid; poses follow from the joints."""
        whole, measured = self._states.record()
        times, (positions, velocities, efforts) = whole[first:], (each[first:] for each in measured)
        nothing = np.full_like(positions, np.nan)
        poses = self._kinematics.link_poses(positions, self._frames)
        objects = [each for each in self._program.all_objects() if each.in_simulation]
        known = {o.name: o.pose.as_vector() if o.is_static else UNKNOWN for o in objects}
        return Signals(
            times=times,
            joint_positions=positions,
            joint_velocities=velocities,
            joint_efforts=efforts,
            joint_commands=nothing,
            joint_command_velocities=nothing,
            tcp_pose=poses[:, 0],
            frames={link: poses[:, place] for place, link in enumerate(self._frames)},
            object_poses={name: np.tile(pose, (len(times), 1)) for name, pose in known.items()},
        )

    def _wait(self, holds: Callable[[], bool], timeout: float) -> bool:
        return self._graph.spin_until(holds, timeout)

    def _follow(self, client: ActionClient, goal: ClientGoal, timeout: float) -> None:
        """Watch a goal until it is over, at most some wall time [s].

        Whatever ends the watch before, such as Ctrl-C, cancels the goal: the robot stops.
        """
        try:
            if not self._wait(lambda: goal.is_accepted is not None, PATIENCE):
                _unreachable(f"{client.name} does not answer")
            limit = wall.monotonic() + timeout
            while not goal.is_over:
                self._graph.spin(wall.monotonic() + GRID)
                if client is self._arm:
                    self._refuse_stray(goal)
                if self._states.silence > SILENCE:
                    _unreachable(
                        f"/joint_states has stopped for {SILENCE:g} s; cancellation was requested,"
                        " but the goal may go on: see that the robot stands, and restart its driver"
                    )
                if wall.monotonic() > limit:
                    _unreachable(f"{client.name} does not end its goal")
        except BaseException:
            client.cancel(goal)
            self._wait(lambda: goal.is_over, REASON)
            raise

    def _refuse_other_start(self, trajectory: JointTrajectory) -> None:
        now, index = self.joint_positions(), self.description.joint_index
        begins = zip(trajectory.joint_names, trajectory.positions[0], strict=True)
        off, name = max((abs(now[index[name]] - begin), name) for name, begin in begins)
        if off > START_TOLERANCE:
            text = f"'{name}' stands {off:.3g} from where the trajectory begins"
            raise StepFailed("START_STATE_INVALID", f"{text} (tolerance {START_TOLERANCE:g})")

    def _refuse_stray(self, goal: ClientGoal) -> None:
        """Refuse to go on when the feedback shows a joint beyond its tolerance."""
        tolerance, joints = self.description.tracking.trajectory, self.description.joint_by_name
        for feedback in goal.feedback:
            errors = map(abs, feedback.error.positions.tolist())
            named = zip(errors, map(str, feedback.joint_names), strict=False)
            known = [(error, name) for error, name in named if name in joints]
            error, name = max(known, default=(0.0, ""))
            if error > tolerance:
                unit = joints[name].position_unit
                raise StepFailed(
                    "CONTROL_FAILED",
                    f"{name} is {error:.3g} {unit} off its trajectory (tolerance"
                    f" {tolerance:g} {unit}); the goal was canceled",
                    ControlFailure(name, error, tolerance, unit, self.time, ()),
                )
        goal.feedback.clear()

    def _refuse_failure(self, goal: ClientGoal, client: ActionClient) -> None:
        if goal.is_accepted is False:
            self._wait(lambda: goal.result is not None, REASON)
        code = goal.result.error_code if goal.result else Code.SUCCESSFUL
        if goal.is_accepted and goal.status is Status.SUCCEEDED and code == Code.SUCCESSFUL:
            return
        reason = f"ended with {goal.status.name}" if goal.is_accepted else "rejected the trajectory"
        if code or goal.is_accepted:
            reason += f", {Code(code).name if code in list(Code) else code}"
        if goal.result and goal.result.error_string:
            reason += f": {goal.result.error_string}"
        raise StepFailed("CONTROL_FAILED", f"{client.name} {reason}")


def _slowed(plan: JointTrajectory, share: float) -> JointTrajectory:
    """A trajectory at a share of its speed, which ends at rest."""
    velocities, accelerations = plan.velocities * share, plan.accelerations * share**2
    velocities[-1] = 0.0
    times = plan.times / share
    return JointTrajectory(plan.joint_names, times, plan.positions, velocities, accelerations)


def _unreachable(why: str) -> NoReturn:
    raise StepFailed("COMMUNICATION_FAILURE", why)
