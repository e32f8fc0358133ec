"""The state that the next step follows from, and the sleep of bodies at rest, which is part of it.

A tree of bodies falls asleep with everything that it touches when all of it has been slow for ten
steps: from then on MuJoCo computes no contacts for it, and it does not move. MuJoCo wakes it when a
body that is awake touches it and when a force is applied to it; `wake` is for all other changes.
"""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from harness.core.types import FloatArray, IntArray

SLEEP_TIME = 1e-6
"""The speed below which a body may fall asleep is that of a free fall of this duration [s].

Under the gravity of Earth this is 0.01 mm/s. What begins to fall or to slide, under whatever
gravity, is a thousand times faster after the ten steps; cylinders that stand on a table tremble
with a few micrometres per second in MuJoCo's contacts, boxes with less than a nanometre.
"""

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


def allow_sleep(option: mujoco.MjOption) -> None:
    """Let bodies at rest fall asleep under the gravity of `option`."""
    option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    option.sleep_tolerance = SLEEP_TIME * float(np.linalg.norm(option.gravity))


def wake(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Wake every body, and update poses, contacts and forces, those of static bodies included.

    Needed after changes of the model and of positions: as long as bodies may sleep, MuJoCo does not
    look at a static body again.
    """
    flags = model.opt.enableflags
    model.opt.enableflags = flags & ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    refresh(model, data)
    model.opt.enableflags = flags


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


def refresh(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Update poses, contacts and forces without changing the start of the next step."""
    warmstart = data.qacc_warmstart.copy()
    mujoco.mj_forward(model, data)
    data.qacc_warmstart[:] = warmstart
