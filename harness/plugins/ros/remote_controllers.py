"""Goals of a ROS 2 robot's controllers, sent and watched until they end."""

from __future__ import annotations

import time as wall
from collections.abc import Callable, Mapping, Sequence
from typing import NoReturn

import numpy as np

from harness.core.errors import StepFailed
from harness.core.trajectory import JointTrajectory
from harness.plugins.ros.actions import ActionClient, ClientGoal, Status
from harness.plugins.ros.bag.messages import message, trajectory_message
from harness.plugins.ros.control.goals import Code
from harness.plugins.ros.interfaces import FOLLOW, GRIPPER
from harness.plugins.ros.joint_states import GRID, JointStates
from harness.plugins.ros.names import actions
from harness.plugins.ros.program_parts.controllers import ControllerNames
from harness.plugins.ros.rtps.graph import Graph
from harness.recording.execution_failures import ControlFailure
from harness.robot.description import RobotDescription

PATIENCE = 10.0  # wall time in which servers must be found, and joint states must come [s]
SILENCE = 3.0  # wall time without joint states after which a robot in motion counts as lost [s]
REASON = 1.0  # [s], in which the result of a rejected goal, with its reason, must come


class RemoteControllers:
    """The controllers of a robot's arms and grippers.

    Attributes:
        grippers: A client for each gripper that has a controller, by the gripper's joint.
    """

    def __init__(
        self, graph: Graph, robot: RobotDescription, names: ControllerNames, states: JointStates
    ) -> None:
        """Look for the servers of the controllers' actions."""
        self._graph, self._robot, self._states = graph, robot, states
        self.grippers: dict[str, ActionClient] = {}
        self._candidates: dict[str, list[ActionClient]] = {}
        self._arms: Mapping[str, ActionClient] = {}
        for arm, own in names.by_arm.items():
            if own.arm:
                self._candidates[arm] = [
                    ActionClient(graph, f"/{name}/follow_joint_trajectory", FOLLOW)
                    for name in own.arm
                ]
            gripper = robot.of_arm.get(arm, robot).gripper
            if gripper is not None and own.gripper:
                client = ActionClient(graph, f"/{own.gripper}/gripper_cmd", GRIPPER)
                self.grippers[gripper.joint] = client

    def connect(self) -> None:
        """Find the server of each arm.

        Raises:
            StepFailed: COMMUNICATION_FAILURE; one is not served.
        """
        for clients in self._candidates.values():
            if not self.wait(lambda each=clients: any(c.is_ready for c in each), PATIENCE):
                served = ", ".join(actions(self._graph.uses()[1])) or "no action"
                required = " or ".join(client.name for client in clients)
                unreachable(f"{required} is not served in this domain; served are: {served}")
        self._arms = {
            arm: next(client for client in clients if client.is_ready)
            for arm, clients in self._candidates.items()
        }

    def wait(self, holds: Callable[[], bool], timeout: float) -> bool:
        """Receive until a condition holds, at most some wall time [s]; whether it does."""
        return self._graph.spin_until(holds, timeout)

    def follow(self, trajectory: JointTrajectory) -> None:
        """Send each arm its share of a trajectory, and watch all of them to their ends.

        When one fails, the others are canceled.

        Raises:
            StepFailed: CONTROL_FAILED; a server ends its goal with an error, or a joint strays.
        """
        goals: list[tuple[ActionClient, ClientGoal]] = []
        for arm, client in self._arms.items():
            joints = self._robot.group_joints(arm) if arm else trajectory.joint_names
            own = [name for name in trajectory.joint_names if name in joints]
            if own:
                content = trajectory_message(_share(trajectory, own))
                goals.append((client, client.send(message(f"{FOLLOW}_Goal", trajectory=content))))
        self.watch(goals, 10.0 * trajectory.duration + PATIENCE)

    def watch(self, goals: list[tuple[ActionClient, ClientGoal]], timeout: float) -> None:
        """Watch goals until all are over, at most some wall time [s].

        Whatever ends the watch before, such as Ctrl-C, cancels them: the robot stops.
        """
        try:
            for client, goal in goals:
                if not self.wait(lambda each=goal: each.is_accepted is not None, PATIENCE):
                    unreachable(f"{client.name} does not answer")
            limit = wall.monotonic() + timeout
            while running := [each for each in goals if not self._has_succeeded(*each)]:
                self._graph.spin(wall.monotonic() + GRID)
                self._refuse_silence()
                if wall.monotonic() > limit:
                    unreachable(f"{running[0][0].name} does not end its goal")
        except BaseException:
            for client, goal in goals:
                if not goal.is_over:
                    client.cancel(goal)
            self.wait(lambda: all(goal.is_over for _, goal in goals), REASON)
            raise

    def _has_succeeded(self, client: ActionClient, goal: ClientGoal) -> bool:
        """Whether a goal has ended well; False while it continues.

        Raises:
            StepFailed: CONTROL_FAILED; it has ended otherwise, or a joint strays.
        """
        if client.kind == FOLLOW:
            self._refuse_stray(goal)
            if goal.is_over:
                self._refuse_failure(goal, client)
        elif goal.is_accepted is False:
            raise StepFailed("CONTROL_FAILED", f"{client.name} rejected the goal")
        return goal.is_over

    def _refuse_silence(self) -> None:
        if self._states.silence > SILENCE:
            unreachable(
                f"/joint_states has stopped for {SILENCE:g} s; cancellation was requested,"
                " but the goal may go on: see that the robot stands, and restart its driver"
            )

    def _refuse_stray(self, goal: ClientGoal) -> None:
        """Refuse to go on when the feedback shows a joint beyond its tolerance."""
        tolerance, joints = self._robot.tracking.trajectory, self._robot.joint_by_name
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
                    ControlFailure(name, error, tolerance, unit, self._states.time, ()),
                )
        goal.feedback.clear()

    def _refuse_failure(self, goal: ClientGoal, client: ActionClient) -> None:
        if goal.is_accepted is False:
            self.wait(lambda: goal.result is not None, REASON)
        code = goal.result.error_code if goal.result else Code.SUCCESSFUL
        if goal.is_accepted and goal.status is Status.SUCCEEDED and code == Code.SUCCESSFUL:
            return
        reason = f"ended with {goal.status.name}" if goal.is_accepted else "rejected the trajectory"
        if code or goal.is_accepted:
            reason += f", {Code(code).name if code in list(Code) else code}"
        if goal.result and goal.result.error_string:
            reason += f": {goal.result.error_string}"
        raise StepFailed("CONTROL_FAILED", f"{client.name} {reason}")


def _share(whole: JointTrajectory, names: Sequence[str]) -> JointTrajectory:
    """What a trajectory holds for some of its joints."""
    places = [whole.joint_names.index(name) for name in names]
    parts = (whole.positions, whole.velocities, whole.accelerations)
    own = (np.ascontiguousarray(part[:, places]) for part in parts)  # rows that are sent as bytes
    return JointTrajectory(tuple(names), whole.times, *own)


def unreachable(why: str) -> NoReturn:
    """Raise a StepFailed: COMMUNICATION_FAILURE."""
    raise StepFailed("COMMUNICATION_FAILURE", why)
