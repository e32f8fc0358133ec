"""The page on ROS 2: its table lists what the bridge serves, and its example runs."""

import re
import shlex

import pytest

from docs import ROOT
from harness.cli.main import main
from tests.plugins.ros.bridging import PYTHON, bridge, require_control_msgs
from tests.session.front_door import check_file

PAGE = (ROOT / "docs/guides/ros2.md").read_text(encoding="utf-8")
MOVE_GROUP = (ROOT / "docs/guides/move_group.md").read_text(encoding="utf-8")


def block(language):
    return re.search(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)[1]


def test_the_table_lists_what_the_bridge_serves(tmp_path):
    listed = set()
    for row in re.findall(r"^\| (`/.*?) \| `?(action )?", PAGE + MOVE_GROUP, re.MULTILINE):
        listed |= set(re.findall(r"`(/[^`]+)`", row[0]))
    file = tmp_path / "turn.scenario.yaml"
    file.write_text(block("yaml"))
    with bridge(file) as (node, _):
        node.ready()
        info = "/gripper_camera/camera_info"
        node.wait(lambda: any(use.topic == info for use in node.graph.uses()[1]))
        node.sleep(0.3)
        _, bridged = node.graph.uses()
    assert {re.sub(r"/_(action/|service).*", "", use.topic) for use in bridged} == listed


def test_the_scenario_of_the_page_is_correct(tmp_path):
    file = tmp_path / "turn.scenario.yaml"
    file.write_text(block("yaml"))
    assert check_file(file).problems == ()


def test_the_commands_of_the_page_exist(capsys):
    for line in re.findall(r"```sh\n(.*?)\n```", PAGE, re.DOTALL):
        words = shlex.split(line)
        with pytest.raises(SystemExit) as ended:
            main([words[1], "--help"])
        assert ended.value.code == 0
        said = capsys.readouterr().out
        assert all(word in said for word in words if word.startswith("--"))


@pytest.mark.needs_ros
def test_the_node_of_the_page_moves_the_arm(tmp_path):
    require_control_msgs()
    file, node = tmp_path / "turn.scenario.yaml", tmp_path / "student.py"
    file.write_text(block("yaml"))
    node.write_text(block("python"))
    assert main(["grade", str(file), "--node", f"{PYTHON} {node}", "--no-report"]) == 0
