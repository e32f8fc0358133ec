"""The flagship lesson: command to verdict and report, its parts, and its physics alone."""

import os
import statistics
import subprocess
import sys
import time

import mujoco
import numpy as np
import pytest

from harness.core.resources import data_folder
from harness.simulation import mujoco_simulator
from harness.simulation.recording import Recording
from tests.benchmarks.interleaved import with_bytecode
from tests.running import run_case

FLAGSHIP = data_folder("scenarios") / "lessons/03_ur_sixteen_steps.scenario.yaml"
PARTS = ("compile", "plan", "simulate", "judge", "write")
GOAL = 1.08
REPETITIONS = 5
LIBRARIES = "numpy, mujoco, pinocchio, ompl.base, pydantic"
"""What a run cannot do without; the time to import them shows how fast a machine is."""

LARGEST = """import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"""
"""Prints the memory of the largest process of a command [kB].

A command that this process starts would count with the memory that this process had until then.
"""


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
            begin = time.process_time()
            race()
            setattr(Raced, name, getattr(Raced, name) + time.process_time() - begin)
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
    print_row(heading, "loop", "processor", "us a step", "x bare", "goal")
    for name, wall, goal in (("bare mj_step", bare, ""), ("recorded", recorded, f"{GOAL}x")):
        cells = (f"{wall:.2f} s", f"{1e6 * wall / steps:.1f}", f"{wall / bare:.3f}x", goal)
        print_row(heading, name, *cells)


@pytest.mark.benchmark
def test_command_to_verdict_and_to_the_finished_report(print_row, tmp_path):
    """Wall seconds, and the largest process of all; for a machine that does nothing else."""
    rows = []
    command = [sys.executable, "-m", "harness.cli", "run", str(FLAGSHIP)]
    imports = [sys.executable, "-c", f"import {LIBRARIES}"]
    environment = with_bytecode(tmp_path / "bytecode")
    subprocess.run([*command, "--no-report"], check=True, capture_output=True, env=environment)
    subprocess.run(imports, check=True, env=environment)
    for number in range(REPETITIONS):
        begin = time.perf_counter()
        subprocess.run(imports, check=True, env=environment)
        alone = time.perf_counter() - begin
        folder = tmp_path / str(number)
        begin = time.perf_counter()
        with subprocess.Popen(
            [*command, "--report-dir", str(folder)],
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        ) as process:
            while "passed" not in process.stdout.readline():
                assert process.poll() is None
            verdict = time.perf_counter() - begin
            process.stdout.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        report = time.perf_counter() - begin
        processor = usage.ru_utime + usage.ru_stime
        rows.append((alone, verdict, report, processor))
    alone, verdict, report, processor = map(statistics.median, zip(*rows, strict=True))
    measured = [sys.executable, "-c", LARGEST, *command, "--report-dir", str(tmp_path / "memory")]
    done = subprocess.run(measured, check=True, capture_output=True, text=True, env=environment)
    memory = int(done.stdout)
    heading = f"harness run of the flagship, medians of {REPETITIONS}"
    print_row(heading, "figure", "measured", "x the imports", "goal")
    print_row(heading, "importing the libraries alone", f"{alone:.2f} s", "1", "")

    def row(name, seconds, goal):
        print_row(heading, name, f"{seconds:.2f} s", f"{seconds / alone:.1f}", goal)

    row("verdict on the terminal", verdict, "2.0 s, 11 x")
    row("finished report", report, "2.5 s, 13.7 x")
    row("processor time of all processes", processor, "")
    print_row(heading, "largest process", f"{memory / 1024:.0f} MB", "", "300 MB")
