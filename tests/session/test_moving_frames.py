"""Goals in the frame of an object that a belt carries are met when the arm arrives."""

import numpy as np
import pytest

from harness.recording.read_run import read_run
from tests.running import run_case

TEXT = """scenario: over a can on a belt
robot: open_manipulator_x
objects:
  - {name: belt, static: true, box: {size: [0.8, 0.1, 0.02]}, pose: {xyz: [0, 0.2, 0.01]},
     %s}
  - {name: can, cylinder: {radius: 1.5 cm, length: 5 cm}, mass: 0.05, friction: 0.6,
     pose: {xyz: [%s, %s, 0.045]}}
steps:
  - wait: 0.5
  - %s
"""
OVER = "move_to: {position: {frame: can, xyz: [0, 0, 0.06]}, pitch: 60 deg}"


def run(folder, motion="surface_velocity: 4 cm/s", x=-0.15, y=0.2, step=OVER):
    path = folder / "a.scenario.yaml"
    path.write_text(TEXT % (motion, x, y, step), encoding="utf-8")
    run_case(path, report_dir=folder / "run", stills=False, page=False)
    return read_run(folder / "run").run


def miss(run):
    """How far the TCP is at the end from 6 cm above the can [m], and how far the can moved."""
    poses = run.signals.object_poses["can"]
    end = run.steps[-1].end_index - 1
    above = poses[end, :3] + np.array([0, 0, 0.06])
    return np.linalg.norm(run.signals.tcp_pose[end, :3] - above), poses[end, 0] - poses[0, 0]


@pytest.mark.parametrize("motion", ["surface_velocity: 4 cm/s", "surface_velocity: 0"])
def test_the_tool_is_over_the_object_when_it_arrives(motion, tmp_path):
    recorded = run(tmp_path, motion)
    assert recorded.steps[-1].status == "passed"
    off, way = miss(recorded)
    assert off < 3e-3
    assert (way > 0.04) == ("4" in motion)


def test_an_object_that_is_not_within_reach_yet_is_awaited(tmp_path):
    recorded = run(tmp_path, "surface_velocity: 10 cm/s", x=-0.38)
    assert recorded.steps[-1].status == "passed"
    assert miss(recorded)[0] < 5e-3


def test_an_object_that_leaves_the_belt_is_missed_with_the_time(tmp_path):
    step = run(tmp_path, "surface_velocity: 12 cm/s", x=0.3).steps[-1]
    assert step.status == "failed"
    assert "'can' leaves 'belt' in " in step.message


def test_a_gripper_closes_on_the_way(tmp_path):
    recorded = run(tmp_path, step=f"parallel: [{{gripper: closed}}, {{{OVER}}}]")
    assert recorded.steps[1].status == "passed"
    assert miss(recorded)[0] < 3e-3
