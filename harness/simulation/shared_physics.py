"""Stretches of a simulation that cases share as long as nothing that differs has had an effect.

MuJoCo's next state follows from its model, its integration state and the controls. The key of a
stretch holds all of them bit by bit, but for the friction of surfaces: of these only the ones that
touched can have had an effect, and a stretch is taken only by a case in which they are the same.
"""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import copy
import hashlib
from dataclasses import dataclass

import mujoco
import numpy as np

from harness.core.exact_key import exact_key
from harness.core.sharing import chain
from harness.core.types import FloatArray, IntArray
from harness.simulation.recording import RecordedPart, Recording
from harness.simulation.snapshot import CHANGED_IN_PLACE
from harness.simulation.step_state import StepState, set_step_state, step_state

SURFACES = ("geom_friction", "geom_priority", "pair_friction")
"""Arrays of the model that only contacts read."""

SHORTEST = 8
"""Steps of a stretch that is worth looking up."""

MOST_VARIANTS = 4
"""Stretches that are kept for one beginning: those that differ in the surfaces that touched."""


@dataclass(frozen=True, eq=False)
class _Stretch:
    """What was recorded in a stretch.

    Attributes:
        touching: The pairs of geoms that touched, shape (K, 2).
        surfaces: Key of their friction.
        recorded: The samples that it consists of.
        state: The state at the end.
    """

    touching: IntArray
    surfaces: str
    recorded: RecordedPart
    state: StepState


class SharedPhysics:
    """Advances a recording, with stretches that another case has computed where there are any."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, recording: Recording) -> None:
        self._model, self._data, self._recording = model, data, recording
        self._chain = chain("physics")
        if self._chain is None:
            return
        self._model_key = _model_key(model).encode()
        self._changed = [getattr(model, each) for each in CHANGED_IN_PLACE if each not in SURFACES]
        pairs = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
        self._explicit: dict[tuple[int, int], int] = {}
        for number, (first, second) in enumerate(pairs):
            self._explicit[first, second] = self._explicit[second, first] = number

    def advance(
        self, controls: FloatArray, commands: FloatArray, command_velocities: FloatArray
    ) -> None:
        """Step once for each row of `controls` except the last, as `Recording.advance` does."""
        recording, steps = self._recording, len(controls) - 1
        if self._chain is None or self._chain.is_over or steps < SHORTEST:
            recording.advance(controls, commands, command_velocities)
            if self._chain is not None:
                self._chain.note(max(0, steps))
            return
        first = recording.count
        key = self._key(controls)
        known: tuple[_Stretch, ...] = self._chain.find(key) or ()
        for stretch in known:
            if self._surfaces(stretch.touching) == stretch.surfaces:
                self._chain.take(steps)
                set_step_state(self._model, self._data, stretch.state)
                recording.take(stretch.recorded, commands, command_velocities)
                return
        recording.advance(controls, commands, command_velocities)
        touching = recording.touching_geoms(first - 1, first + steps)
        surfaces = self._surfaces(touching)

        def variants() -> tuple[_Stretch, ...]:
            state = step_state(self._model, self._data)
            stretch = _Stretch(touching, surfaces, recording.part(first), state)
            return (*known[1 - MOST_VARIANTS :], stretch)

        self._chain.keep(key, variants, steps, surfaces)

    def _key(self, controls: FloatArray) -> str:
        """Key of all that the next steps follow from, except for the surfaces.

        The shapes of all arrays but the last one are those of the model.
        """
        hasher = hashlib.sha256(self._model_key)
        state = step_state(self._model, self._data)
        for values in (*self._changed, state.integration, *state.arrays, controls):
            hasher.update(np.ascontiguousarray(values).data)
        return hasher.hexdigest()

    def _surfaces(self, touching: IntArray) -> str:
        """Key of the friction of pairs of geoms that touch, shape (K, 2).

        Of two surfaces the one with the higher priority decides, or both where it is equal; an
        explicit pair has its own friction.
        """
        model = self._model
        order = np.sign(np.diff(model.geom_priority[touching], axis=1))  # 1: the second decides
        frictions = model.geom_friction[touching]  # (K, 2, 3)
        frictions[:, 0][order[:, 0] > 0] = 0.0
        frictions[:, 1][order[:, 0] < 0] = 0.0
        pairs = [self._explicit.get((first, second), -1) for first, second in touching.tolist()]
        explicit = model.pair_friction[[pair for pair in pairs if pair >= 0]]
        hasher = hashlib.sha256()
        for values in (touching, order, frictions, np.array(pairs), explicit):
            hasher.update(values.tobytes())
        return hasher.hexdigest()


def _model_key(model: mujoco.MjModel) -> str:
    """Key of everything in a model that no run changes."""
    bare = copy.copy(model)
    for name in CHANGED_IN_PLACE:
        getattr(bare, name)[...] = 0
    content = np.zeros(mujoco.mj_sizeModel(bare), dtype=np.uint8)
    mujoco.mj_saveModel(bare, None, content)
    return exact_key(content)
