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
from harness.core.wrench_sensor import Payload
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.interfaces import COMMAND, GRIPPER
from harness.plugins.ros.joint_states import GRID, JointStates
from harness.plugins.ros.prefix import Prefix
from harness.plugins.ros.refused_steps import refuse_steps
from harness.plugins.ros.remote_controllers import (
    PATIENCE,
    SILENCE,
    RemoteControllers,
    unreachable,
)
from harness.plugins.ros.rtps.graph import Graph
from harness.plugins.ros.wrench_readings import WrenchReadings
from harness.ports.simulation import ExpectedGrasp, GripperResult
from harness.recording.signals import UNPUBLISHED, Signals
from harness.reporting.result import CaseResult
from harness.session.prepare import Prepared, prepare
from harness.session.progress import Notify
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from harness.session.start import Start
from harness.session.timing import Clock

MEASURED = ("position", "effort", "stalled", "reached_goal")  # what GripperCommand's result says
UNKNOWN = np.full(7, np.nan)  # the pose of an object that is not measured
Confirm = Callable[[JointTrajectory], bool]  # before it is sent: whether the arm may move
START_TOLERANCE = 0.01  # [rad or m], of the arm from a trajectory's begin, as MoveIt allows
AT_REST = 1e-9  # [rad/s or m/s]; a trajectory that ends faster is continued by another at once


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
        refuse_steps(prepared)
        return Start(prepared, connect(prepared))

    return run_case(request, notify, start=start)


def _refuses(why: str) -> Callable[..., NoReturn]:
    def refuse(*_: object) -> NoReturn:
        raise StepFailed("ABORT", why)

    return refuse


