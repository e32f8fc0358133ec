"""Two arms on the graph: each under its name, and both for MoveIt's clients."""

from pathlib import Path

import numpy as np
import pytest

from harness.plugins.ros.actions import ActionClient, Status
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.controller_manager import SRV
from harness.plugins.ros.handover import replay
from harness.plugins.ros.interfaces import FOLLOW, GRIPPER
from harness.recording.read_run import read_run
from harness.session.check import check_file
from tests.plugins.ros.bridging import bridge
from tests.plugins.ros.move_group_client import MoveGroupClient, joint_goal, pose_goal
from tests.plugins.ros.nodes import ARM, follow, grip, point
from tests.session.front_door import problems

ARMS = """\
robots:
  left: {model: open_manipulator_x, base: {xyz: [0, 0.3, 0]}}
  right: {model: open_manipulator_x, base: {xyz: [0, -0.3, 0]}}
"""
EXPECT = "expect: [{always: within_limits}, {never: collision}]\n"


def cell(folder, rest=EXPECT, steps="  - external: {}\n", robots=ARMS):
    file = Path(folder) / "two.scenario.yaml"
    file.write_text(f"scenario: two arms\n{robots}steps:\n{steps}{rest}")
    return file


def arm_joints(arm):
    return [f"{arm}_{name}" for name in ARM]


def action(node, arm):
    found = ActionClient(node.graph, f"/{arm}/arm_controller/follow_joint_trajectory", FOLLOW)
    node.wait(lambda: found.is_ready)
    return found


def test_each_arm_follows_its_own_goals_and_grips(tmp_path):
    folder = tmp_path / "run"
    with bridge(cell(tmp_path), run={"report_dir": folder}) as (node, results):
        state = "sensor_msgs/msg/JointState"
        heard = {arm: node.listen(f"/{arm}/joint_states", state) for arm in ("left", "right")}
        whole, path = node.listen("/joint_states", state), "nav_msgs/msg/Path"
        paths = {arm: node.listen(f"/{arm}/trajectory", path) for arm in ("left", "right")}
        left, right = action(node, "left"), action(node, "right")
        ways = {"left": [0.4, 0, 0, 0], "right": [-0.3, 0, 0, 0]}
        goals = [
            each.send(follow(point(1.0, ways[arm]), joints=arm_joints(arm)))
            for arm, each in (("left", left), ("right", right))
        ]
        node.wait(lambda: all(goal.result is not None for goal in goals))
        assert [goal.status for goal in goals] == [Status.SUCCEEDED] * 2
        assert list(goals[1].feedback[0].joint_names) == arm_joints("right")
        wrong = node.send(follow(point(1.0, [0, 0, 0, 0]), joints=arm_joints("left")), right)
        assert wrong.is_accepted is False
        hand = ActionClient(node.graph, "/right/gripper_controller/gripper_cmd", GRIPPER)
        node.wait(lambda: hand.is_ready)
        assert node.send(grip(0.019), hand).result.reached_goal
        node.wait(lambda: all(paths.values()))
    assert list(heard["left"][-1].name) == [
        *arm_joints("left"),
        "left_gripper_left_joint",
        "left_gripper_right_joint",
    ]
    assert heard["left"][-1].position[0] == pytest.approx(0.4, abs=0.01)
    assert heard["right"][-1].position[0] == pytest.approx(-0.3, abs=0.01)
    assert heard["right"][-1].position[4] == pytest.approx(0.019, abs=1e-3)
    assert abs(heard["left"][-1].position[4] - 0.019) > 5e-3
    assert {*heard["left"][-1].name, *heard["right"][-1].name} == {*whole[-1].name}
    ends = [paths[arm][-1].poses[-1].pose.position.y for arm in ("left", "right")]
    assert ends[0] > 0.3 > -0.3 > ends[1]
    assert results[0].case.outcome == "passed"
    assert replay(folder).digest == results[0].case.digest


