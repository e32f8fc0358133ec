"""Pictures are drawn by another process, so that what breaks a graphics library costs no run."""

import os
import subprocess
import sys

import pytest

from tests.session.front_door import file_of

PROGRAM = """
import sys
from pathlib import Path
from harness.session import run_case as session
from harness.session.background import Background
from harness.session.run_request import RunRequest

begun, begin = [], Background.__init__

def noted(background, *arguments):
    begin(background, *arguments)
    begun.append(background._pid > 0)

Background.__init__ = noted
folder = Path(sys.argv[1]).parent / "run"
request = RunRequest(Path(sys.argv[1]), report_dir=folder, only_failed=True, page=False)
print(session.run_case(request).outcome, begun, len(list((folder / "images").iterdir())))
"""


def first_line(program, file):
    """What a program without threads, which can be forked, prints of a scenario."""
    done = subprocess.run(
        [sys.executable, "-c", program, str(file)],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    return done.stdout.split("\n")[0]


@pytest.mark.nightly
def test_a_run_that_is_kept_because_it_failed_is_drawn_by_another_process(tmp_path):
    rest = "expect: [{joints: {positions: {joint1: 0.25}, tolerance: 0.01}}]"
    steps = "- ptp: {joints: {joint1: 0.5}}"
    file = file_of(tmp_path, steps, robot="open_manipulator_x", rest=rest)
    assert first_line(PROGRAM, file) == "failed [True] 1"


APART_OR_HERE = """
import sys
from pathlib import Path
from threading import Event, Thread
from harness.session import run_case as session
from harness.session.run_request import RunRequest

found = []
for name in ("apart", "here"):
    folder = Path(sys.argv[1]).parent / name
    session.run_case(RunRequest(Path(sys.argv[1]), report_dir=folder, page=False))
    found.append({file.name: file.read_bytes() for file in (folder / "images").iterdir()})
    Thread(target=Event().wait, daemon=True).start()
print(len(found[0]), found[0] == found[1])
"""


@pytest.mark.nightly
def test_pictures_are_the_same_from_another_process_and_from_the_one_of_the_run(tmp_path):
    steps = "- ptp: {joints: {joint1: 0.5}}\n- ptp: {joints: {joint1: 0.1}}"
    file = file_of(tmp_path, steps, robot="open_manipulator_x", rest="")
    assert first_line(APART_OR_HERE, file) == "2 True"
