"""Predicts the results of steps, as far as they are known without physics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

from harness.cell.program import Program, ProgramStep
from harness.core.spatial import SE3
from harness.engine.dry_run import DryPlanner, DrySimulator
from harness.engine.execute import execute_program
from harness.ports.kinematics import Kinematics
from harness.ports.motion_planning import MotionPlanner
from harness.ports.scene import PlanningScene, Touch
from harness.recording.step_record import StepRecord


def predict(
    program: Program, scene: PlanningScene, kinematics: Kinematics, planner: MotionPlanner
) -> tuple[StepRecord, ...]:
    """Step records of a run that follows every command exactly; a failed step does not end it."""
    return predict_with_poses(program, scene, kinematics, planner)[0]


def predict_with_poses(
    program: Program, scene: PlanningScene, kinematics: Kinematics, planner: MotionPlanner
) -> tuple[tuple[StepRecord, ...], Mapping[str, tuple[SE3, SE3]]]:
    """The records that `predict` returns, and T_world_tcp at the start and end of each step.

    Returns:
        The records, and by the path of a step its two poses; a step that is not reached has none.
    """
    simulator = DrySimulator(program)
    poses: dict[str, tuple[SE3, SE3]] = {}

    def watch(
        kind: Literal["step_started", "step_finished"],
        step: ProgramStep,
        record: StepRecord | None,
    ) -> None:
        simulator.watch(kind, step, record)
        pose = kinematics.link_pose(simulator.joint_positions(), program.description.tcp_link)
        poses[step.path] = (poses.get(step.path, (pose, pose))[0], pose)

    execution = execute_program(
        program,
        scene,
        kinematics,
        DryPlanner(planner, program.description),
        simulator,
        watch,
    )
    return execution.steps, poses


def touches_at_start(program: Program, scene: PlanningScene) -> tuple[Touch, ...]:
    """The world's objects that the robot touches at its start, deepest first.

    A gripper that opens may leave what it touched, so that no step fails because of it; the physics
    pushes the object away nevertheless.

    Args:
        program: The program whose start state is checked.
        scene: An empty scene, which is empty again afterwards.
    """
    objects = [obj for obj in program.world.objects if obj.in_planning]
    for obj in objects:
        scene.add_object(obj, obj.pose)
    touches = scene.touches(program.description.start_positions())
    for obj in objects:
        scene.remove_object(obj.name)
    names = {obj.name for obj in objects}
    found = [touch for touch in touches if {touch.first, touch.second} & names]
    return tuple(sorted(found, key=lambda touch: touch.distance))


def unexpected(records: Sequence[StepRecord]) -> tuple[StepRecord, ...]:
    """Predicted failures that the file does not expect, each once, at the innermost step it hits.

    What fails inside a step that expects this failure is expected; what fails inside any other step
    is not reported again for the step that contains it. That an expected failure stays away cannot
    be known without physics.
    """
    expected = [record.path for record in records if record.status == "expected error"]
    failed = [record for record in records if record.error_code and record.status == "failed"]
    return tuple(
        record
        for record in failed
        if not any(_inside(record.path, path) for path in expected)
        and not any(
            _inside(other.path, record.path) and other.error_code == record.error_code
            for other in failed
        )
    )


def _inside(path: str, around: str) -> bool:
    return path.startswith(f"{around}.")
