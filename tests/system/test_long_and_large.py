"""Suites, worlds, recordings and merges that are far larger than those of a day's work."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness.plugins.grading.grade import grade_bag
from tests.benchmarks.test_campaigns import parts_of
from tests.gate import PLUGIN, Gate
from tests.plugins.grading.hand_made import SCENARIO
from tests.plugins.grading.test_large_bags import RATE, bag_of, joint_states, one
from tests.reporting import browser
from tests.running import run_case
from tests.suite.ball import ball

HOUR = 3600.0  # [s]
PAGE_OF_A_CASE = 4e3  # memory that the suite's page takes for each row while it is written [bytes]


class Watched:
    """A suite in a process of its own, and what it holds while its cases wait at a gate."""

    def __init__(self, folder, text):
        self.folder, self.temporary, self.gate = folder, folder / "temporary", Gate(folder)
        self.temporary.mkdir()
        (folder / "a.scenario.yaml").write_text(text.replace("STEP", self.gate.step))
        words = ["a.scenario.yaml", "--no-page", "--format", "short", "--report-dir", "reports"]
        with (folder / "said").open("w") as said:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "harness.cli", "run", *words, *PLUGIN],
                cwd=folder, env={**os.environ, "TMPDIR": str(self.temporary)}, stdout=said,
            )  # fmt: skip

    def at(self, count):
        """Memory [bytes] and number of open files when that many cases have ended."""
        self.gate.let_pass(count)
        stream = self.folder / "reports/results.jsonl"
        while self.gate.arrived <= count or stream.read_bytes().count(b'"result"') < count:
            assert self._process.poll() is None
            time.sleep(0.1)
        pid = self._process.pid
        status = Path(f"/proc/{pid}/status").read_text()
        resident = 1024 * int(status.partition("VmRSS:")[2].split()[0])
        return resident, len(os.listdir(f"/proc/{pid}/fd"))  # noqa: PTH208 - only their number

    def end(self, count):
        self.gate.let_pass(count)
        return self._process.wait()


@pytest.mark.nightly
@pytest.mark.parametrize("count", [12, 10_000])
def test_a_suite_of_many_cases_is_flat_in_memory_handles_and_files(count, tmp_path):
    text = ball(count, farthest="25 cm").replace("wait: 2 ms", "STEP")
    suite = Watched(tmp_path, text)
    memory, files = suite.at(count // 4)
    later, files_later = suite.at(count * 3 // 4)
    assert files_later <= files + 4
    assert later - memory < 20e6 + PAGE_OF_A_CASE * count
    assert suite.end(count) == 0
    assert f"{count} cases passed" in (tmp_path / "said").read_text()
    assert not list(suite.temporary.iterdir())
    assert [each.name for each in (tmp_path / "reports").glob(".*")] == []


@pytest.mark.nightly
@pytest.mark.parametrize("count", [60, 500])
def test_a_world_of_many_objects_is_run_and_judged(count, tmp_path):
    rows = []
    for number in range(count):
        x, y = 0.5 + 0.1 * (number % 20), 0.1 * (number // 20)
        pose = f"{{xyz: [{x:.1f}, {y:.1f}, 0.02]}}"
        rows.append(f"  - {{name: b{number}, box: {{size: [4 cm, 4 cm, 4 cm]}}, pose: {pose}}}\n")
    file = tmp_path / "many.scenario.yaml"
    file.write_text(
        "scenario: many objects\nrobot: open_manipulator_x\nobjects:\n" + "".join(rows)
        + "steps: [{move_to: {joints: {joint1: 0.5}}}]\n"
        "expect: [{never: collision}, {always: within_limits}]\n"
    )  # fmt: skip
    result = run_case(file, report_dir=tmp_path / "run")
    assert result.outcome == "passed", result.message
    assert (tmp_path / "run/report.html").stat().st_size < 20e6


@pytest.mark.nightly
@pytest.mark.parametrize("seconds", [30, HOUR])
def test_the_page_of_a_long_recording_opens(seconds, tmp_path, visit):
    file = tmp_path / "long.scenario.yaml"
    file.write_text(SCENARIO + "  - eventually: {joints: {positions: {joint1: 0.1}}}\n")
    every = 5 if seconds == HOUR else 1  # 100 Hz, as robots of an hour publish
    bag = bag_of(tmp_path / "long.db3", list(joint_states(int(RATE * seconds), one))[::every])
    grade_bag(file, bag, report_dir=tmp_path / "run")
    seen = visit(tmp_path / "run/report.html", has_scene=True)
    browser.wait_for(seen.page, "document.querySelector('#track') !== null")
    end = float(seen.page.get_attribute("#track", "aria-valuemax"))
    assert end == pytest.approx(seconds, rel=0.01)
    assert not seen.complaints


@pytest.mark.nightly
@pytest.mark.parametrize("parts", [3, 100])
def test_many_shards_are_merged(parts, tmp_path):
    count = 100 * parts
    command = [sys.executable, "-m", "harness.cli", "merge", *parts_of(tmp_path, count, parts)]
    subprocess.run([*map(str, command), "--report-dir", "all"], cwd=tmp_path, check=False)
    cases = json.loads((tmp_path / "all/results.json").read_text())["cases"]
    assert len(cases) == len({each["case"] for each in cases}) == count


@pytest.mark.nightly
def test_two_hours_of_simulated_time_are_twelve_runs_of_the_longest(tmp_path):
    """One run may have ten minutes; the record of each ends with its process."""
    text = (
        "scenario: ten minutes\nrobot: open_manipulator_x\nsamples: 12\nparams: {angle: 0.1}\n"
        "randomize: {angle: {uniform: [0, 0.2]}}\n"
        "steps: [{STEP}, {move_to: {joints: {joint1: '${angle}'}}}, {wait: 590 s}]\n"
        "expect: [{always: within_limits}]\n"
    )
    suite = Watched(tmp_path, text)
    memory, _ = suite.at(1)
    later, _ = suite.at(11)
    assert later - memory < 20e6
    assert suite.end(12) == 0
