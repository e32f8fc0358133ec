"""Suites: cases per minute, what two cores give, what isolation costs, collection, memory.

Each figure is a test of its own, for a machine with two cores that does nothing else; processor
times next to the wall times show how busy it was. `-k` and these words choose one: `two_hundred`,
`second_core`, `isolation`, `thousand_files`, `memory_of_a_suite`, `memory_of_a_process`.
"""

import operator
import os
import re
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness.core.resources import data_folder
from harness.suite.cases import run_here
from harness.suite.plan import planned_cases
from harness.suite.request import SuiteRequest
from harness.suite.suite_run import SuiteRun
from harness.suite.warm import Ended, WarmServer

pytestmark = pytest.mark.benchmark
PICK = data_folder("scenarios") / "lessons/04_ur_pick_by_friction.scenario.yaml"
NATIVE = ("numpy", "mujoco", "pinocchio", "coal", "ompl", "cv2")
MARKS = (200, 500, 1000, 1500, 2000)  # samples after which memory is looked at
TICK = os.sysconf("SC_CLK_TCK")  # [1/s], of /proc's processor times
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
    return SuiteRun(planned_cases([file], SuiteRequest()), SuiteRequest(**words))


def picks(folder, count):
    """A file with so many cases of a pick."""
    seeds = ", ".join(map(str, range(count)))
    file = folder / f"pick{count}.scenario.yaml"
    file.write_text(f"{PICK.read_text()}\nparametrize: {{seed: [{seeds}]}}\n")
    return file


def blinks(folder, count):
    """A file with so many samples of next to nothing."""
    file = folder / "blink.scenario.yaml"
    file.write_text(f"{BLINK}samples: {count}\n")
    return file


def open_server():
    """A fork server that has imported everything."""
    server = WarmServer()
    server.open()
    in_own_process(server)
    return server


def in_own_process(server):
    """Run a job that does nothing."""
    server.start(operator.is_, 0)
    while not any(isinstance(event, Ended) for event in server.wait(60.0)):
        pass


def used(server):
    """Processor time of this process, the server and its children that have ended [s]."""
    stat = Path(f"/proc/{server.pid}/stat").read_text().rpartition(")")[2].split()
    return time.process_time() + sum(map(int, stat[11:15])) / TICK


def timed(server, file, **words):
    """Run a file's cases: wall and processor seconds a case."""
    suite = suite_of(file, **words)
    begin, used_before = time.perf_counter(), used(server)
    suite.collect(server)
    wall, processor = time.perf_counter() - begin, used(server) - used_before
    assert suite.outcome == "passed"
    return wall / len(suite.jobs), processor / len(suite.jobs)


def test_two_hundred_cases_of_a_pick(tmp_path, print_row):
    workers = 2
    with open_server() as server:
        wall, processor = timed(server, picks(tmp_path, 200), workers=workers)
    heading = f"200 cases of a pick, {workers} workers"
    print_row(heading, "wall", "cases a minute a core", "processor time a case")
    print_row(heading, f"{200 * wall:.0f} s", f"{60 / wall / workers:.1f}", f"{processor:.2f} s")


def test_what_a_second_core_gives(tmp_path, print_row):
    seconds = {1: [], 2: []}
    with open_server() as server:
        for _ in range(3):  # in turns, so that a busy machine slows both alike
            for workers, rows in seconds.items():
                rows.append(timed(server, picks(tmp_path, 10 * workers), workers=workers))
    one, two = (tuple(map(statistics.median, zip(*rows, strict=True))) for rows in seconds.values())
    heading = "a pick on one core and on two, medians of 3"
    print_row(heading, "workers", "wall a case", "processor time a case", "efficiency", "goal")
    print_row(heading, "1", f"{one[0]:.2f} s", f"{one[1]:.2f} s", "", "")
    print_row(
        heading, "2", f"{two[0]:.2f} s", f"{two[1]:.2f} s", f"{one[0] / 2 / two[0]:.2f}", "0.9"
    )


