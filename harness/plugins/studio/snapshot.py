"""Saves the state of a running simulation, and restores it to the bit."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from harness.core.surface_motion import SurfaceMotion
from harness.core.types import FloatArray, IntArray
from harness.ports.joint_control import JointController
from harness.simulation.set_points import SetPoints
from harness.simulation.step_state import refresh, wake

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

OF_FAULTS = ("grip_share", "deviation", "latency", "waiting", "sources", "noise")
"""Attributes of the active faults."""

STATE = mujoco.mjtState.mjSTATE_INTEGRATION
"""All that MuJoCo integrates, and the warm start, without which a step differs in its last bits."""

_ARRAYS = (
    "tree_asleep",
    "tree_awake",
    "body_awake",
    "body_awake_ind",
    "parent_awake_ind",
    "dof_awake_ind",
)
_COUNTS = ("ntree_awake", "nbody_awake", "nparent_awake", "nv_awake")


@dataclass(frozen=True, eq=False)
class StepState:
    """All that the next step of a model follows from, besides its controls.

    Attributes:
        arrays: The trees, bodies and degrees of freedom that are asleep, as `_ARRAYS` lists them.
        counts: The numbers of those that are awake, as `_COUNTS` lists them.
    """

    integration: FloatArray
    arrays: tuple[IntArray, ...]
    counts: tuple[int, ...]


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


def step_state(model: mujoco.MjModel, data: mujoco.MjData) -> StepState:
    """A copy of the current state."""
    integration = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, integration, STATE)
    arrays = tuple(getattr(data, name).copy() for name in _ARRAYS)
    return StepState(integration, arrays, tuple(getattr(data, name) for name in _COUNTS))


def set_step_state(model: mujoco.MjModel, data: mujoco.MjData, state: StepState) -> None:
    """Go on from a state of the same model."""
    mujoco.mj_setState(model, data, state.integration, STATE)
    wake(model, data)
    for name, values in zip(_ARRAYS, state.arrays, strict=True):
        getattr(data, name)[:] = values
    for name, value in zip(_COUNTS, state.counts, strict=True):
        setattr(data, name, value)
