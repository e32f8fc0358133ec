"""Adapters that move nothing, on which a program is executed without physics.

`harness check` and `harness explain` execute the program on them. Reach, goals in collision and
missing objects have the results of a run; contacts are assumed to happen as the file expects.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from harness.cell.program import Program, ProgramStep
from harness.core.details import Details
from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.core.wrench_sensor import Payload
from harness.ports.goals import JointGoal
from harness.ports.joint_control import JointController
from harness.ports.motion_planning import CheckedGoal, MotionPlan, MotionPlanner, MotionRequest
from harness.ports.motions import FreeMotion, JointMotion, TimedMotion
from harness.ports.scene import PlanningScene
from harness.ports.simulation import ExpectedGrasp, GripperResult
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription


class DrySimulator:
    """The Simulator port without physics: commands take effect at once, and no time passes."""

    def __init__(self, program: Program, scene: PlanningScene) -> None:
        """Stand at the start state; what an arm holds in the planning scene moves with it."""
        self._scene = scene
        self._missing: list[str] = []
        self._description = program.description
        self._positions = program.description.start_positions()
        self._poses = {obj.name: obj.pose for obj in program.world.objects}
        self._surfaces = {
            obj.name: obj.surface_motion
            for obj in program.all_objects()
            if obj.surface_motion is not None
        }
        self._movable = tuple(
            obj.name for obj in program.all_objects() if obj.in_simulation and not obj.is_static
        )

    def watch(self, step: ProgramStep, record: StepRecord | None) -> None:
        """Note which steps run; the gripper misses in a step that is expected to fail so."""
        if step.spec.expect_error != "CONTROL_FAILED":
            return
        if record is None:
            self._missing.append(step.path)
        else:
            self._missing.remove(step.path)

    @property
    def time(self) -> float:
        return 0.0

    @property
    def sample_count(self) -> int:
        return 1

    def joint_positions(self) -> FloatArray:
        return np.array(self._positions)

    def commanded_positions(self) -> FloatArray:
        return np.array(self._positions)

    def object_pose(self, name: str) -> SE3:
        if name in self._scene.attached():
            return self._scene.object_pose(name, self._positions)
        return self._poses[name]

    def track(self, trajectory: JointTrajectory) -> None:
        for name, position in zip(trajectory.joint_names, trajectory.positions[-1], strict=True):
            self._positions[self._description.joint_index[name]] = position
        self._positions = self._description.with_mimics(self._positions)

    def use_controller(self, controller: JointController | None) -> None: ...

    def force_on_robot(self, span: float, held: Collection[str]) -> tuple[float, FloatArray]:
        """What a guarded move waits for happens."""
        return float("inf"), np.zeros(3)

    def wrench(self, sensor: str, span: float) -> FloatArray:
        """What a guarded move waits for happens."""
        return np.full(6, np.inf)

    def tare(self, sensor: str, duration: float, payload: Payload | None = None) -> FloatArray:
        return np.zeros(6)

    def command_gripper(
        self,
        position: float,
        max_effort: float,
        *,
        timeout: float,
        expected: ExpectedGrasp | None = None,
        joint: str = "",
    ) -> GripperResult:
        grippers = {gripper.joint: gripper for gripper in self._description.grippers}
        if not grippers:
            raise RuntimeError("the robot has no gripper")
        gripper = grippers[joint or next(iter(grippers))]
        index = self._description.joint_index[gripper.joint]
        before = self._positions[index]
        span = gripper.closed_position - gripper.open_position
        is_closing = (position - before) * span > 0
        touched = self._movable if is_closing and not self._missing else ()
        end = position
        if expected is not None and touched:
            end = sorted((before, position, expected.position))[1]
            touched = touched if expected.is_free else ()
        self._positions[index] = end
        self._positions = self._description.with_mimics(self._positions)
        return GripperResult(
            position=end,
            effort=0.0,
            stalled=False,
            reached_goal=True,
            contacts=dict.fromkeys(gripper.sides, touched),
            between=touched,
        )

    def start_gripper(self, position: float, max_effort: float, joint: str = "") -> None: ...

    def hold(self, duration: float) -> None: ...

    def settle(self, max_velocity: float, timeout: float) -> bool:
        return True

    def add_object(self, name: str, pose: SE3) -> None:
        self._poses[name] = pose

    def remove_object(self, name: str) -> None:
        self._poses.pop(name, None)

    def move_object(self, name: str, pose: SE3) -> None:
        self._poses[name] = pose

    def surface_motion(self, name: str) -> SurfaceMotion:
        return self._surfaces[name]

    def drive_surface(self, name: str, motion: SurfaceMotion, duration: float) -> None:
        self._surfaces[name] = motion

    def weld(self, name: str, link: str) -> None: ...

    def unweld(self, name: str, believed: SE3 | None = None) -> None:
        if believed is not None:
            self._poses[name] = believed


class DryPlanner:
    """The MotionPlanner port that checks goals and jumps to them; lines and arcs are followed."""

    def __init__(self, planner: MotionPlanner, description: RobotDescription) -> None:
        self._planner = planner
        self._description = description

    def plan(self, request: MotionRequest) -> MotionPlan:
        motion = request.motion
        if isinstance(motion, JointMotion):
            request = replace(request, motion=FreeMotion(motion.goal))
        if isinstance(request.motion, FreeMotion):
            return self._jump(request)
        if isinstance(request.motion, TimedMotion):  # of motions that have no times here
            return MotionPlan(request.motion.trajectory, Details(), Details())
        options = replace(request.options, path_only=True)
        return self._planner.plan(replace(request, options=options))

    def check_goal(self, request: MotionRequest) -> CheckedGoal:
        return self._planner.check_goal(request)

    def _jump(self, request: MotionRequest) -> MotionPlan:
        """A plan that jumps from the start to the goal in a millisecond."""
        checked, goal = self.check_goal(request), request.goal
        positions = goal.positions if isinstance(goal, JointGoal) else checked.positions
        names = self._description.groups[request.group].joint_names
        indices = list(self._description.group_indices(request.group))
        ends = np.vstack([request.start[indices], positions])
        still = np.zeros_like(ends)
        trajectory = JointTrajectory(names, np.array([0.0, 1e-3]), ends, still, still)
        return MotionPlan(trajectory, Details(), checked.explanation)
