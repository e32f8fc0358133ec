"""inject: a fault of the physics begins, and the step records what it replaces."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field, model_validator

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.amounts import amount
from harness.language.base import Angle, Duration, Force, Fraction, Name, Number, PositiveDuration
from harness.recording.faults import FaultKind, InjectedFault, InjectedFaults

PushForce = tuple[Force, Force, Force]


class Inject(Step):
    """Begin a fault of the physics; its receipt says `landed`, or `no_effect` and why.

    A push lasts `push_duration`; every other fault lasts until another `inject` ends it.
    """

    verb: ClassVar[str] = "inject"
    results = (InjectedFaults,)
    simulated_only = "faults are injected into simulated robots alone", "leave the step out"
    goes_with: ClassVar[Mapping[str, tuple[str, ...]]] = {"push_duration": ("push",)}

    friction: dict[Name, Annotated[Number, Field(ge=0, le=100)]] | None = Field(
        default=None,
        description="The surface of each named object gets this coefficient of sliding friction.",
    )
    gripper_effort: Fraction | None = Field(
        default=None,
        description="The gripper keeps this share of its effort; 1 restores all of it.",
    )
    joint_stall: Name | None = Field(
        default=None, description="The joint that keeps its position from now on."
    )
    push: dict[Name, PushForce] | None = Field(
        default=None,
        description="Each named object is pushed by this force along the world's x, y, z [N].",
    )
    push_duration: PositiveDuration = Field(
        default=0.1, description="A push lasts this long, and the step takes as long [s]."
    )
    sensor_noise: Annotated[Angle, Field(ge=0)] | None = Field(
        default=None,
        description="The standard deviation of measured joint positions [rad or m]; 0 ends the "
        "noise.",
    )
    command_latency: Annotated[Duration, Field(le=1)] | None = Field(
        default=None,
        description="Commands reach the motors with this delay [s]; 0 ends the delay.",
    )

    @model_validator(mode="after")
    def _any(self) -> Inject:
        faults = self.model_fields_set - Step.model_fields.keys() - {"push_duration"}
        if not faults:
            raise ValueError(
                "say which fault: friction, gripper_effort, joint_stall, push, sensor_noise,"
                " command_latency"
            )
        return self

    def summary(self) -> str:
        faults = [f"friction of {name} {value:g}" for name, value in (self.friction or {}).items()]
        faults += [f"push {name}" for name in self.push or {}]
        if self.gripper_effort is not None:
            faults.append(f"gripper effort {self.gripper_effort:.0%}")
        if self.joint_stall is not None:
            faults.append(f"stall {self.joint_stall}")
        if self.sensor_noise is not None:
            faults.append(f"sensor noise {amount(self.sensor_noise, 'rad')}")
        if self.command_latency is not None:
            faults.append(f"latency {self.command_latency * 1e3:g} ms")
        return ", ".join(faults)

    def check(self, at: At) -> None:
        scope = at.scope
        for name in self.friction or {}:
            scope.check_object(name, at.key("friction", name), simulated=True, is_key=True)
        for name in self.push or {}:
            loc = at.key("push", name)
            scope.check_object(name, loc, simulated=True, is_key=True)
            if name in scope.objects:
                scope.check_present(name, loc)
                if scope.objects[name].is_static:
                    scope.problems.add(loc, f"'{name}' is static: no push moves it")
        if self.push is not None:
            scope.take_time(self.push_duration * len(self.push), at.key("push_duration"))
        if self.gripper_effort is not None:
            scope.check_gripper(at.key("gripper_effort"), "`gripper_effort`")
        _check_stall(self.joint_stall, at)

    def execute(self, cell: Cell) -> None:
        """Begin the faults; their effect is read from the recording after the run."""
        from harness.plugins.faults.injection import Injection, MujocoSimulator

        if not isinstance(cell.simulator, MujocoSimulator):
            return  # a dry run, in which nothing breaks
        faults = Injection(cell.simulator)

        def note(fault: FaultKind, target: str, before: object, after: object) -> None:
            begun = cell.notes.result.find(InjectedFaults) or InjectedFaults(())
            one = InjectedFault(fault, target, before, after)
            cell.report(InjectedFaults((*begun.faults, one)))
            cell.faults[one.name] = cell.current.line

        for name, sliding in (self.friction or {}).items():
            note("friction", name, faults.set_friction(name, sliding), sliding)
        if self.gripper_effort is not None:
            share, joint = self.gripper_effort, cell.gripper.joint
            note("gripper_effort", joint, faults.weaken_gripper(share, joint), share)
        if self.joint_stall is not None:
            note("joint_stall", self.joint_stall, faults.stall_joint(self.joint_stall), True)
        if self.sensor_noise is not None:
            before = faults.disturb_sensors(self.sensor_noise, cell.current.options.seed)
            note("sensor_noise", "", before, self.sensor_noise)
        if self.command_latency is not None:
            before = faults.delay_commands(self.command_latency)
            note("command_latency", "", before, self.command_latency)
        for name, force in (self.push or {}).items():
            note("push", name, [0.0, 0.0, 0.0], list(force))
        if self.push:
            forces = {name: np.array(force) for name, force in self.push.items()}
            faults.push(forces, self.push_duration)


def _check_stall(name: str | None, at: At) -> None:
    if name is None:
        return
    description = at.scope.description
    joint = description.joint_by_name.get(name)
    if joint is None:
        at.scope.problems.unknown(at.key("joint_stall"), "joint", name, description.joint_names)
    elif joint.mimic is not None:
        at.scope.problems.add(
            at.key("joint_stall"),
            f"'{name}' follows '{joint.mimic.joint}'",
            f"stall '{joint.mimic.joint}'",
        )
