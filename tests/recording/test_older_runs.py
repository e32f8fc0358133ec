"""Runs that earlier versions of the program wrote are read, judged and reported as they were."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import main
from harness.core.errors import HarnessError
from harness.language.scenario import RobotSpec
from harness.recording.digest import digest
from harness.recording.link_poses import replayed_link_poses
from harness.recording.plain import to_plain
from harness.recording.read_run import read_run
from harness.recording.write_run import write_run
from harness.robot.load import load_robot

FORMAT_2 = Path(__file__).parent / "older_runs" / "format_2"
"""A gripper closes: written by the last version with `armharness-run/2`."""


def test_a_run_of_the_second_format_is_the_run_that_was_written():
    stored = read_run(FORMAT_2)
    assert not stored.changes()
    assert stored.digest == digest(stored.run, stored.verdicts)
    assert [verdict.status for verdict in stored.verdicts] == ["passed"]


def test_its_robot_moves_as_the_description_does():
    old = read_run(FORMAT_2).run
    new = load_robot(RobotSpec(gripper="rh_p12_rn_a"))
    rows = old.signals.joint_positions[::200]
    poses, expected = (replayed_link_poses(robot, rows) for robot in (old.robot, new))
    assert poses.keys() == expected.keys()
    for name, each in poses.items():
        np.testing.assert_allclose(each, expected[name], atol=1e-12)
    for name in ("joint_names", "static_links", "shapeless_links", "arm_joints", "link_names"):
        assert getattr(old.robot, name) == getattr(new, name)
    assert to_plain(old.robot.link_visuals) == to_plain(new.link_visuals)
    for one, other in zip(old.robot.movable_joints, new.movable_joints, strict=True):
        for name in ("name", "kind", "lower", "upper", "velocity", "acceleration", "is_mimic"):
            assert getattr(one, name) == getattr(other, name)
    assert old.robot.gripper.sides == new.gripper.sides
    assert old.robot.states_of("gripper").keys() == new.states_of("gripper").keys()


def test_it_is_judged_and_reported_again(tmp_path, capsys):
    folder = tmp_path / "run"
    shutil.copytree(FORMAT_2, folder)
    assert main(["judge", str(folder)]) == 0
    assert "passed" in capsys.readouterr().out
    assert main(["view", "--rebuild", "--no-open", str(folder)]) == 0
    assert (folder / "report.html").is_file()


def test_written_again_it_has_the_present_format(tmp_path):
    stored = read_run(FORMAT_2)
    write_run(tmp_path / "run", stored)
    again = read_run(tmp_path / "run")
    assert json.loads((tmp_path / "run" / "run.json").read_text())["format"] == "armharness-run/3"
    assert to_plain(again.run.robot) == to_plain(stored.run.robot)
    assert again.content_digest == stored.content_digest


@pytest.mark.parametrize("damage", [{"joints": [{}]}, {"placements": [{}]}, {"groups": []}])
def test_a_damaged_robot_of_the_second_format_is_named(tmp_path, damage):
    folder = tmp_path / "run"
    shutil.copytree(FORMAT_2, folder)
    document = json.loads((folder / "run.json").read_text())
    document["robot"] |= damage
    (folder / "run.json").write_text(json.dumps(document))
    with pytest.raises(HarnessError, match=r"run\.json: damaged run: robot"):
        read_run(folder)
