"""Distances that are measured while a run goes on are those that are measured after it."""

import os
import subprocess
import sys

from tests.engine.front_door import file_of

STEPS = """
- move_to: {joints: {joint1: 1.2}}
- wait: 5 s
- add_object: {name: post, box: {size: [0.02, 0.02, 0.1]}, pose: {xyz: [0.0, -0.2, 0.05]}}
- move_to: {joints: {joint1: -0.6}}
- wait: 5 s
"""
PROGRAM = """
import sys, threading
from pathlib import Path
from harness.session import run_case
from harness.session.run_request import RunRequest
if sys.argv[2] == "after":
    threading.Thread(target=threading.Event().wait, daemon=True).start()
forked = []
fork = run_case.DistancesAhead.look
def look(self, *arguments):
    fork(self, *arguments)
    forked.append(self._background is not None)
run_case.DistancesAhead.look = look
result = run_case.run_case(RunRequest(Path(sys.argv[1])))
print(result.outcome, result.digest, any(forked))
"""


def run(path, when):
    """Outcome, digest, and whether another process measured distances; a thread prevents that."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(path), when],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    return done.stdout.split()


def test_the_digest_is_the_same_whichever_process_measures_distances(tmp_path):
    rest = "expect: [{clearance: {between: [robot, post], at_least: 1 mm}}]"
    path = file_of(tmp_path, STEPS, robot="open_manipulator_x", rest=rest)
    ahead, after = run(path, "ahead"), run(path, "after")
    assert ahead[0] == after[0] == "passed"
    assert ahead[1] == after[1]
    assert (ahead[2], after[2]) == ("True", "False")
