"""The controller manager and the states of controllers, as rqt and ros2control use them."""

from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.interfaces import register_move_group
from tests.plugins.ros.bridging import bridge, scenario
from tests.plugins.ros.nodes import ARM, follow, point

register_move_group()
STATE = "control_msgs/msg/JointTrajectoryControllerState"


def test_controllers_are_listed_and_their_states_are_published(tmp_path):
    with bridge(scenario(tmp_path, "- external: {}")) as (node, _):
        node.ready()
        states = node.listen("/arm_controller/controller_state", STATE)

        def call(service, kind, **fields):
            kind = f"controller_manager_msgs/srv/{kind}"
            client, answers = node.graph.client(f"/controller_manager/{service}", kind), []
            node.wait(client.is_ready)
            client.call(message(f"{kind}_Request", **fields), answers.append)
            node.wait(lambda: answers)
            return answers[0]

        listed = {
            each.name: each for each in call("list_controllers", "ListControllers").controller
        }
        assert {*listed} == {"joint_state_broadcaster", "arm_controller", "gripper_controller"}
        assert {each.state for each in listed.values()} == {"active"}
        arm = listed["arm_controller"]
        assert arm.type == "joint_trajectory_controller/JointTrajectoryController"
        assert list(arm.claimed_interfaces) == [f"{joint}/position" for joint in ARM]
        types = call("list_controller_types", "ListControllerTypes")
        assert {each.type for each in listed.values()} == {*types.types}
        switch = ("switch_controller", "SwitchController")
        assert call(*switch, activate_controllers=["arm_controller"]).ok
        stopped = call(*switch, deactivate_controllers=["arm_controller"])
        assert not stopped.ok
        assert "stays active" in stopped.message
        assert not call(*switch, activate_controllers=["leg_controller"]).ok
        assert call("load_controller", "LoadController", name="arm_controller").ok
        assert not call("unload_controller", "UnloadController", name="arm_controller").ok
        [robot] = call("list_hardware_components", "ListHardwareComponents").component
        assert (robot.name, robot.state.label) == ("open_manipulator_x", "active")
        interfaces = call("list_hardware_interfaces", "ListHardwareInterfaces")
        claimed = [each.name for each in interfaces.command_interfaces if each.is_claimed]
        assert claimed == [*arm.claimed_interfaces, "gripper_left_joint/position"]
        assert "gripper_right_joint/velocity" in {each.name for each in interfaces.state_interfaces}
        assert not call("set_hardware_component_state", "SetHardwareComponentState").ok
        node.send(follow(point(0.4, [0.2, 0, 0, 0])))
        node.wait(lambda: states and abs(states[-1].feedback.positions[0] - 0.2) < 0.02)
    last = states[-1]
    assert list(last.joint_names) == list(ARM)
    assert len(last.reference.accelerations) == len(last.error.velocities) == len(ARM)
    assert (
        abs(last.error.positions[0] - (last.reference.positions - last.feedback.positions)[0])
        < 1e-9
    )
