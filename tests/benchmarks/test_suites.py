"""Suites: cases per minute, what two cores give, what isolation costs, collection, memory."""

import os
import re
import statistics
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness.core.resources import data_folder
from harness.suite.cases import run_here
from harness.suite.plan import Wanted, planned
from harness.suite.suite_run import How, SuiteRun
from harness.suite.warm import WarmServer

pytestmark = pytest.mark.benchmark
PICK = data_folder("scenarios") / "lessons/04_ur_pick_by_friction.scenario.yaml"
NATIVE = ("numpy", "mujoco", "pinocchio", "coal", "ompl", "toppra", "cv2")
BLINK = """\
scenario: Blink
robot: open_manipulator_x
params: {time: 0.05 s}
steps:
  - wait: "${time}"
randomize:
  time: {uniform: [0.04 s, 0.06 s]}
"""


def suite_of(file, **words):
    return SuiteRun(planned([file], Wanted()), How(**words))


def collected(file, **words):
    """A suite that has run, and the wall seconds it took."""
    suite = suite_of(file, **words)
    with WarmServer() as server:
        server.open()
        begin = time.perf_counter()
        suite.collect(server)
        return suite, time.perf_counter() - begin


def test_cases_of_a_pick_a_minute_on_one_core_and_on_two(tmp_path, tell):
    seeds = ", ".join(map(str, range(200)))
    file = tmp_path / "pick.scenario.yaml"
    file.write_text(f"{PICK.read_text()}\nparametrize: {{seed: [{seeds}]}}\n")
    seconds = {}
    for workers in (1, 2):
        suite, seconds[workers] = collected(file, workers=workers)
        assert suite.outcome == "passed"
    heading = "200 cases of a pick"
    tell(heading, "workers", "wall", "cases a minute a core", "efficiency", "goal")
    for workers, wall in seconds.items():
        efficiency = seconds[1] / workers / wall
        each = f"{60 * 200 / wall / workers:.0f}"
        tell(heading, str(workers), f"{wall:.0f} s", each, f"{efficiency:.2f}",
             "" if workers == 1 else "0.9")  # fmt: skip


def test_what_isolation_costs_a_scenario(tmp_path, tell):
    file = tmp_path / "blink.scenario.yaml"
    file.write_text(BLINK + "samples: 40\n")
    jobs = [each.job for each in planned([file], Wanted())]
    next(run_here(jobs[:1]))  # imports
    here, apart = [], []
    with WarmServer() as server:
        server.open()
        for job in jobs:
            begin = time.perf_counter()
            list(run_here([job]))
            here.append(time.perf_counter() - begin)
            suite = SuiteRun(planned([file], Wanted(cases=[job.case])), How())
            begin = time.perf_counter()
            suite.collect(server)
            apart.append(time.perf_counter() - begin)
    one, other = statistics.median(here), statistics.median(apart)
    heading = "isolation, medians of 40"
    tell(heading, "in this process", "in its own", "cost", "goal")
    tell(heading, f"{1000 * one:.0f} ms", f"{1000 * other:.0f} ms",
         f"{1000 * (other - one):.0f} ms", "40 ms")  # fmt: skip


def test_collection_of_a_thousand_files(tmp_path, tell):
    text = PICK.read_text()
    for number in range(1000):
        (tmp_path / f"case{number}.scenario.yaml").write_text(text)
    plain = tmp_path / "empty"
    plain.mkdir()
    (plain / "test_nothing.py").write_text("def test_nothing(): pass\n")
    command = [sys.executable, "-X", "importtime", "-m", "pytest", "--collect-only", "-q",
               "-p", "no:cacheprovider", "-p", "no:randomly"]  # fmt: skip
    seconds = {}
    for name, folder in (("one test", plain), ("1,000 scenarios", tmp_path)):
        begin = time.perf_counter()
        done = subprocess.run(
            [*command, "--rootdir", str(folder), str(folder)],
            cwd=folder, capture_output=True, text=True, check=True,
        )  # fmt: skip
        seconds[name] = time.perf_counter() - begin
    native = re.findall(
        r"\| *(mujoco|pinocchio|coal|ompl|toppra|numpy)$", done.stderr, re.MULTILINE
    )
    heading = "pytest --collect-only"
    tell(heading, "files", "wall", "native imports", "goal")
    tell(heading, "one test", f"{seconds['one test']:.2f} s", "", "")
    tell(heading, "1,000 scenarios", f"{seconds['1,000 scenarios']:.2f} s",
         ", ".join(native) or "none", "2 s")  # fmt: skip


def resident(pid):
    """Memory of a process [MB]."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024


def test_memory_over_two_thousand_samples(tmp_path, tell):
    file = tmp_path / "blink.scenario.yaml"
    file.write_text(BLINK + "samples: 2000\n")
    suite = suite_of(file, workers=2)
    marks = {}
    with WarmServer() as server:
        server.open()

        def told(index, _result):
            if index + 1 in (200, 1000, 2000):
                children = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text()
                marks[index + 1] = (resident(os.getpid()), sum(map(resident, children.split())))

        suite.collect(server, told=told)
    assert suite.outcome == "passed"
    heading = "memory over 2,000 samples"
    tell(heading, "samples", "suite", "fork server")
    for count, (own, other) in sorted(marks.items()):
        tell(heading, str(count), f"{own:.0f} MB", f"{other:.0f} MB")
