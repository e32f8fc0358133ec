"""Simulated seconds per wall second of the flagship lesson, and of its physics alone."""

import statistics
import time

import mujoco
import numpy as np
import pytest

from harness.core.resources import data_folder
from harness.simulation import mujoco_simulator
from harness.simulation.recording import Recording
from tests.running import run_case

FLAGSHIP = data_folder("scenarios") / "lessons/03_ur_sixteen_steps.scenario.yaml"
PARTS = ("compile", "plan", "simulate", "judge", "write")
GOAL = 1.08
REPETITIONS = 3


class Raced(Recording):
    """Records as ever, and steps a twin of the physics with nothing but the controls."""

    recorded = bare = 0.0
    steps = 0
    races = 0

    def __init__(self, physics, data):
        super().__init__(physics, data)
        self._model, self._data, self._twin = physics.model, data, mujoco.MjData(physics.model)

    def advance(self, controls, commands, command_velocities):
        mujoco.mj_copyData(self._twin, self._model, self._data)
        races = [
            ("bare", lambda: self._step_bare(controls[: len(commands)])),
            ("recorded", lambda: Recording.advance(self, controls, commands, command_velocities)),
        ]
        for name, race in races if Raced.races % 2 else reversed(races):
            begin = time.perf_counter()
            race()
            setattr(Raced, name, getattr(Raced, name) + time.perf_counter() - begin)
        Raced.steps += len(commands)
        Raced.races += 1
        assert np.array_equal(self._twin.qpos, self._data.qpos)

    def _step_bare(self, controls):
        model, twin, step = self._model, self._twin, mujoco.mj_step
        control = twin.ctrl
        for row in controls:
            control[:] = row
            step(model, twin)


@pytest.mark.benchmark
def test_flagship_lesson_by_parts_against_bare_physics(print_row, tmp_path, monkeypatch):
    run_case(FLAGSHIP, report_dir=tmp_path / "warm_up")
    runs, races = [], []
    for number in range(REPETITIONS):
        runs.append(run_case(FLAGSHIP, report_dir=tmp_path / str(number)))
        Raced.recorded, Raced.bare, Raced.steps = 0.0, 0.0, 0
        with monkeypatch.context() as patch:
            patch.setattr(mujoco_simulator, "Recording", Raced)
            raced = run_case(FLAGSHIP)
        races.append((Raced.bare, Raced.recorded, Raced.steps))
        assert raced.digest == runs[-1].digest, "the race changed the run"
    assert all(run.outcome == "passed" for run in runs)
    simulated = runs[0].sim_time
    bare, recorded, steps = (statistics.median(column) for column in zip(*races, strict=True))

    heading = f"flagship lesson, {simulated:.1f} s simulated, medians of {REPETITIONS}"
    print_row(heading, "part", "wall", "simulated s per wall s", "x bare physics")

    def row(name, wall):
        print_row(heading, name, f"{wall:.2f} s", f"{simulated / wall:.1f}", f"{wall / bare:.2f}x")

    for part in PARTS:
        row(part, statistics.median(run.wall_times[part] for run in runs))
    row("all", statistics.median(sum(run.wall_times.values()) for run in runs))

    heading = f"physics alone, {steps:.0f} steps in turns, medians of {REPETITIONS}"
    print_row(heading, "loop", "wall", "us a step", "x bare", "goal")
    for name, wall, goal in (("bare mj_step", bare, ""), ("recorded", recorded, f"{GOAL}x")):
        cells = (f"{wall:.2f} s", f"{1e6 * wall / steps:.1f}", f"{wall / bare:.3f}x", goal)
        print_row(heading, name, *cells)
