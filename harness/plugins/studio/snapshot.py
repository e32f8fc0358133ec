"""Saves the state of a running simulation, and restores it to the bit."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco

from harness.core.surface_motion import SurfaceMotion
from harness.core.types import FloatArray
from harness.ports.joint_control import JointController
from harness.simulation.set_points import SetPoints
from harness.simulation.step_state import StepState, refresh, set_step_state

CHANGED_IN_PLACE = (
    "geom_contype",
    "geom_conaffinity",
    "geom_friction",
    "geom_priority",
    "geom_surfacevel",
    "body_gravcomp",
    "body_pos",
    "body_quat",
    "eq_obj1id",
    "eq_data",
    "actuator_forcerange",
    "actuator_gainprm",
    "actuator_biasprm",
    "pair_friction",
    "jnt_limited",
    "jnt_range",
    "jnt_solref",
    "jnt_solimp",
)
"""Arrays of the model that objects, surfaces, welds, grips and faults write to during a run."""

OF_FAULTS = ("grip_share", "_stalled", "_deviation", "_latency", "_waiting", "_rng", "noise")
"""Attributes of the active faults."""


@dataclass(frozen=True, eq=False)
class PhysicsState:
    """A snapshot of a simulator: copies of all that decides how the run continues.

    Attributes:
        step: The state that the next step follows from.
        model: Arrays of the model that change during a run, by name.
        samples: The number of samples recorded so far.
        command: Set points of the actuated joints, shape (m,).
        control: Inputs of the servos, shape (m,).
        grips: Effort limits of grippers, by actuator.
        pending: Set points of grippers that set out with the next motion, by joint.
        controller: The joint controller, with its state.
        faults: Values of the attributes `OF_FAULTS` of the active faults, by name.
        objects: Since which samples each object stands where it was put; None: it is absent.
        surfaces: Since which samples the surface of each belt moves how.
    """

    step: StepState
    model: Mapping[str, Any]
    samples: int
    command: FloatArray
    control: FloatArray
    grips: Mapping[int, float]
    pending: Mapping[str, SetPoints | None]
    controller: JointController
    faults: Mapping[str, Any]
    objects: Mapping[str, list[tuple[int, FloatArray | None]]]
    surfaces: Mapping[str, list[tuple[int, SurfaceMotion]]]


def changed_arrays(model: mujoco.MjModel) -> dict[str, Any]:
    """Copies of the arrays of a model that change during a run."""
    return {name: getattr(model, name).copy() for name in CHANGED_IN_PLACE}


def load_state(model: mujoco.MjModel, data: mujoco.MjData, state: PhysicsState) -> None:
    """Set model and data to a snapshot, and update poses, contacts and forces."""
    for name, values in state.model.items():
        getattr(model, name)[...] = values
    set_step_state(model, data, state.step)
    refresh(model, data)
