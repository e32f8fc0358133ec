"""Names that nodes use and that are not served, and domains that are taken."""

from pathlib import Path

import pytest

from harness.cli.main import main
from harness.core.errors import SpecError
from harness.plugins.ros.actions import ActionClient
from harness.plugins.ros.bridge import BridgeRequest, run_bridge
from harness.plugins.ros.domain import free_domain
from harness.plugins.ros.endpoints import BEST_EFFORT, LATCHED, SERVICE, Use
from harness.plugins.ros.interfaces import CANCEL, FOLLOW, GRIPPER, TRAJECTORY
from harness.plugins.ros.names import unserved
from harness.plugins.ros.rtps.graph import dds_type
from harness.session.run_request import RunRequest
from tests.plugins.ros.bridging import bridge, scenario
from tests.session.front_door import problems

HOLD = "- external: {}"


def use(topic, *, publishes=False):
    return Use(topic, "std_msgs/msg/String", publishes)


def test_topics_that_nodes_use_among_themselves_are_left_out():
    state, plan, command = "/joint_states", "/plan", "/arm/joint_trajectory"
    own = [use(state, publishes=True), use(command)]
    others = [use(state), *(use(name, publishes=True) for name in (plan, command, "/rosout"))]
    assert unserved(own, [*others, use(plan)]) == []
    [sentence] = unserved(own, [use("/joint_state")])
    assert sentence == (
        "a node subscribes to /joint_state, which is not published; did you mean /joint_states?"
    )


def test_services_that_no_node_serves_are_named_and_servers_are_not():
    own = [use(f"/compute_ik{SERVICE}")]
    others = [use("/my_own_service" + SERVICE), use("/spin" + SERVICE, publishes=True)]
    [sentence] = unserved(own, [*others, use("/spin" + SERVICE),
                                use(f"/compute_IK{SERVICE}", publishes=True)])  # fmt: skip
    assert sentence == (
        "a node calls the service /compute_IK, which is not served; did you mean /compute_ik?"
    )


def test_misspelt_actions_are_noted_while_their_clients_wait_and_topics_at_the_end(tmp_path):
    said = []
    with bridge(scenario(tmp_path, HOLD), say=said.append) as (node, results):
        node.ready()
        node.graph.advertise("/arm_controler/joint_trajectory", TRAJECTORY)
        ActionClient(node.graph, "/gripper_controller/gripper_command", GRIPPER)
        node.graph.client("/controller_manager/list_controler", CANCEL)
        node.wait(lambda: len(said) == 2)
    domain = node.graph.participant.domain
    assert said == [
        "a node calls the action /gripper_controller/gripper_command, which is not served; did you"
        " mean /gripper_controller/gripper_cmd?",
        "a node calls the service /controller_manager/list_controler, which is not served; did you"
        " mean /controller_manager/list_controllers?",
    ]
    assert results[0].remarks[1:] == (
        f"no command came: other nodes were in ROS domain {domain}, and sent none",
        "a node publishes /arm_controler/joint_trajectory, which has no subscriber; did you mean"
        " /arm_controller/joint_trajectory?",
    )


@pytest.mark.nightly
def test_a_session_without_nodes_says_that_no_command_came(tmp_path):
    with free_domain() as domain:
        request = RunRequest(scenario(tmp_path, HOLD + "\n  timeout: 0.5 s"), page=False)
        result = run_bridge(BridgeRequest(request, domain))
    assert f"no command came: no other node was in ROS domain {domain}" in result.remarks


@pytest.mark.nightly
def test_wrong_types_and_qualities_are_noted_once_with_what_to_change(tmp_path):
    said, command = [], "/arm_controller/joint_trajectory"
    with bridge(scenario(tmp_path, HOLD), say=said.append) as (node, _):
        node.ready()
        node.graph.advertise(command, "std_msgs/msg/String")
        node.graph.participant.writer(f"rt{command}", dds_type(TRAJECTORY), BEST_EFFORT)
        ActionClient(node.graph, "/gripper_controller/gripper_cmd", FOLLOW)
        node.listen("/joint_states", "sensor_msgs/msg/JointState", LATCHED)
        node.listen("/robot_description", "std_msgs/msg/String")
        node.wait(lambda: len(said) == 5)
    assert said == [
        "a node calls the action /gripper_controller/gripper_cmd with the type"
        " control_msgs/action/FollowJointTrajectory, but its type is"
        " control_msgs/action/GripperCommand: no message arrives; import GripperCommand from"
        " control_msgs.action in the node",
        f"a node publishes {command} with best-effort reliability, which does not fit the other"
        " end: no message arrives; set reliability=ReliabilityPolicy.RELIABLE in its QoSProfile",
        f"a node publishes {command} with the type std_msgs/msg/String, but its type is"
        " trajectory_msgs/msg/JointTrajectory: no message arrives; import JointTrajectory from"
        " trajectory_msgs.msg in the node",
        "a node subscribes to /joint_states with transient-local durability, which does not fit"
        " the other end: no message arrives; set durability=DurabilityPolicy.VOLATILE in its"
        " QoSProfile",
        "a node subscribes to /robot_description with volatile durability, so what was published"
        " before it came does not arrive; set durability=DurabilityPolicy.TRANSIENT_LOCAL in its"
        " QoSProfile",
    ]


def test_a_second_robot_in_a_domain_is_refused(tmp_path):
    file = scenario(tmp_path, HOLD)
    with bridge(file) as (node, _):
        node.ready()
        request = BridgeRequest(RunRequest(Path(file)), node.graph.participant.domain)
        with pytest.raises(SpecError, match="another robot or simulator publishes /joint_states"):
            run_bridge(request)


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        ("{arm_controllers: [/my/arm]}", "no digit first, and `/` in between"),
        ("{gripper_controller: two words}", "ROS 2 takes letters, digits and `_`"),
        ("{arm_controllers: [a, b], gripper_controller: b}", "'b' is a name of the arm's"),
        ("{arm_controllers: [gripper_controller]}", "'gripper_controller' is a name of the arm's"),
        ("{gripper_controller: joint_trajectory_controller}", "name of the arm's controller and"),
    ],
)
def test_names_that_ros_does_not_take_are_reported_at_their_place(tmp_path, names, reason):
    [(line, message)] = problems(tmp_path, HOLD, rest=f"ros2: {names}")
    assert reason in message
    assert line == 6


@pytest.mark.nightly(only=["run"])
@pytest.mark.parametrize("command", ["check", "bridge", "run"])
def test_a_name_that_the_robot_uses_already_is_refused_before_the_run(tmp_path, capsys, command):
    file = scenario(tmp_path, HOLD, "ros2: {arm_controllers: [gripper_controller]}")
    options = [] if command == "check" else ["--no-report"]
    with free_domain() as domain:
        options += ["--domain", str(domain)] if command == "bridge" else []
        assert main([command, str(file), *options]) == 2
    said = capsys.readouterr()
    assert "test.scenario.yaml:5:25" in said.out + said.err
    assert "needs a name of its own" in said.out + said.err


@pytest.mark.parametrize("text", ["233", "-1", "abc"])
def test_a_number_that_is_no_domain_is_reported(tmp_path, monkeypatch, capsys, text):
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    assert main(["bridge", str(scenario(tmp_path, HOLD)), "--no-report"]) == 2
    assert f"ROS_DOMAIN_ID: '{text}' is no domain; they are 0 to 232" in capsys.readouterr().err
