"""A program as text for a person."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from harness.cell.program import Program
from harness.core.amounts import point_text
from harness.core.printable import printable
from harness.core.spatial import SE3, xyzw_from_wxyz
from harness.core.world import World
from harness.judging.expectation import Mechanisms
from harness.judging.placed import describe
from harness.language.expectation import ExpectationFields
from harness.ports.motion_planning import PlanningOptions
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription
from harness.session.predict import predict
from harness.session.prepare import prepare

Describe = Callable[[ExpectationFields], str]


def explain(
    program: Program,
    predicted: Sequence[StepRecord],
    tcp_poses: Mapping[str, tuple[SE3, SE3]],
    describe: Describe,
) -> str:
    """Robot, world, steps with their seeds, TCP poses and expansion, expectations.

    Args:
        predicted: Step records of a dry run; composite steps come with what they expand to.
        tcp_poses: T_world_tcp at the start and end of each step, by its path.
    """
    lines = [program.title, "", *_robot(program.description), *_world(program.world), "steps"]
    lines += _steps(program, predicted, tcp_poses, describe)
    whole = [item for item in program.expectations if not item.step]
    if whole:
        lines.append("expected of the whole run")
        lines += [f"  {item.line:>4}  {describe(item.spec)}" for item in whole]
    return "\n".join(map(printable, lines)) + "\n"


def _robot(robot: RobotDescription) -> list[str]:
    lines = [f"robot {robot.name}, TCP {robot.tcp_link}, inverse kinematics: {robot.ik_solver}"]
    for name, group in robot.groups.items():
        states = ", ".join(robot.states_of(name)) or "none"
        lines.append(f"  group {name}: {', '.join(group.joint_names)}; named states: {states}")
    start = ", ".join(
        f"{name} {robot.joint_units.text({name: value})}"
        for name, value in robot.start_state.items()
    )
    return [*lines, f"  starts at {start}" if start else "  starts at zero", ""]


def _world(world: World) -> list[str]:
    lines = [f"world {world.name}, physics step {world.timestep * 1e3:g} ms"]
    for obj in world.objects:
        kind = "static" if obj.is_static else f"{obj.mass:g} kg"
        parts = ["planning"] * obj.in_planning + ["simulation"] * obj.in_simulation
        lines.append(
            f"  {obj.name}: {kind}, at {point_text(obj.pose.translation)},"
            f" friction {obj.friction.sliding:g}, in {' and '.join(parts)}"
        )
    return [*lines, ""]


def _steps(
    program: Program,
    predicted: Sequence[StepRecord],
    tcp_poses: Mapping[str, tuple[SE3, SE3]],
    describe: Describe,
) -> list[str]:
    options = {step.path: step.options for step in program.all_steps()}
    expected = [record.path for record in predicted if record.status == "expected error"]
    lines: list[str] = []
    for record in predicted:
        indent = "  " * (1 + record.path.count("."))
        lines.append(f"{indent}{record.line:>4}  {record.summary}{_seed(record, options)}")
        lines += [f"{indent}        {line}" for line in _tcp(tcp_poses.get(record.path))]
        if record.error_code:
            is_known = any(f"{record.path}.".startswith(f"{path}.") for path in expected)
            known = "as expected" if is_known else "NOT EXPECTED"
            lines.append(f"{indent}        fails ({known}): {record.error_code}: {record.message}")
        lines += [
            f"{indent}        expect {describe(item.spec)}"
            for item in program.expectations
            if item.step == record.id and record.path in options
        ]
    return [*lines, ""]


def _seed(record: StepRecord, options: dict[str, PlanningOptions]) -> str:
    step = options.get(record.path)
    return "" if step is None else f"  [seed {step.seed}]"


def _tcp(poses: tuple[SE3, SE3] | None) -> list[str]:
    """Where the TCP is at the start and the end of a step, as a file has poses."""
    if poses is None:
        return []
    start, end = (_pose(pose) for pose in poses)
    return [f"TCP at {start}"] if start == end else [f"TCP from {start}", f"TCP to   {end}"]


def _pose(pose: SE3) -> str:
    quat = xyzw_from_wxyz(pose.as_vector()[3:])
    quat = quat * np.sign(quat[np.argmax(np.abs(quat))])  # of two signs of one rotation always one
    xyz, quat_xyzw = (
        ", ".join(f"{round(float(value), 5) + 0.0:g}" for value in part)  # no minus before zero
        for part in (pose.translation, quat)
    )
    return f"{{xyz: [{xyz}], quat_xyzw: [{quat_xyzw}]}}"


def explain_file(
    path: Path, *, overrides: Mapping[str, str] | None = None, seed: int | None = None
) -> str:
    """The program as text: every number resolved, composite steps expanded.

    Raises:
        SpecError: With every problem of the file.
    """
    prepared = prepare(path, overrides, seed)
    program = prepared.program
    records, poses = predict(program, prepared.ports)
    mechanisms = Mechanisms.of(program.description, program.world.objects)
    return explain(program, records, poses, partial(describe, mechanisms=mechanisms))
