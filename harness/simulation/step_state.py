"""The sleep of bodies at rest, and what refreshes the state that the next step follows from.

A tree of bodies falls asleep with everything that it touches when all of it has been slow for ten
steps: from then on MuJoCo computes no contacts for it, and it does not move. MuJoCo wakes it when a
body that is awake touches it and when a force is applied to it; `wake` is for all other changes.
"""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco
import numpy as np

SLEEP_TIME = 1e-6
"""The speed below which a body may fall asleep is that of a free fall of this duration [s]: under
the gravity of Earth 0.01 mm/s. What begins to fall or to slide is a thousand times faster after
the ten steps; cylinders that stand on a table tremble with micrometres per second.
"""


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


def refresh(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Update poses, contacts and forces without changing the start of the next step."""
    warmstart = data.qacc_warmstart.copy()
    mujoco.mj_forward(model, data)
    data.qacc_warmstart[:] = warmstart
