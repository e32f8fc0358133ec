"""MoveIt's motion sequences on the bridge: planned, blended, followed, refused."""

import numpy as np
import pytest

from harness.plugins.ros.actions import ActionClient, Status
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.handover import replay
from harness.plugins.ros.interfaces import SEQUENCE
from harness.plugins.ros.moveit.values import NUMBERS
from tests.plugins.ros.bridging import bridge, scenario
from tests.plugins.ros.move_group_client import (
    UR,
    MoveGroupClient,
    joint_goal,
    moveit,
    pose,
    pose_goal,
    request,
)

HOLD = "- external: {}"
SUCCESS = 1
PILZ = "pilz_industrial_motion_planner"
SLOW = {"max_velocity_scaling_factor": 0.1}
CORNERS = ((0.4, 0.1, 0.4), (0.4, 0.25, 0.4), (0.4, 0.25, 0.3))


def item(goal, planner="LIN", radius=0.0, pipeline=PILZ, **fields):
    planned = request(goal, planner_id=planner, pipeline_id=pipeline, **fields)
    return moveit("MotionSequenceItem", req=planned, blend_radius=radius)


def lines(*radii, **fields):
    corners = zip(CORNERS, ("PTP", "LIN", "LIN"), radii, strict=True)
    return [item(pose_goal(pose(xyz)), kind, radius, **fields) for xyz, kind, radius in corners]


class SequenceClient(MoveGroupClient):
    def __init__(self, node):
        super().__init__(node)
        self.sequence = ActionClient(node.graph, "/sequence_move_group", SEQUENCE)
        node.wait(lambda: self.sequence.is_ready)

    def plan(self, items):
        sequence = moveit("MotionSequenceRequest", items=items)
        return self.call("plan_sequence_path", "GetMotionSequence", request=sequence).response

    def run(self, items, *, plan_only=False):
        goal = message(
            f"{SEQUENCE}_Goal",
            request=moveit("MotionSequenceRequest", items=items),
            planning_options=moveit("PlanningOptions", plan_only=plan_only),
        )
        return self.node.send(goal, self.sequence)

    def tcp(self):
        here = (
            self.call("compute_fk", "GetPositionFK", fk_link_names=["end_effector_link"])
            .pose_stamped[0]
            .pose.position
        )
        return here.x, here.y, here.z


def seconds(response):
    [trajectory] = response.planned_trajectories
    last = trajectory.joint_trajectory.points[-1].time_from_start
    return last.sec + 1e-9 * last.nanosec


def test_a_sequence_is_planned_blended_and_followed_and_replays(tmp_path):
    folder = tmp_path / "run"
    with bridge(scenario(tmp_path, HOLD, robot=UR), run={"report_dir": folder}) as (node, results):
        client = SequenceClient(node)
        stopping, blended = client.plan(lines(0, 0, 0)), client.plan(lines(0, 0.05, 0))
        assert stopping.error_code.val == blended.error_code.val == SUCCESS
        assert seconds(blended) < seconds(stopping)
        moved = client.run(lines(0, 0.05, 0))
        assert moved.status is Status.SUCCEEDED
        assert moved.result.response.error_code.val == SUCCESS
        assert client.tcp() == pytest.approx(CORNERS[-1], abs=2e-3)
    assert results[0].case.outcome == "passed"
    assert replay(folder).digest == results[0].case.digest


