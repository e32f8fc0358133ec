"""Predicts the results of steps, as far as they are known without physics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from harness.cell.program import Program, ProgramStep
from harness.core.spatial import SE3
from harness.ports.motion_planning import PlanningPorts
from harness.ports.scene import PlanningScene, Touch
from harness.recording.step_record import StepRecord
from harness.session.dry_run import DryPlanner, DrySimulator
from harness.session.execute import ProgramExecution


def predict(
    program: Program, ports: PlanningPorts
) -> tuple[tuple[StepRecord, ...], Mapping[str, tuple[SE3, SE3]]]:
    """Step records of a run that follows every command exactly; a failed step does not end it.

    Returns:
        The records, and by the path of a step T_world_tcp at its start and at its end; a step that
        is not reached has none.
    """
    simulator = DrySimulator(program, ports.scene)
    poses: dict[str, tuple[SE3, SE3]] = {}

    def watch(step: ProgramStep, record: StepRecord | None) -> None:
        simulator.watch(step, record)
        tcp_link = program.description.tcp_link
        pose = ports.kinematics.link_pose(simulator.joint_positions(), tcp_link)
        poses[step.path] = (poses.get(step.path, (pose, pose))[0], pose)

    dry = ports._replace(planner=DryPlanner(ports.planner, program.description))
    execution = ProgramExecution(program, dry, simulator, watch, keep_going=True)
    execution.run(program.steps)
    return execution.finish().steps, poses


def touches_at_start(program: Program, scene: PlanningScene) -> tuple[Touch, ...]:
    """The world's objects that the robot touches at its start, deepest first.

    A gripper that opens may leave what it touched, so that no step fails because of it; the physics
    pushes the object away nevertheless.

    Args:
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
        if not any(record.path.startswith(f"{path}.") for path in expected)
        and not any(
            other.path.startswith(f"{record.path}.") and other.error_code == record.error_code
            for other in failed
        )
    )
