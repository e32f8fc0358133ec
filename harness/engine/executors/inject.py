"""inject: something breaks, and the step says what stood before."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.cell.cell import Cell
from harness.engine.registry import execute
from harness.spec.steps import Inject


@execute.handles(Inject)
def inject(step: Inject, cell: Cell) -> None:
    """Break what the step names; what came of it is read from the record after the run."""
    faults = cell.simulator.faults
    done: list[dict[str, Any]] = cell.notes.result.setdefault("faults", [])

    def note(fault: str, target: str, before: object, after: object) -> None:
        done.append({"fault": fault, "target": target, "before": before, "after": after})

    for name, sliding in (step.friction or {}).items():
        note("friction", name, faults.set_friction(name, sliding), sliding)
    if step.gripper_effort is not None:
        share = step.gripper_effort
        note("gripper_effort", cell.gripper.joint, faults.weaken_gripper(share), share)
    if step.joint_stall is not None:
        note("joint_stall", step.joint_stall, faults.stall_joint(step.joint_stall), True)
    if step.sensor_noise is not None:
        before = faults.disturb_sensors(step.sensor_noise, cell.current.options.seed)
        note("sensor_noise", "", before, step.sensor_noise)
    if step.command_latency is not None:
        before = faults.delay_commands(step.command_latency)
        note("command_latency", "", before, step.command_latency)
    for name, force in (step.push or {}).items():
        note("push", name, [0.0, 0.0, 0.0], list(force))
    if step.push:
        forces = {name: np.array(force) for name, force in step.push.items()}
        faults.push(forces, step.push_duration)