@pytest.mark.nightly
def test_a_sequence_may_be_slow_planned_alone_of_ompl_empty_or_canceled(tmp_path):
    folder = tmp_path / "run"
    with bridge(scenario(tmp_path, HOLD, robot=UR), run={"report_dir": folder}) as (node, results):
        client = SequenceClient(node)
        begin, stopping = client.tcp(), client.plan(lines(0, 0, 0))
        slow = client.plan([*lines(0, 0, 0)[:1], *lines(0, 0, 0, **SLOW)[1:]])
        assert seconds(slow) > 1.5 * seconds(stopping)
        assert client.run(lines(0, 0.05, 0), plan_only=True).status is Status.SUCCEEDED
        assert client.tcp() == pytest.approx(begin, abs=1e-3)
        both = client.run(
            [
                item(joint_goal({name: 0.5}), "", pipeline="ompl")
                for name in ("wrist_3_joint", "wrist_2_joint")
            ]
        )
        last = both.result.response.planned_trajectories[0].joint_trajectory
        ends = dict(zip(last.joint_names, last.points[-1].positions, strict=True))
        assert (ends["wrist_3_joint"], ends["wrist_2_joint"]) == pytest.approx((0.5, 0.5))
        assert client.run([]).status is Status.SUCCEEDED
        assert client.plan([]).error_code.val == SUCCESS
        states = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        sequence = moveit("MotionSequenceRequest", items=lines(0, 0, 0, **SLOW))
        running = client.sequence.send(message(f"{SEQUENCE}_Goal", request=sequence))
        node.wait(lambda: states and abs(states[-1].velocity).max() > 0.05)
        client.sequence.cancel(running)
        node.wait(lambda: running.is_over)
        assert running.status is Status.CANCELED
        assert running.result.response.error_code.val == NUMBERS["PREEMPTED"]
    assert results[0].case.outcome == "passed"
    assert replay(folder).digest == results[0].case.digest


FAR = pose_goal(pose((4, 0, 0.4)))
ELSEWHERE = moveit(
    "RobotState",
    joint_state=message(
        "sensor_msgs/msg/JointState", name=["elbow_joint"], position=np.array([1.0])
    ),
)
REFUSED = {
    "a negative radius": (lines(0, -0.01, 0), "INVALID_MOTION_PLAN", "negative"),
    "a radius of NaN": (lines(np.nan, 0, 0), "INVALID_MOTION_PLAN", "no number"),
    "a radius at the end": (lines(0, 0, 0.02), "INVALID_MOTION_PLAN", "last item is not 0"),
    "radii that overlap": (lines(0.08, 0.08, 0), "INVALID_MOTION_PLAN", "items 1 to 3: "),
    "a start of the second item": (
        [*lines(0, 0, 0), item(FAR, start_state=ELSEWHERE)], "INVALID_ROBOT_STATE", "start state",
    ),
    "two groups": (
        [lines(0, 0, 0)[0], item(FAR, group="gripper")], "FAILURE", "several groups",
    ),
    "a second item out of reach": (
        [lines(0, 0, 0)[0], item(FAR)], "NO_IK_SOLUTION", "item 2: ",
    ),
    "a blended item out of reach": (
        [*lines(0.02, 0.02, 0.02), item(FAR)], "NO_IK_SOLUTION", "item 4: ",
    ),
    "a blend of OMPL": (lines(0.02, 0, 0, pipeline="ompl"), "FAILURE", "are blended"),
    "no such planner": ([item(FAR, "SPLINE")], "FAILURE", "item 1: Pilz has no planner"),
    "no such pipeline": (lines(0, 0, 0, pipeline="chomp"), "FAILURE", "no pipeline 'chomp'"),
    "too many items": ([item(FAR)] * 1001, "INVALID_MOTION_PLAN", "at most 1000 items"),
}  # fmt: skip


@pytest.mark.nightly
def test_sequences_that_cannot_be_are_refused_with_moveits_codes(tmp_path):
    with bridge(scenario(tmp_path, HOLD, robot=UR)) as (node, _):
        client = SequenceClient(node)
        for name, (items, code, words) in REFUSED.items():
            answer = client.plan(items)
            assert (name, answer.error_code.val) == (name, NUMBERS[code])
            assert words in answer.error_code.message, name
            assert not answer.planned_trajectories, name
        ended = client.run(REFUSED["two groups"][0])
        assert ended.status is Status.ABORTED
        assert ended.result.response.error_code.val == NUMBERS["FAILURE"]
