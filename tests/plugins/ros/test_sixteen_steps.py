"""An rclpy node sends the trajectories of the lesson's sixteen steps to the UR3e's controllers."""

import json
from pathlib import Path

import pytest

from harness.cli.main import main
from harness.core.resources import data_folder
from harness.plugins.ros.handover import replay
from harness.recording.read_run import read_run
from tests.plugins.ros.bridging import PYTHON, require_control_msgs
from tests.running import run_case

LESSON = data_folder("scenarios") / "lessons/03_ur_sixteen_steps.scenario.yaml"
NODE = Path(__file__).parent / "student/sixteen_steps.py"


def motions_of(run):
    """The arm's trajectories and the gripper's targets of a run, in order."""
    motions = []
    for step in run.steps:
        if step.verb == "gripper":
            motions.append({"gripper": float(step.result.plain()["target"])})
        elif step.trajectory is not None:
            times, positions, velocities = (
                getattr(step.trajectory, key).tolist()
                for key in ("times", "positions", "velocities")
            )
            velocities[-1] = [0.0] * len(velocities[-1])
            points = list(zip(times, positions, velocities, strict=True))
            names = list(step.trajectory.joint_names)
            motions.append({"joint_names": names, "points": points})
    return motions


@pytest.mark.needs_ros
def test_the_sixteen_steps_earn_every_point_and_replay(tmp_path):
    require_control_msgs()
    planned = run_case(LESSON, report_dir=tmp_path / "planned", stills=False, page=False)
    assert planned.outcome == "passed"
    data = tmp_path / "motions.json"
    data.write_text(json.dumps(motions_of(read_run(tmp_path / "planned").run)))
    command = ["--node", f"{PYTHON} {NODE} {data}", "--report-dir", str(tmp_path / "r")]
    assert main(["grade", "ros2/02_sixteen_steps", *command]) == 0
    [record] = (tmp_path / "r").rglob("run.json")
    stored = read_run(record.parent)
    assert replay(record.parent).digest == stored.digest
