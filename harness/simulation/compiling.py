"""Compiles a MuJoCo specification; an error names the body that MuJoCo rejects."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import re
from collections.abc import Iterable

import mujoco
import numpy as np

from harness.core.errors import ModelRefused
from harness.core.world import WorldObject

SMALLEST_MASS = 1e-14  # Smallest mass of a movable object [kg]; MuJoCo rejects less than 1e-15
SMALLEST_MOMENT = 2e-14  # Smallest principal moment [kg m^2]; MuJoCo rejects less than 1e-14
ELEMENT = re.compile(r"Element name '(?P<name>.*)', id \d+")  # What MuJoCo's message names

CALLBACKS = ("control", "passive", "act_dyn", "act_gain", "act_bias", "sensor", "contactfilter")
"""MuJoCo's callbacks that change a simulation; they act on each model of the process."""


def compile_model(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Compile a specification.

    Raises:
        ModelRefused: MuJoCo rejects a body or one of its geoms; the error names the body. Or other
            code of this process has set a callback of MuJoCo.
    """
    _refuse_callbacks()
    try:
        return spec.compile()
    except ValueError as error:
        message = str(error)
        reason, *_ = message.removeprefix("Error: ").splitlines()
        found = ELEMENT.search(message)
        element = found["name"] if found else ""
        bodies = {body.name for body in spec.bodies} - {"world"}
        owner = re.sub(r" \d+$", "", element)  # the geoms of a body are numbered
        body = next((name for name in (element, owner) if name in bodies), "")
        about = f" ('{element}')" if element and not body else ""
        raise ModelRefused(body, f"the physics refuses it: {reason}{about}") from error


def _refuse_callbacks() -> None:
    for name in CALLBACKS:
        if getattr(mujoco, f"get_mjcb_{name}")() is not None:
            raise ModelRefused(
                "",
                f"other code in this process called mujoco.set_mjcb_{name}, which would change the"
                f" physics of this run too: call mujoco.set_mjcb_{name}(None) before it",
            )


def refuse_unusable_masses(objects: Iterable[WorldObject]) -> None:
    """Reject movable objects that are too light for the physics, or whose mass is not finite.

    Raises:
        ModelRefused: The error names the first such object.
    """
    for obj in objects:
        if obj.is_static:
            continue
        if not np.isfinite([obj.mass, *obj.inertia.ravel()]).all():
            raise ModelRefused(obj.name, "its mass or its inertia is larger than any number")
        moment = float(np.linalg.eigvalsh(obj.inertia)[0])
        for what, value, least, unit in (
            ("a mass of", obj.mass, SMALLEST_MASS, "kg"),
            ("its smallest principal moment of inertia is", moment, SMALLEST_MOMENT, "kg m^2"),
        ):
            if value < least:
                needed = f"{value:.3g} {unit}; the physics needs at least {least:g} {unit}"
                raise ModelRefused(obj.name, f"{what} {needed}")
