"""A node sends the trajectories of the lesson's sixteen steps to the UR3e's controllers."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import main
from harness.core.resources import data_folder
from harness.recording.store import read_run
from harness.ros.replay import replay
from tests.running import run_case

LESSON = data_folder("scenarios") / "lessons/03_ur_sixteen_steps.scenario.yaml"
NODE = """
import os
import numpy as np
from tests.ros.nodes import GRIPPER, Node, follow, grip, message, point
node = Node(int(os.environ["ROS_DOMAIN_ID"]), "joint_trajectory_controller")
node.ready()
data = np.load(os.environ["TRAJECTORIES"])
for name in data["order"]:
    if name.startswith("gripper"):
        assert node.send(grip(float(data[name]), 0.0), node.gripper).is_accepted
        continue
    joints = [str(joint) for joint in data[name + "_joints"]]
    rows = zip(data[name + "_t"], data[name + "_q"], data[name + "_v"])
    result = node.send(follow(*(point(*row) for row in rows), joints=joints)).result
    assert result.error_code == 0, result.error_string
node.sleep(60)
"""


def trajectories_of(run, file):
    """The arm's trajectories and the gripper's targets of a run, in order."""
    arrays, order = {}, []
    for number, step in enumerate(run.steps):
        name = f"{step.verb}{number}"
        if step.verb == "gripper":
            arrays[name] = step.result.plain()["target"]
        elif step.trajectory is not None:
            arrays[f"{name}_joints"] = np.array(step.trajectory["joint_names"])
            arrays[f"{name}_t"] = step.trajectory["times"]
            arrays[f"{name}_q"] = step.trajectory["positions"]
            speeds = step.trajectory["velocities"].copy()
            speeds[-1] = 0.0
            arrays[f"{name}_v"] = speeds
        else:
            continue
        order.append(name)
    np.savez(file, order=np.array(order), **arrays)


@pytest.mark.ros
def test_the_sixteen_steps_earn_every_point_and_replay(tmp_path, monkeypatch):
    planned = run_case(LESSON, report_dir=tmp_path / "planned", stills=False, page=False)
    assert planned.outcome == "passed"
    trajectories_of(read_run(tmp_path / "planned").run, tmp_path / "data.npz")
    node = tmp_path / "node.py"
    node.write_text(NODE)
    monkeypatch.setenv("TRAJECTORIES", str(tmp_path / "data.npz"))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(Path(__file__).parents[2])]))
    command = [*("--node", f"{sys.executable} {node}"), "--report-dir", str(tmp_path / "r")]
    assert main(["grade", "ros2/02_sixteen_steps", *command]) == 0
    [record] = (tmp_path / "r").rglob("run.json")
    stored = read_run(record.parent)
    assert replay(record.parent).digest == stored.digest