def test_what_isolation_costs_a_scenario(tmp_path, print_row):
    count = 60
    file = blinks(tmp_path, count)
    jobs = [each.job for each in planned_cases([file], SuiteRequest())]
    next(run_here(jobs[:1]))  # imports
    wall, processor = ({"nothing": [], "here": [], "apart": []} for _ in range(2))
    with open_server() as server:

        def measure(name, action):
            begin, used_before = time.perf_counter(), used(server)
            action()
            wall[name].append(time.perf_counter() - begin)
            processor[name].append(used(server) - used_before)

        for job in jobs:
            suite = SuiteRun(planned_cases([file], SuiteRequest(cases=[job.case])), SuiteRequest())
            measure("nothing", lambda: in_own_process(server))
            measure("here", lambda job=job: list(run_here([job])))
            measure("apart", lambda suite=suite: suite.collect(server))
            assert suite.outcome == "passed"
    heading = f"isolation, {count} times: wall the median, processor time the mean"
    print_row(heading, "", "wall", "processor time", "goal")
    for name, words in (("nothing", "a process that does nothing"),
                        ("here", "a scenario in this process"),
                        ("apart", "a scenario in its own")):  # fmt: skip
        print_row(heading, words, f"{1000 * statistics.median(wall[name]):.0f} ms",
             f"{1000 * statistics.mean(processor[name]):.0f} ms", "")  # fmt: skip
    costs = [
        1000 * (average(values["apart"]) - average(values["here"]))
        for average, values in ((statistics.median, wall), (statistics.mean, processor))
    ]
    print_row(heading, "isolation costs", *(f"{cost:.0f} ms" for cost in costs), "40 ms")


def collecting(folder, *options):
    """Wall and processor seconds of a pytest that collects a folder, and what it said."""
    command = [sys.executable, *options, "-m", "pytest", "--collect-only", "-q",
               "-p", "no:cacheprovider", "-p", "no:randomly", "--rootdir", str(folder)]  # fmt: skip
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.perf_counter()
    done = subprocess.run([*command, str(folder)], cwd=folder, capture_output=True, check=True)
    wall = time.perf_counter() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done


def test_collection_of_a_thousand_files(tmp_path, print_row):
    plain, thousand = tmp_path / "plain", tmp_path / "thousand"
    plain.mkdir()
    thousand.mkdir()
    (plain / "test_nothing.py").write_text("def test_nothing(): pass\n")
    for number in range(1000):
        (thousand / f"case{number}.scenario.yaml").write_text(PICK.read_text())
    folders = {"one test": plain, "1,000 scenarios": thousand}
    seconds = {name: [] for name in folders}
    for _ in range(5):
        for name, folder in folders.items():
            wall, processor, done = collecting(folder)
            seconds[name].append((wall, processor))
    assert b"1000 tests collected" in done.stdout
    _wall, _processor, done = collecting(thousand, "-X", "importtime")
    native = re.findall(rf"\| *({'|'.join(NATIVE)})$", done.stderr.decode(), re.MULTILINE)
    heading = "pytest --collect-only, medians of 5"
    print_row(heading, "files", "wall", "processor time", "native imports", "goal")
    for name, rows in seconds.items():
        wall, processor = map(statistics.median, zip(*rows, strict=True))
        ours = ("", "") if name == "one test" else (", ".join(native) or "none", "2 s")
        print_row(heading, name, f"{wall:.2f} s", f"{processor:.2f} s", *ours)


def resident(pid):
    """Memory of a process [MB]; nothing where it has ended."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0.0
    found = re.search(r"VmRSS:\s+(\d+)", status)
    return int(found[1]) / 1024 if found else 0.0


def test_memory_of_a_suite_of_two_thousand_samples(tmp_path, print_row):
    suite = suite_of(blinks(tmp_path, MARKS[-1]), workers=2)
    marks, largest = {}, 0.0
    with open_server() as server:

        def reported(_index, _result):
            nonlocal largest
            running = Path(f"/proc/{server.pid}/task/{server.pid}/children").read_text().split()
            largest = max(largest, *map(resident, running), 0.0)
            if len(suite.results) in MARKS:
                marks[len(suite.results)] = (resident(os.getpid()), resident(server.pid), largest)
                largest = 0.0

        suite.collect(server, on_result=reported)
    assert suite.outcome == "passed"
    heading = "memory over 2,000 samples, 2 workers"
    print_row(heading, "samples", "suite", "fork server", "largest case since the line above")
    for count, values in marks.items():
        print_row(heading, str(count), *(f"{value:.1f} MB" for value in values))


def test_memory_of_a_process_that_runs_two_thousand_samples(tmp_path, print_row):
    suite = suite_of(blinks(tmp_path, MARKS[-1]), in_process=True)
    marks = {}

    def reported(_index, _result):
        if len(suite.results) in MARKS:
            marks[len(suite.results)] = resident(os.getpid())

    suite.collect(WarmServer(), on_result=reported)
    assert suite.outcome == "passed"
    heading = "memory over 2,000 samples in one process"
    print_row(heading, "samples", "resident")
    for count, value in marks.items():
        print_row(heading, str(count), f"{value:.1f} MB")
