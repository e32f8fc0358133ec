"""Joints and links with a prefix on the graph, as of one arm of two."""

import numpy as np
import pytest

from harness.plugins.ros.actions import Status
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.controller_manager import SRV, STATE
from harness.plugins.ros.endpoints import LATCHED
from harness.plugins.ros.handover import replay
from harness.plugins.ros.interfaces import register_move_group
from harness.plugins.ros.prefix import Prefix
from harness.recording.read_run import read_run
from tests.plugins.ros.bridging import bridge, scenario
from tests.plugins.ros.move_group_client import MoveGroupClient, joint_goal, pose, stamped
from tests.plugins.ros.nodes import ARM, follow, point
from tests.robot.models import robot
from tests.session.front_door import problems

HOLD = "- external: {}"
LEFT = tuple(f"left_{name}" for name in ARM)


def test_nodes_use_prefixed_names_and_the_run_has_those_of_the_robot(tmp_path):
    register_move_group()
    file = scenario(tmp_path, HOLD, "ros2: {prefix: left_}\nexpect: [{always: within_limits}]")
    folder = tmp_path / "run"
    with bridge(file, run={"report_dir": folder}) as (node, results):
        states = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        frames = node.listen("/tf", "tf2_msgs/msg/TFMessage")
        fixed = node.listen("/tf_static", "tf2_msgs/msg/TFMessage", LATCHED)
        text = node.listen("/robot_description", "std_msgs/msg/String", LATCHED)
        semantic = node.listen("/robot_description_semantic", "std_msgs/msg/String", LATCHED)
        state = node.listen("/arm_controller/controller_state", STATE)
        node.ready()
        moved = node.send(follow(point(0.4, [0.2, 0, 0, 0]), joints=LEFT))
        assert moved.status is Status.SUCCEEDED
        assert list(moved.feedback[0].joint_names) == list(LEFT)
        wrong = node.send(follow(point(0.4, [0.2, 0, 0, 0])))
        assert wrong.is_accepted is False
        assert "no joint 'joint1 (without left_)'" in wrong.result.error_string
        client = MoveGroupClient(node)
        back = client.move_to(joint_goal(dict.fromkeys(LEFT, 0.0)), group="arm")
        assert back.status is Status.SUCCEEDED
        links = {"fk_link_names": ["left_end_effector_link"]}
        found = client.call("compute_fk", "GetPositionFK", **links)
        assert found.fk_link_names == links["fk_link_names"]
        listed = []
        lister = node.graph.client("/controller_manager/list_controllers", f"{SRV}ListControllers")
        node.wait(lister.is_ready)
        lister.call(message(f"{SRV}ListControllers_Request"), listed.append)
        node.wait(lambda: listed and states and frames and fixed and text and semantic and state)
    assert tuple(states[-1].name[:4]) == LEFT
    assert states[-1].name[4] == "left_gripper_left_joint"
    assert listed[0].controller[1].claimed_interfaces[0] == "left_joint1/position"
    assert tuple(state[-1].joint_names) == LEFT
    children = {each.child_frame_id for each in frames[0].transforms}
    assert {"left_link2", "left_link3"} <= children
    assert {each.header.frame_id for each in fixed[0].transforms} >= {"world"}
    assert '<joint name="left_joint1"' in text[0].data
    assert '<joint name="joint1"' not in text[0].data
    assert 'link1="left_' in semantic[0].data
    assert '<group name="arm"' in semantic[0].data
    commands = read_run(folder).run.commands
    assert commands[0].content["joint_names"] == list(ARM)
    assert replay(folder).digest == results[0].case.digest


def test_a_prefix_is_of_joints_and_links_alone_and_comes_off_again():
    register_move_group()
    description = robot(model="ur5e", gripper="rh_p12_rn_a")
    prefix = Prefix("right_", description)
    sent = stamped(pose((1, 2, 3)), "tool0")
    assert prefix.outward(sent).header.frame_id == "right_tool0"
    assert sent.header.frame_id == "tool0"
    assert prefix.inward(prefix.outward(sent)) == sent
    assert prefix.outward(stamped(pose((1, 2, 3)), "world")).header.frame_id == "world"
    cube = message("moveit_msgs/msg/CollisionObject", id="cube")
    assert prefix.outward(cube) is cube
    state = message("sensor_msgs/msg/JointState", name=["elbow_joint"], position=np.zeros(1))
    assert prefix.outward(state).name == ["right_elbow_joint"]
    assert prefix.outward(state).position is state.position
    assert Prefix("", description).outward(state) is state


@pytest.mark.parametrize("text", ["1_", "'left '", "left/", "''"])
def test_a_prefix_that_ros_does_not_take_is_reported_at_its_place(tmp_path, text):
    [(line, _)] = problems(tmp_path, HOLD, rest=f"ros2: {{prefix: {text}}}")
    assert line == 6
