"""Size of a run's page, how long it takes to write, and to be ready in a browser."""

import statistics
import time

import numpy as np
import pytest

from harness.core.resources import data_folder
from harness.recording.read_run import read_run
from harness.recording.stored_run import StoredRun
from harness.reporting.html.write import write_page
from tests.judging.synthetic_run import lift_run
from tests.running import run_case

FLAGSHIP = data_folder("scenarios") / "lessons/03_ur_sixteen_steps.scenario.yaml"
REPETITIONS = 5
LARGEST, LONGEST_WRITING, LONGEST_OPENING = 2.0, 1.0, 2.0  # MB, s, s


def medians(action):
    """Wall and processor time of an action [s]."""
    walls, processors = [], []
    for _ in range(REPETITIONS):
        begin, used = time.perf_counter(), time.process_time()
        action()
        walls.append(time.perf_counter() - begin)
        processors.append(time.process_time() - used)
    return statistics.median(walls), statistics.median(processors)


def flagship(folder):
    run_case(FLAGSHIP, report_dir=folder / "run", page=False)
    return read_run(folder / "run")


def ten_minutes():
    count = 600_001
    phase = np.linspace(0, 300, count)
    run = lift_run(count, joint_positions=np.stack([np.sin(phase), np.cos(phase)], axis=1))
    return StoredRun(run, (), "passed", "", {})


@pytest.mark.benchmark
def test_pages_by_size_time_to_write_and_time_until_ready(print_row, visit, tmp_path):
    heading = f"report pages, medians of {REPETITIONS}"
    goals = f"{LARGEST:g} MB, {LONGEST_WRITING:g} s, {LONGEST_OPENING:g} s"
    print_row(heading, "page", "size", "written in", "of it processor", "ready in", "goals")
    runs = {"flagship": flagship(tmp_path), "600 001 samples by hand": ten_minutes()}
    for name, stored in runs.items():
        page = tmp_path / "report.html"
        wall, processor = medians(lambda stored=stored: write_page(tmp_path, stored))
        ready = statistics.median(
            visit(page, width=1400, height=900).page.evaluate("window.readyAfter") / 1000
            for _ in range(REPETITIONS)
        )
        times = (f"{wall:.2f} s", f"{processor:.2f} s", f"{ready:.2f} s")
        print_row(heading, name, f"{page.stat().st_size / 1e6:.2f} MB", *times, goals)