@pytest.mark.nightly
def test_moveit_plans_for_an_arm_and_for_both(tmp_path):
    folder = tmp_path / "run"
    with bridge(cell(tmp_path), run={"report_dir": folder}) as (node, results):
        moveit = MoveGroupClient(node)
        one = moveit.move_to(joint_goal({"left_joint1": 0.3}), group="left")
        assert one.status is Status.SUCCEEDED
        both = joint_goal({"left_joint1": 0.0, "right_joint1": 0.4})
        moved = moveit.move_to(both, group="arms")
        assert moved.status is Status.SUCCEEDED
        names = moved.result.planned_trajectory.joint_trajectory.joint_names
        assert sorted(names) == sorted([*arm_joints("left"), *arm_joints("right")])
        tips = [f"{arm}_end_effector_link" for arm in ("left", "right")]
        found = moveit.call("compute_fk", "GetPositionFK", fk_link_names=tips)
        assert moveit.move_to(both, group="").result.error_code.val == -15
        place = pose_goal(found.pose_stamped[1].pose, link="")
        assert moveit.move_to(place, group="right", plan_only=True).status is Status.SUCCEEDED
    run = read_run(folder).run
    last = dict(zip(run.robot.joint_names, run.signals.joint_positions[-1], strict=True))
    assert last["left_joint1"] == pytest.approx(0.0, abs=0.01)
    assert last["right_joint1"] == pytest.approx(0.4, abs=0.01)
    followed = [each for each in run.commands if each.kind == "trajectory"]
    assert [each.controller for each in followed] == [
        f"{arm}/arm_controller" for arm in ("left", "left", "right")
    ]
    assert followed[1].sample == followed[2].sample
    assert replay(folder).digest == results[0].case.digest


@pytest.mark.nightly
def test_a_motion_of_both_that_one_arm_cannot_follow_stops_both(tmp_path):
    with bridge(cell(tmp_path)) as (node, _):
        moveit = MoveGroupClient(node)
        plan = moveit.move_to(
            joint_goal({"left_joint1": 1.0, "right_joint1": 1.0}), group="arms", plan_only=True
        )
        trajectory = plan.result.planned_trajectory
        sent = moveit.execute.send(message(f"{moveit.execute.kind}_Goal", trajectory=trajectory))
        state = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        node.wait(lambda: state and max(state[-1].position) > 0.1)
        moveit.node.send(
            follow(point(0.5, [0.0] * 4), joints=arm_joints("right")), action(node, "right")
        )
        node.wait(lambda: sent.result is not None)
        assert sent.result.error_code.val == -7
        stopped = state[-1]
        node.sleep(0.3)
        places = [list(stopped.name).index(f"{arm}_joint1") for arm in ("left", "right")]
    left = np.array([each.position[places[0]] for each in state])
    assert left[-1] < 0.9
    assert left[-1] == pytest.approx(left[-10], abs=2e-3)


@pytest.mark.nightly
def test_each_namespace_has_a_controller_manager(tmp_path):
    with bridge(cell(tmp_path)) as (node, _):
        kind, listed = f"{SRV}ListControllers", {}
        for space in ("/left", "/right", ""):
            lister = node.graph.client(f"{space}/controller_manager/list_controllers", kind)
            node.wait(lambda lister=lister: lister.is_ready())
            answers = listed.setdefault(space, [])
            lister.call(message(f"{kind}_Request"), answers.append)
        node.wait(lambda: all(listed.values()))
    names = {space: [each.name for each in found[0].controller] for space, found in listed.items()}
    own = ["joint_state_broadcaster", "arm_controller", "gripper_controller"]
    assert names == {"/left": own, "/right": own, "": own[:1]}
    claimed = listed["/right"][0].controller[1].claimed_interfaces
    assert claimed[0] == "right_joint1/position"


@pytest.mark.nightly
def test_names_of_a_scenario_replace_those_of_an_arm(tmp_path):
    names = "ros2: {arms: {left: {arm_controllers: [left_arm, also], gripper_controller: hand}}}\n"
    with bridge(cell(tmp_path, names + EXPECT)) as (node, _):
        for name in ("left_arm", "also", "right/arm_controller"):
            found = ActionClient(node.graph, f"/{name}/follow_joint_trajectory", FOLLOW)
            node.wait(lambda found=found: found.is_ready)


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        ("{arm_controllers: [a]}", "the robot has several arms: left, right; this does not say"),
        ("{arms: {middle: {gripper_controller: a}}}", "there is no arm 'middle'"),
        ("{arms: {left: {gripper_controller: right/arm_controller}}}", "(left) and of the arm's"),
        ("{arms: {left: {arm_controllers: [a]}, right: {arm_controllers: [b, a]}}}", "'a' is a"),
    ],
)
def test_names_that_fit_no_arm_are_refused(tmp_path, names, reason):
    file = cell(tmp_path, f"ros2: {names}\n" + EXPECT)
    [problem] = check_file(file).problems
    assert reason in problem.message
    assert problem.line == 7


def test_arms_of_a_robot_with_one_are_refused(tmp_path):
    rest = "ros2: {arms: {left: {gripper_controller: a}}}"
    [(line, message)] = problems(tmp_path, "- external: {}", rest=rest)
    assert (line, "the robot has one arm" in message) == (6, True)
