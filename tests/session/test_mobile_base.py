"""A base that stands elsewhere from case to case, as a mobile one: what it picks stays."""

from itertools import pairwise

import numpy as np
import pytest

from harness.cli.main import main
from harness.recording.read_run import read_run

SCENARIO = """
scenario: a base elsewhere
robot: {model: ur5e, gripper: rh_p12_rn_a}
objects:
  - {name: box, box: {size: [4 cm, 4 cm, 8 cm]}, mass: 0.2, pose: {xyz: [0.5, 0.1, 0.04]}}
steps:
  - pick: box
expect:
  - lifted: {object: box, above: 5 cm}
  - grasped: box
  - never: collision
parametrize:
  - {id: in_front, robot.base: {xyz: [0, 0, 0]}}
  - {id: from_the_side, robot.base: {xyz: [0.4, -0.45, 0], rpy: [0, 0, 90 deg]}}
  - {id: too_far, robot.base: {xyz: [-1, 0, 0]}}
"""


@pytest.mark.nightly
def test_a_base_that_stands_elsewhere_picks_what_it_reaches_from_there(tmp_path, capsys):
    file = tmp_path / "base.scenario.yaml"
    file.write_text(SCENARIO, encoding="utf-8")
    assert main(["run", str(file), "--no-page", "--report-dir", str(tmp_path / "reports")]) == 1
    said = capsys.readouterr().out
    assert "1 failed, 2 passed of 3 cases" in said
    assert "NO_IK_SOLUTION" in said
    runs = [read_run(each.parent).run for each in sorted((tmp_path / "reports").rglob("run.json"))]
    assert len(runs) == 3
    starts = [run.signals.tcp_pose[0, :3] for run in runs]
    assert min(np.linalg.norm(a - b) for a, b in pairwise(starts)) > 0.3
    ends = [run.signals.object_poses["box"][-1, :2] for run in runs]
    assert ends == [pytest.approx([0.5, 0.1], abs=5e-3)] * 3
