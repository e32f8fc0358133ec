"""Names that nodes use and that are not served, and domains that are taken."""

from pathlib import Path

import pytest

from harness.cli.main import main
from harness.core.errors import SpecError
from harness.ros.action_client import ActionClient
from harness.ros.bridge import BridgeRequest, run_bridge
from harness.ros.interfaces import GRIPPER, TRAJECTORY
from harness.ros.names import Names, unserved
from harness.session.run_request import RunRequest
from tests.ros.bridging import bridge, scenario

HOLD = "- external: {}"


def test_topics_that_nodes_use_among_themselves_are_left_out():
    own = Names.of(["/joint_states"], ["/arm/joint_trajectory"])
    others = Names.of(["/plan", "/arm/joint_trajectory", "/rosout"], ["/plan", "/joint_states"])
    assert unserved(own, others) == []
    [sentence] = unserved(own, Names.of([], ["/joint_state"]))
    assert sentence == (
        "a node subscribes to /joint_state, which is not published; did you mean /joint_states?"
    )


def test_misspelt_actions_and_topics_are_named_when_nothing_arrived(tmp_path):
    with bridge(scenario(tmp_path, HOLD)) as (node, results):
        node.ready()
        node.graph.advertise("/arm_controler/joint_trajectory", TRAJECTORY)
        ActionClient(node.graph, "/gripper_controller/gripper_command", GRIPPER)
        node.sleep(1.0)
    assert results[0].names == (
        "a node calls the action /gripper_controller/gripper_command, which is not served; did you"
        " mean /gripper_controller/gripper_cmd?",
        "a node publishes /arm_controler/joint_trajectory, which has no subscriber; did you mean"
        " /arm_controller/joint_trajectory?",
    )


def test_a_second_robot_in_a_domain_is_refused(tmp_path):
    file = scenario(tmp_path, HOLD)
    with bridge(file) as (node, _):
        node.ready()
        request = BridgeRequest(RunRequest(Path(file)), node.graph.participant.domain)
        with pytest.raises(SpecError, match="another robot or simulator publishes /joint_states"):
            run_bridge(request)


@pytest.mark.parametrize("text", ["233", "-1", "abc"])
def test_a_number_that_is_no_domain_is_reported(tmp_path, monkeypatch, capsys, text):
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    assert main(["bridge", str(scenario(tmp_path, HOLD)), "--no-report"]) == 2
    assert f"ROS_DOMAIN_ID: '{text}' is no domain; they are 0 to 232" in capsys.readouterr().err
