"""Large campaigns: merging parts, memory, and cases on Ray next to cases on this machine."""

import json
import os
import resource
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from harness.core.lazy import LazySequence
from harness.plugins.campaigns.cluster.batch import BatchResult
from harness.plugins.campaigns.shards import Shard
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.header import read_header
from harness.suite.hooks import SuiteHooks
from harness.suite.plan import cases_of, planned_cases
from harness.suite.request import SuiteRequest
from harness.suite.stream import Stream, StreamEntry, read_line
from harness.suite.suite_run import SuiteRun
from harness.suite.warm import WarmServer
from tests.benchmarks.test_suites import picks
from tests.suite.ball import ball

pytestmark = pytest.mark.benchmark

PARTS = 2


def command(folder, *words):
    """Processor time [s] and peak memory [MB] of a command."""
    process = subprocess.Popen(
        [sys.executable, "-m", "harness.cli", *map(str, words)],
        cwd=folder, stdout=subprocess.DEVNULL,
    )  # fmt: skip
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode in (0, 1)
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def parts_of(folder, count, parts=PARTS):
    """Report folders of parts with that many results, each a copy of one that was computed."""
    (folder / "ball.scenario.yaml").write_text(ball(2))
    command(folder, "run", "ball.scenario.yaml", "--shard", "1/1", "--report-dir", "one")
    lines = (folder / "one/results.jsonl").read_bytes().splitlines(keepends=True)
    line = next(each for each in lines if b'"result"' in each)
    entry = read_line(line, StreamEntry)
    record = json.loads((folder / "one/shard.json").read_text())
    streams = []
    for number in range(1, parts + 1):
        root = folder / f"{count}/{number}"
        streams.append(Stream(root))
        selection = {**record["selection"], "samples": count}
        part = {"shard": {"number": number, "count": parts}, "root": str(root)}
        part |= {"selection": selection}
        (root / "shard.json").write_text(json.dumps({**record, **part}))
    header = read_header(folder / "ball.scenario.yaml")
    plan = cases_of([(Path("ball.scenario.yaml"), header)], SuiteRequest(samples=count))
    for planned, number in zip(plan, Shard(1, parts).numbers_of(plan), strict=True):
        case = planned.of.cases[planned.position]
        stream = streams[number - 1]
        result = replace(entry.result, case=case.name, seed=int(case.overrides["seed"]))
        stream.append(StreamEntry(f"{entry.key}{case.name}", result, case.values).line)
    return [folder / f"{count}/{number}" for number in range(1, parts + 1)]


def test_a_merge_of_many_results(tmp_path, print_row):
    heading = "harness merge and harness results"
    print_row(heading, "results", "merge", "peak", "page", "query", "peak", "goal")
    for count in (1_000, 10_000, 100_000):
        target = tmp_path / f"merged{count}"
        merged, most = command(
            tmp_path, "merge", *parts_of(tmp_path, count), "--report-dir", target
        )  # fmt: skip
        page = (target / "index.html").stat().st_size / 1e6
        queried, most_of_query = command(tmp_path, "results", target)
        print_row(
            heading, str(count), f"{merged:.1f} s", f"{most:.0f} MB", f"{page:.1f} MB",
            f"{queried:.1f} s", f"{most_of_query:.0f} MB", "10 s, 5 MB" if count > 10_000 else "",
        )  # fmt: skip


def trivial(batch, _files):
    """A batch of cases that do nothing."""
    results = [
        (index, CaseResult(str(job.file), job.case, "t", "passed"), b"")
        for index, job in batch.cases
    ]
    return BatchResult(tuple(results), "", "", 0.01)


@pytest.mark.needs_cluster
def test_the_memory_of_a_driver_does_not_grow_with_the_number_of_cases(tmp_path, print_row):
    from harness.plugins.campaigns.cluster.ray_cluster import RayCluster

    count, heading = 100_000, "memory of the driver of a Ray cluster"
    print_row(heading, "cases done", "resident memory")
    jobs = LazySequence(
        count,
        lambda index: RunRequest(Path("a.scenario.yaml"), {"x": str(index)}, case=f"c{index}"),
    )
    stream = Stream(tmp_path)
    for number, (index, result) in enumerate(
        RayCluster(jobs, function=trivial).run("ray", 2, []), start=1
    ):
        stream.write(jobs[index], result)
        if number in (1_000, 10_000, count):
            pages = int(Path("/proc/self/statm").read_text().split()[1])
            memory = pages * resource.getpagesize() / 1e6
            print_row(heading, str(number), f"{memory:.0f} MB")


def on_ray(jobs, files, is_needless):
    """Run cases on two processes of Ray."""
    from harness.plugins.campaigns.cluster.ray_cluster import RayCluster

    return RayCluster(jobs, is_needless=is_needless).run("ray", 2, files)


@pytest.mark.needs_cluster
def test_what_ray_costs_a_case(tmp_path, print_row):
    """In turns, so that a busy machine slows both alike; the cluster's start does not count."""
    heading = "24 picks with two processes, in turns"
    print_row(heading, "", "wall a case", "cases", "goal")
    file = picks(tmp_path, 24)
    seconds = {"": [], "ray": []}
    for _ in range(2):
        for cluster, rows in seconds.items():
            hooks = SuiteHooks(execute=on_ray if cluster else None)
            suite = SuiteRun(
                planned_cases([file], SuiteRequest()), SuiteRequest(workers=2, hooks=hooks)
            )
            ends = []
            with WarmServer() as server:
                suite.collect(server, on_result=lambda *_, ends=ends: ends.append(time.monotonic()))
            rows.append((ends[-1] - ends[3]) / (len(ends) - 4))
    local, ray = min(seconds[""]), min(seconds["ray"])
    print_row(heading, "this machine", f"{local:.2f} s", "24", "")
    print_row(heading, "Ray", f"{ray:.2f} s", "24", "")
    print_row(heading, "efficiency", f"{local / ray:.2f}", "", "0.85")
