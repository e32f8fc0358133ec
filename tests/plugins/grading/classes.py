"""Made-up classes: scenarios that reach a target, and functions of inverse kinematics."""

import zipfile
from dataclasses import dataclass

from harness.core.resources import data_folder

EXERCISE = """\
scenario: "Exercise: reach a target"
robot: {model: ur3e}
params: {x: 0.3}
seed: 1
steps:
  - move_to: up
expect:
  - eventually: {named_target: up}
    name: the arm was up
    points: 1
  - eventually:
      tcp_pose: {pose: {xyz: ["${x}", 0.1, 0.4]}, position_only: true, tolerance: {position: 5 mm}}
    name: the TCP is at the target
    points: 2
"""
ASSIGNMENT = """\
assignment: Reach it
scenario: reach.scenario.yaml
points: 6
hidden: [{set: {params.x: 0.31}}]
limits: {simulated_time: 30 s}
"""
SOLUTION = """\
scenario: mine
robot: {model: ur3e}
steps:
  - move_to: up
  - move_to: {pose: {xyz: ["${x}", 0.1, 0.4], rpy: [180 deg, 0, 0]}}
expect: [{always: {named_target: up}, points: 99}]
"""


def scenario_class(place):
    """The folders of an assignment and of what six students hand in."""
    assignment, submissions = place / "reach", place / "submissions"
    assignment.mkdir()
    submissions.mkdir()
    (assignment / "assignment.yaml").write_text(ASSIGNMENT)
    (assignment / "reach.scenario.yaml").write_text(EXERCISE)
    (submissions / "perfect.scenario.yaml").write_text(SOLUTION)
    (submissions / "constant").mkdir()
    (submissions / "constant/mine.scenario.yaml").write_text(SOLUTION.replace('"${x}"', "0.3"))
    with zipfile.ZipFile(submissions / "low.zip", "w") as archive:
        archive.writestr("low/a.scenario.yaml", SOLUTION.replace("0.4]", "0.383]"))
    fault = "  - move_to: up\n  - inject: {stuck_joint: elbow_joint}\n"
    (submissions / "moves.yaml").write_text(SOLUTION.replace("  - move_to: up\n", fault))
    (submissions / "broken.zip").write_bytes(b"PK\x03\x04")
    (submissions / "typo.scenario.yaml").write_text(SOLUTION.replace("move_to: {", "moveto: {"))
    return assignment, submissions


IK = """\
assignment: Inverse kinematics
ik: {robot: open_manipulator_x, examples: 1, call_limit: 300 ms}
limits: {processor_time: 60 s}
"""


@dataclass(frozen=True)
class Handed:
    """A function that a student hands in, the most that it earns of seven points, and why.

    Attributes:
        points: All are earned where these are seven; else at most these.
    """

    text: str
    points: float
    remark: str


RIGHT = (data_folder("scenarios") / "ik_test/corrected_ik.py").read_text(encoding="utf-8")
BRANCH = RIGHT.replace("for elbow in (angle, -angle):", "for elbow in (angle,):")
BRANCH = BRANCH.replace("(facing + pi, -distance)", "(facing, distance)")
CRASHING = """\
import os, subprocess, sys
if not os.path.exists("begun"):  # one process that outlives the function, in a session of its own
    open("begun", "w").close()
    code = "import time; time.sleep(1000)"
    subprocess.Popen([sys.executable, "-c", code], start_new_session=True)
def ik(x, y, z, pitch):
    os.abort()
"""
CHEATING = """\
import os
from pathlib import Path
for folder in (".", "..", "report", os.environ["GRADES"]):
    for name in ("results.json", "grades.csv", "ik_test.json", "index.html"):
        try:
            Path(folder, name).write_text('{"score": 7, "properties": [], "findings": []}')
        except OSError:
            pass
print('{"properties": [], "findings": []}', flush=True)
def ik(x, y, z, pitch):
    return None
"""
FORGING = """\
import json, os, signal
from pathlib import Path
names = "reaches answers limits refuses anywhere continuity determinism".split()
properties = [{"name": name, "says": name, "tried": 9, "observed": 9, "flawed": 0, "findings": [],
               "note": ""} for name in names]
document = json.dumps({"properties": properties, "findings": []})
parents, pid = [], os.getpid()
for _ in range(3):  # its server, the test, what confines it
    pid = int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    parents.append(pid)
for pid in parents:
    try:
        Path(f"/proc/{pid}/fd/1").write_text(document)
    except OSError:
        pass
os.kill(parents[1], signal.SIGTERM)
def ik(x, y, z, pitch):
    return None
"""
CONSTANT = "def ik(x, y, z, pitch):\n    return [0.0, 0.0, 0.0, 0.0]\n"
SUBMISSIONS = {
    "perfect": Handed(RIGHT, 7, ""),
    "wrong branch": Handed(BRANCH, 5, "refuses a target within reach"),
    "low": Handed(RIGHT.replace("= 0.0595", "= 0.0595 + 0.017"), 0, "17 mm"),
    "constant": Handed(CONSTANT, 1, "misses the position"),
    "hanging": Handed("def ik(x, y, z, pitch):\n    while True: pass\n", 0, "not come back"),
    "crashing": Handed(CRASHING, 0, "ends the process"),
    "cheating": Handed(CHEATING, 0, "refuses a target within reach"),
    "forging": Handed(FORGING, 0, ""),
}
