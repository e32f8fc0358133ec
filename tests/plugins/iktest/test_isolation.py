"""A function that hangs, or takes its process with it, is stopped, reported and shrunk."""

import contextlib
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from docs import ROOT
from harness.core.socket_folder import socket_parent
from harness.plugins.iktest import IkTest, run_ik_test, solver
from harness.plugins.iktest.contract import UnusableSolver
from harness.plugins.iktest.solver import PREFIX, Isolated
from harness.robot.robot_source import RobotSource
from tests.plugins.iktest.arms import EXAMPLES, OM
from tests.waiting import wait_for

HEAD = f"""
import os, sys
sys.path.insert(0, {str(EXAMPLES)!r})
from corrected_ik import ik as correct
def ik(x, y, z, pitch):
"""


def report_of(tmp_path, body, **options):
    """A quick test of a function in a file of its own."""
    file = tmp_path / "mine.py"
    file.write_text(HEAD + body)
    return run_ik_test(IkTest(f"{file}:ik", OM, examples=20, **options))


@pytest.mark.nightly
def test_a_function_that_hangs_is_stopped_and_the_rest_is_not_tried(tmp_path):
    body = "    while y > 0.1: pass\n    return correct(x, y, z, pitch)\n"
    report = report_of(tmp_path, body, patience=0.5)
    [finding] = report.findings
    assert finding.kind == "does not come back"
    assert finding.detail == "no answer in 0.5 s of processor time"
    assert finding.target.pose.translation[1] > 0.1
    notes = [each.note for each in report.properties]
    assert notes[0] == ""
    assert notes[-1] == "not tried: it does not come back"
    assert not report.has_passed


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize("where", ["True", "z < 9"])
def test_a_function_that_always_hangs_costs_a_few_calls(tmp_path, where):
    report = report_of(tmp_path, f"    while {where}: pass\n", patience=0.1)
    assert [finding.kind for finding in report.findings] == ["does not come back"]
    assert report.properties[0].tried == 1
    assert [each.note for each in report.properties[2:]] == ["not tried: it does not come back"] * 5


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize("end", ["os.abort()", "os._exit(0)", "os.kill(os.getpid(), 9)"])
def test_a_function_that_always_ends_its_process_costs_a_few_calls(tmp_path, end):
    body = f"    with open({str(tmp_path / 'calls')!r}, 'a') as file:\n        file.write('1')\n"
    report = report_of(tmp_path, f"{body}    {end}\n")
    assert [finding.kind for finding in report.findings] == ["ends the process"]
    assert len((tmp_path / "calls").read_text()) <= 10
    assert [each.note for each in report.properties[2:]] == ["not tried: it ends the process"] * 5


DELAYS = """
import time
import numpy as np
def compute():
    while True: pass
def ik(x, y, z):
    [compute, lambda: np.linalg.svd(np.zeros((3000, 3000))), lambda: time.sleep(6000),
     lambda: time.sleep(0.4)][x]()
"""
DELAYED = ("compute", "matrix", "sleep", "doze")


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("calls", "waiting_limit", "texts"),
    [
        (("compute", "matrix"), 1000.0, ["no answer in 0.3 s of processor time"] * 2),
        (("sleep", "doze"), 10.0, ["no answer in 3 s", ""]),
    ],
)
def test_processor_time_decides_what_hangs_unless_it_waits_much_longer(
    tmp_path, monkeypatch, calls, waiting_limit, texts
):
    monkeypatch.setattr(solver, "WAITING_LIMIT", waiting_limit)
    (tmp_path / "mine.py").write_text(DELAYS)
    isolated = Isolated(f"{tmp_path / 'mine.py'}:ik", RobotSource(OM), "", 4, patience=0.3)
    try:
        outcomes = [isolated({"x": DELAYED.index(x), "y": 0.0, "z": 0.0}) for x in calls]
    finally:
        isolated.close()
    assert [each.text for each in outcomes] == texts
    assert [each.kind for each in outcomes] == ["hung" if text else "refused" for text in texts]


@pytest.mark.nightly
def test_a_function_that_kills_its_process_is_reported_and_shrunk(tmp_path):
    body = "    if z < 0: os.kill(os.getpid(), 11)\n    return correct(x, y, z, pitch)\n"
    report = report_of(tmp_path, body)
    [finding] = report.findings
    assert finding.property == "answers"
    assert finding.kind == "ends the process"
    assert finding.detail == "the process was killed by SIGSEGV at mine.py:6"
    assert -0.02 < finding.target.pose.translation[2] < 0


@pytest.mark.nightly
def test_what_it_prints_and_an_exit_do_no_harm(tmp_path, capfd):
    body = (
        "    print('x', flush=True)\n    if x < 0: os._exit(3)\n    return correct(x, y, z, pitch)"
    )
    report = report_of(tmp_path, body)
    assert report.findings[0].detail == "the process ended with exit code 3"
    assert capfd.readouterr().out == ""


def test_a_file_that_ends_its_process_while_imported_is_refused(tmp_path):
    (tmp_path / "mine.py").write_text("import os\nos._exit(4)\n")
    with pytest.raises(UnusableSolver, match=r"ended while '.*mine\.py:ik' was imported.*code 4"):
        run_ik_test(IkTest(f"{tmp_path / 'mine.py'}:ik", OM))


@pytest.mark.nightly
def test_nothing_outlives_a_test_that_is_killed(tmp_path):
    (tmp_path / "mine.py").write_text("import time\ndef ik(x, y, z): time.sleep(1000)\n")
    arguments = ["ik-test", "mine.py:ik", "--robot", OM, "--call-limit", "500", "--no-report"]
    command = f"from harness.cli.main import main; main({arguments})"
    child = subprocess.Popen(
        [sys.executable, "-c", command],
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT)},
    )
    wait_for(lambda: len(processes_in(tmp_path)) >= 3)  # command, fork server, the function's
    child.kill()
    child.wait()
    wait_for(lambda: not processes_in(tmp_path))
    left = [*socket_parent().glob(f"{PREFIX}{child.pid}-*")]
    assert len(left) == 1
    with pytest.raises(UnusableSolver):  # the next test removes the folder of the killed one
        run_ik_test(IkTest("no_such_module:ik", OM))
    assert not left[0].exists()


def test_a_function_is_called_where_paths_of_temporary_files_are_long(tmp_path, monkeypatch):
    deep = tmp_path / ("d" * 90)
    deep.mkdir()
    (tmp_path / "mine.py").write_text("import os\nos._exit(4)\n")
    monkeypatch.setattr(tempfile, "tempdir", str(deep))
    with pytest.raises(UnusableSolver, match="ended while"):
        run_ik_test(IkTest(f"{tmp_path / 'mine.py'}:ik", OM))


def processes_in(folder):
    """Processes whose working folder this is."""
    found = set()
    for link in Path("/proc").glob("[0-9]*/cwd"):
        with contextlib.suppress(OSError):  # another's, or gone
            if link.readlink() == folder:
                found.add(link.parent.name)
    return found
