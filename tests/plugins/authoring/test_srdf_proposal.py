"""The SRDF that `robot check --write-srdf` proposes describes the same arms when it is read."""

import pytest

from harness.cli.main import main
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from tests.robot.hands import SIX
from tests.robot.test_several_arms import side


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def loaded(folder, **options):
    return load_robot(RobotSpec.model_validate({"urdf": "robot.urdf", **options}), folder)


TWO = f"<robot name='two'><link name='body'/>{side('l', -0.4, 6)}{side('r', 0.4, 6)}</robot>"


@pytest.mark.nightly(but=["two arms"])
@pytest.mark.parametrize("text", [SIX, TWO], ids=["one arm", "two arms"])
def test_arms_and_their_tcps_stay_as_they_were(text, folder, capsys):
    (folder / "robot.urdf").write_text(text, encoding="utf-8")
    main(["robot", "check", "robot.urdf", "--samples", "50", "--write-srdf", "robot.srdf"])
    capsys.readouterr()
    alone, read_back = loaded(folder), loaded(folder, srdf="robot.srdf")
    assert [arm.name for arm in read_back.arms] == [arm.name for arm in alone.arms]
    for before, after in zip(alone.arms or (alone,), read_back.arms or (read_back,), strict=True):
        assert after.gripper.joint == before.gripper.joint
        pose = alone.joint_by_name[f"{before.tcp_link}_joint"]
        again = read_back.joint_by_name[f"{after.tcp_link}_joint"]
        assert pose.parent == again.parent
        assert max(pose.pose.distance_to(again.pose)) < 1e-9
    group = alone.arm_group
    assert read_back.group_joints(read_back.arm_group) == alone.group_joints(group)