class RemoteArm:
    """Sends trajectories to the servers of a robot's controllers, each arm its share."""

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
            StepFailed: COMMUNICATION_FAILURE; a server, a joint or a sensor is missing.
        """
        self._graph, self._share, self._confirm = graph, velocity_scaling, confirm
        self._kinematics, self._program = prepared.ports.kinematics, prepared.program
        self.description = self._program.description
        self._frames = tuple(dict.fromkeys((self.description.tcp_link, *prepared.observed_links)))
        names = self._program.parts["controllers"]
        prefix = Prefix(names.prefix, self.description)
        graph.outward, graph.inward = prefix.outward, prefix.inward
        self._states = JointStates(graph, self.description)
        self._sensors = self.description.wrench_sensors
        self._readings = WrenchReadings(graph, self._sensors)
        self._tares: list[tuple[int, str, FloatArray, Payload | None]] = []
        self._controllers = RemoteControllers(graph, self.description, names, self._states)
        self._controllers.connect()
        if not self._wait(lambda: self._states.time >= 0, PATIENCE):
            missing = ", ".join(names.prefix + each for each in self._states.missing)
            unreachable(f"/joint_states brings no message with the joints {missing}")
        if not self._wait(lambda: self._readings.is_complete, PATIENCE):
            unreachable(self._readings.lack(SILENCE))

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
            StepFailed: CONTROL_FAILED, when a server ends its goal with an error, or a joint
                strays from its tolerance, upon which the goals are canceled; PREEMPTED, when the
                user does not confirm; ABORT, of a trajectory that another continues at once.
        """
        if np.abs(trajectory.velocities[-1]).max() > AT_REST:
            why = "motions of a ROS 2 robot end at rest: it is not stopped at a force, or on a belt"
            raise StepFailed("ABORT", why)
        if not self._confirm(trajectory):
            raise StepFailed("PREEMPTED", "the motion was not confirmed, so nothing moved")
        self._refuse_other_start(trajectory)
        self._controllers.follow(_slowed(trajectory, self._share))

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
        del expected
        grippers = {each.joint: each for each in self.description.grippers}
        gripper = grippers[joint] if joint else self.description.gripper
        client = self._controllers.grippers.get(gripper.joint) if gripper else None
        if client is None or gripper is None or not self._wait(lambda: client.is_ready, PATIENCE):
            unreachable("no server of GripperCommand answers in this domain")
        command = message(COMMAND, position=position, max_effort=max_effort)
        goal = client.send(message(f"{GRIPPER}_Goal", command=command))
        self._controllers.watch([(client, goal)], 3.0 * timeout + PATIENCE)
        loose = [o for o in self._program.all_objects() if o.in_simulation and not o.is_static]
        held = tuple(each.name for each in loose) if goal.result.stalled else ()
        measured = {key: getattr(goal.result, key) for key in MEASURED}
        return GripperResult(**measured, contacts=dict.fromkeys(gripper.sides, held), between=held)

    def hold(self, duration: float) -> None:
        """Let the robot's time pass [s]."""
        end = self._states.time + duration
        if not self._wait(lambda: self._states.time >= end, 10.0 * duration + PATIENCE):
            unreachable("/joint_states has stopped")

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

    start_gripper = _refuses("arm and gripper of a ROS 2 robot do not move in parallel here")
    add_object = _refuses("an object would have to appear in the real cell; add it `in: planning`")
    remove_object = _refuses("an object cannot be taken out of the real cell by a program")
    move_object = _refuses("an object cannot be moved in the real cell by a program")
    drive_surface = _refuses("a belt of the real cell is not driven by a scenario")
    force_on_robot = _refuses("the forces on a ROS 2 robot are not known here")
    use_controller = _refuses("a robot of ROS 2 keeps the joint controller that it has")
    weld = _refuses("an object cannot be welded to the gripper of a real robot")

    def wrench(self, sensor: str, span: float) -> FloatArray:
        """What a sensor reads, mean over the last `span` seconds of its messages, shape (6,).

        Raises:
            StepFailed: COMMUNICATION_FAILURE; it has stopped.
        """
        self._graph.spin(wall.monotonic())
        if lack := self._readings.lack(SILENCE):
            unreachable(lack)
        read, now = self._readings.mean(sensor, span), self._states.positions[None]
        return self._tared(sensor, read[None], now, self.sample_count)[0]

    def tare(self, sensor: str, duration: float, payload: Payload | None = None) -> FloatArray:
        """Hold, and take the mean of a sensor's readings meanwhile for zero; returns it, (6,).

        The driver's own zero stays as it is.
        """
        first = self.sample_count
        self.hold(duration)
        zero = self._readings.mean(sensor, duration)
        if payload is not None:
            zero = zero - self._weight(sensor, payload, self._states.positions[None])[0]
        self._tares.append((first, sensor, zero, payload))
        return zero

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
        nothing, origin = np.full_like(positions, np.nan), self._states.origin
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
            wrenches={
                name: self._tared(name, self._readings.at(name, times + origin), positions, first)
                for name in self._sensors
            },
        )

    def _tared(
        self, sensor: str, readings: FloatArray, positions: FloatArray, first: int
    ) -> FloatArray:
        """Readings from a sample on, less the tare that holds at each, shape (N, 6)."""
        tared = readings.copy()
        for sample, name, zero, payload in self._tares:
            if name == sensor:
                rest = slice(max(0, sample - first), None)
                tared[rest] = readings[rest] - zero
                if payload is not None:
                    tared[rest] -= self._weight(sensor, payload, positions[rest])
        return tared

    def _weight(self, sensor: str, payload: Payload, positions: FloatArray) -> FloatArray:
        """A payload's weight in a sensor's readings at joint positions (N, n), shape (N, 6)."""
        known = self._sensors[sensor]
        poses = self._kinematics.link_poses(positions, [known.link])[:, 0]
        return payload.weight(known, poses, np.array(self._program.world.gravity))

    def _wait(self, holds: Callable[[], bool], timeout: float) -> bool:
        return self._controllers.wait(holds, timeout)

    def _refuse_other_start(self, trajectory: JointTrajectory) -> None:
        now, index = self.joint_positions(), self.description.joint_index
        begins = zip(trajectory.joint_names, trajectory.positions[0], strict=True)
        off, name = max((abs(now[index[name]] - begin), name) for name, begin in begins)
        if off > START_TOLERANCE:
            text = f"'{name}' stands {off:.3g} from where the trajectory begins"
            raise StepFailed("START_STATE_INVALID", f"{text} (tolerance {START_TOLERANCE:g})")


def _slowed(plan: JointTrajectory, share: float) -> JointTrajectory:
    """A trajectory at a share of its speed, which ends at rest."""
    velocities, accelerations = plan.velocities * share, plan.accelerations * share**2
    velocities[-1] = 0.0
    times = plan.times / share
    return JointTrajectory(plan.joint_names, times, plan.positions, velocities, accelerations)
