"""MoveIt's interface on the bridge, with the real planner and physics."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from harness.core.errors import ErrorCode
from harness.plugins.ros.actions import Status
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.handover import replay
from harness.plugins.ros.interfaces import EXECUTE, MOVE
from harness.plugins.ros.moveit.values import NUMBERS
from harness.recording.read_run import read_run
from tests.plugins.ros.bridging import bridge, scenario
from tests.plugins.ros.move_group_client import (
    DOWN,
    GROUP,
    UR,
    MoveGroupClient,
    box,
    joint_goal,
    mesh,
    moveit,
    pose,
    pose_goal,
    primitive,
    request,
    stamped,
)

HOLD = "- external: {}"
SUCCESS = 1
CUBE = (
    "objects:\n"
    "  - {name: cube, box: {size: [4 cm, 4 cm, 4 cm]}, mass: 0.1, pose: {xyz: [0.4, 0.1, 0.02]}}\n"
)


def test_every_error_code_of_the_program_has_moveits_number():
    assert set(NUMBERS) == set(ErrorCode.__args__)
    assert len({*NUMBERS.values()}) == len(NUMBERS)


def test_a_client_solves_plans_and_moves_and_the_run_replays(tmp_path):
    with bridge(scenario(tmp_path, HOLD, robot=UR), run={"report_dir": tmp_path / "run"}) as (
        node,
        results,
    ):
        client = MoveGroupClient(node)
        target = pose((0.4, 0.1, 0.4))
        requested = moveit("PositionIKRequest", group_name=GROUP, pose_stamped=stamped(target))
        solved = client.call("compute_ik", "GetPositionIK", ik_request=requested)
        assert solved.error_code.val == SUCCESS
        state = solved.solution
        at = (
            client.call(
                "compute_fk",
                "GetPositionFK",
                robot_state=state,
                fk_link_names=["end_effector_link"],
            )
            .pose_stamped[0]
            .pose
        )
        assert (at.position.x, at.position.y, at.position.z) == pytest.approx((0.4, 0.1, 0.4))
        joints = dict(zip(state.joint_state.name[:6], state.joint_state.position, strict=False))

        plan = client.call(
            "plan_kinematic_path", "GetMotionPlan", motion_plan_request=request(joint_goal(joints))
        ).motion_plan_response
        assert plan.error_code.val == SUCCESS
        last = plan.trajectory.joint_trajectory.points[-1]
        assert last.positions == pytest.approx(np.array(list(joints.values())), abs=1e-6)
        only = client.move_to(pose_goal(target), plan_only=True)
        assert only.result.error_code.val == SUCCESS
        assert not only.result.executed_trajectory.joint_trajectory.points
        slow = client.move_to(pose_goal(target), plan_only=True, max_velocity_scaling_factor=0.1)
        times = [
            each.result.planned_trajectory.joint_trajectory.points[-1] for each in (only, slow)
        ]
        assert times[1].time_from_start.sec > 4 * times[0].time_from_start.sec

        moved = client.move_to(pose_goal(target))
        assert (moved.status, moved.result.error_code.val) == (Status.SUCCEEDED, SUCCESS)
        node.wait(lambda: len(moved.feedback) == 3)
        assert [each.state for each in moved.feedback] == ["PLANNING", "MONITOR", "IDLE"]
        here = (
            client.call("compute_fk", "GetPositionFK", fk_link_names=["end_effector_link"])
            .pose_stamped[0]
            .pose.position
        )
        assert (here.x, here.y, here.z) == pytest.approx((0.4, 0.1, 0.4), abs=2e-3)
        path = client.call(
            "compute_cartesian_path", "GetCartesianPath",
            group_name=GROUP, waypoints=[pose((0.4, 0.15, 0.4)), pose((0.4, 0.15, 0.35))],
            max_step=0.01, avoid_collisions=True,
        )  # fmt: skip
        assert path.fraction == 1.0
        assert client.follow(path.solution).status is Status.SUCCEEDED
        again = client.follow(path.solution)  # the arm is not at its start any more
        assert again.status is Status.ABORTED
        assert "begins" in again.result.error_code.message
        pilz = {"pipeline_id": "pilz_industrial_motion_planner"}
        line = client.move_to(pose_goal(pose((0.35, 0.15, 0.35))), planner_id="LIN", **pilz)
        assert line.result.error_code.val == SUCCESS
        ptp = client.move_to(joint_goal(joints), planner_id="PTP", **pilz)
        assert ptp.result.error_code.val == SUCCESS
    [result] = results
    assert result.case.outcome == "passed"
    repeated = replay(tmp_path / "run")
    assert repeated.digest == result.case.digest


def test_clients_change_the_planning_scene_and_attach_what_the_physics_has(tmp_path):
    rest = CUBE + "expect: [{always: within_limits}]"
    file = scenario(tmp_path, HOLD, rest, robot=UR)
    with bridge(file, run={"report_dir": tmp_path / "run"}) as (node, results):
        client = MoveGroupClient(node)
        seen = node.listen("/monitored_planning_scene", "moveit_msgs/msg/PlanningScene")
        assert client.move_to(pose_goal(pose((0.4, 0.1, 0.3)))).result.error_code.val == SUCCESS
        names = {each.id for each in client.scene().world.collision_objects}
        assert {"cube", "ground_plane"} <= names

        def fraction():
            return client.call(
                "compute_cartesian_path", "GetCartesianPath",
                group_name=GROUP, waypoints=[pose((0.4, 0.4, 0.3))], max_step=0.01,
            ).fraction  # fmt: skip

        assert fraction() == 1.0
        assert client.apply(box("wall", (0.4, 0.3, 0.3), (1, 0.02, 0.6)))
        assert fraction() < 0.7
        goal = client.move_to(pose_goal(pose((0.4, 0.3, 0.3))))
        assert goal.result.error_code.val == NUMBERS["GOAL_IN_COLLISION"]
        assert "wall" in goal.result.error_code.message
        wall = moveit("CollisionObject", id="wall", operation=1)
        assert client.apply(wall)
        assert fraction() == 1.0
        assert not client.apply(wall)

        cube = moveit("CollisionObject", id="cube")
        held = moveit("AttachedCollisionObject", link_name="end_effector_link", object=cube)
        assert client.apply(attached=[held])
        [known] = client.scene().robot_state.attached_collision_objects
        assert (known.object.id, known.link_name) == ("cube", "end_effector_link")
        held.object.operation = 1
        assert client.apply(attached=[held])
        assert not client.scene().robot_state.attached_collision_objects
        node.wait(lambda: seen and len(seen) > 3)
    run = read_run(tmp_path / "run").run
    assert [each.object for each in run.attachments] == ["cube"]
    kinds = [each.kind for each in run.commands]
    assert kinds.count("scene") == 5
    refused = [each for each in run.commands if each.kind == "plan"][-1]
    assert refused.content["answer"].startswith("GOAL_IN_COLLISION")
    assert replay(tmp_path / "run").digest == results[0].case.digest


KNEE = message("sensor_msgs/msg/JointState", name=["knee"], position=np.array([1.0]))
BAD_REQUESTS = {
    "no goal": (request(), "INVALID_GOAL_CONSTRAINTS"),
    "no such group": (request(joint_goal({"elbow_joint": 1}), group="legs"), "INVALID_GROUP_NAME"),
    "no such joint": (request(joint_goal({"knee": 1})), "INVALID_GOAL_CONSTRAINTS"),
    "a joint of NaN": (request(joint_goal({"elbow_joint": np.nan})), "INVALID_GOAL_CONSTRAINTS"),
    "no such link": (request(pose_goal(pose((0.4, 0, 0.4)), link="foot")), "INVALID_LINK_NAME"),
    "no such frame": (
        request(pose_goal(pose((0.4, 0, 0.4)), frame="mars")), "FRAME_TRANSFORM_FAILURE",
    ),
    "a pose of NaN": (request(pose_goal(pose((np.nan, 0, 0.4)))), "INVALID_GOAL_CONSTRAINTS"),
    "no orientation": (
        request(pose_goal(pose((0.4, 0, 0.4), (0.0, 0.0, 0.0, 0.0)))), "INVALID_GOAL_CONSTRAINTS",
    ),
    "a region without a shape": (
        request(pose_goal(pose((0.4, 0, 0.4)), region=moveit("BoundingVolume"))),
        "INVALID_GOAL_CONSTRAINTS",
    ),
    "a region that is a cone": (
        request(pose_goal(pose((0.4, 0, 0.4)), region=moveit(
            "BoundingVolume", primitives=[primitive(4, 1, 1)], primitive_poses=[pose((0, 0, 0))]))),
        "INVALID_GOAL_CONSTRAINTS",
    ),
    "a region of a negative size": (
        request(pose_goal(pose((0.4, 0, 0.4)), region=moveit(
            "BoundingVolume", primitives=[primitive(2, -1)], primitive_poses=[pose((0, 0, 0))]))),
        "INVALID_GOAL_CONSTRAINTS",
    ),
    "visibility": (
        request(moveit("Constraints", visibility_constraints=[moveit("VisibilityConstraint")])),
        "UNRECOGNIZED_GOAL_TYPE",
    ),
    "two orientations": (
        request(
            moveit("Constraints", orientation_constraints=[moveit("OrientationConstraint")] * 2)
        ),
        "UNRECOGNIZED_GOAL_TYPE",
    ),
    "no such pipeline": (
        request(joint_goal({"elbow_joint": 1}), pipeline_id="chomp"), "FAILURE",
    ),
    "CIRC without a point": (
        request(pose_goal(pose((0.4, 0, 0.4))), planner_id="CIRC",
                pipeline_id="pilz_industrial_motion_planner"),
        "INVALID_MOTION_PLAN",
    ),
    "a start of an unknown joint": (
        request(joint_goal({"elbow_joint": 1}), start_state=moveit("RobotState", joint_state=KNEE)),
        "INVALID_ROBOT_STATE",
    ),
    "out of reach": (request(pose_goal(pose((4, 0, 0.4)))), "NO_IK_SOLUTION"),
    "below the ground": (request(pose_goal(pose((0.4, 0.1, -0.2)))), "GOAL_IN_COLLISION"),
    "beyond a limit": (request(joint_goal({"elbow_joint": 9})), "GOAL_STATE_INVALID"),
}  # fmt: skip


@pytest.mark.nightly
def test_requests_that_mean_nothing_are_answered_with_moveits_codes(tmp_path):
    said = []
    with bridge(scenario(tmp_path, HOLD, robot=UR), say=said.append) as (node, results):
        client = MoveGroupClient(node)
        answers = {}
        for name, (requested, _) in BAD_REQUESTS.items():
            response = client.call(
                "plan_kinematic_path", "GetMotionPlan", motion_plan_request=requested
            ).motion_plan_response
            answers[name] = response.error_code
            assert not response.trajectory.joint_trajectory.points, name
        bad_objects = [
            box("", (0, 0, 1), (1, 1, 1)),
            box("end_effector_link", (0, 0, 1), (1, 1, 1)),
            box("flat", (0, 0, 1), (1, 0, 1)),
            box("infinite", (np.inf, 0, 1), (1, 1, 1)),
            box(
                "elsewhere",
                (0, 0, 1),
                (1, 1, 1),
                header=message("std_msgs/msg/Header", frame_id="x"),
            ),
            moveit("CollisionObject", id="empty"),
            moveit("CollisionObject", id="gone", operation=1),
            moveit("CollisionObject", id="prism", primitives=[primitive(5, 1, 1)]),
            moveit("CollisionObject", id="mesh", meshes=[message("shape_msgs/msg/Mesh")]),
            moveit("CollisionObject", id="odd", meshes=[mesh([[0, 0, 0], [1, 0, 0]], [[0, 1, 2]])]),
            moveit("CollisionObject", id="wild", meshes=[mesh([[np.inf] * 3] * 3, [[0, 1, 2]])]),
            moveit("CollisionObject", id="plane", planes=[message("shape_msgs/msg/Plane")]),
            box("odd", (0, 0, 1), (1, 1, 1), operation=9),
        ]
        assert not any(client.apply(each) for each in bad_objects)
        lonely = moveit("AttachedCollisionObject", object=moveit("CollisionObject", id="nothing"))
        assert not client.apply(attached=[lonely])
        floating = moveit(
            "AttachedCollisionObject", link_name="foot", object=box("b", (5, 0, 1), [1] * 3)
        )
        assert not client.apply(attached=[floating])
        empty = client.follow(moveit("RobotTrajectory"))
        assert empty.result.error_code.val == NUMBERS["CONTROL_FAILED"]
        path = {"group_name": GROUP, "max_step": 0.01}
        for fields in (
            {**path, "waypoints": [pose((0.4, 0, 0.4))], "max_step": 0.0},
            {**path, "waypoints": [pose((0.4, 0, 0.4))], "link_name": "foot"},
        ):
            answer = client.call("compute_cartesian_path", "GetCartesianPath", **fields)
            assert answer.error_code.val != SUCCESS
        unreachable = moveit("PositionIKRequest", pose_stamped=stamped(pose((9, 0, 0), DOWN)))
        solved = client.call("compute_ik", "GetPositionIK", ik_request=unreachable)
        assert solved.error_code.val == NUMBERS["NO_IK_SOLUTION"]
        goal = pose_goal(pose((0.4, 0.1, 0.4)))
        still = client.move_to(goal, plan_only=True, planner_id="MyPlanner")
        assert still.result.error_code.val == SUCCESS
    expected = {name: NUMBERS[code] for name, (_, code) in BAD_REQUESTS.items()}
    assert {name: code.val for name, code in answers.items()} == expected
    assert all(code.message for code in answers.values())
    assert results[0].case.outcome == "passed"
    assert any("unknown planner 'MyPlanner'" in note for note in said)


def outcome(sent):
    return sent.status, sent.result.error_code.val


@pytest.mark.nightly
def test_goals_that_are_canceled_before_they_are_planned_do_not_move_the_arm(tmp_path):
    home = {"elbow_joint": 1.0}
    with bridge(scenario(tmp_path, HOLD, robot=UR), run={"report_dir": tmp_path / "run"}) as (
        node,
        results,
    ):
        client = MoveGroupClient(node)
        # The first goal occupies the bridge, so that the second one and its end arrive meanwhile.
        far = message(f"{MOVE}_Goal", request=request(pose_goal(pose((0.4, 0.1, 0.4)))))
        sent = [client.move.send(far)]
        sent.append(client.move.send(message(f"{MOVE}_Goal", request=request(joint_goal(home)))))
        client.move.cancel(sent[1])
        sent.append(client.execute.send(message(f"{EXECUTE}_Goal")))
        client.execute.cancel(sent[2])
        node.wait(lambda: all(each.is_over for each in sent))
        plan = client.move_to(joint_goal(home), plan_only=True).result.planned_trajectory
        events = node.graph.advertise("/trajectory_execution_event", "std_msgs/msg/String")
        node.wait(lambda: events.subscribers)
        running = client.execute.send(message(f"{EXECUTE}_Goal", trajectory=plan))
        node.wait(lambda: running.is_accepted)
        client.call(
            "compute_fk", "GetPositionFK", fk_link_names=["end_effector_link"]
        )  # which is answered after the arm set out
        events.publish(message("std_msgs/msg/String", data="halt"))
        events.publish(message("std_msgs/msg/String", data="stop"))
        node.wait(lambda: running.is_over)
        slow = client.move.send(
            message(
                f"{MOVE}_Goal",
                request=request(joint_goal({"elbow_joint": 0}), max_velocity_scaling_factor=0.1),
            )
        )
        states = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        node.wait(lambda: states and abs(states[-1].velocity).max() > 0.05)
        client.move.cancel(slow)
        node.wait(lambda: slow.is_over)
    preempted = NUMBERS["PREEMPTED"]
    assert [outcome(each) for each in sent] == [
        (Status.SUCCEEDED, SUCCESS),
        (Status.CANCELED, preempted),
        (Status.CANCELED, preempted),
    ]
    assert outcome(running) == (Status.ABORTED, preempted)
    assert outcome(slow) == (Status.CANCELED, preempted)
    commands = read_run(tmp_path / "run").run.commands
    kinds = [each.kind for each in commands if each.kind != "end"]
    assert kinds == ["plan", "trajectory", "plan", "trajectory", "cancel", "plan", "trajectory",
                     "cancel"]  # fmt: skip
    assert replay(tmp_path / "run").digest == results[0].case.digest


LEFT = {
    "shoulder_pan_joint": 0.0, "shoulder_lift_joint": -1.2, "elbow_joint": 1.5,
    "wrist_1_joint": -1.9, "wrist_2_joint": -1.57, "wrist_3_joint": 0.0,
}  # fmt: skip
RIGHT = {**LEFT, "shoulder_pan_joint": 3.0}
CORRIDOR = (
    box("north", (0, 0.24, 1), (3, 0.02, 2)),
    box("south", (0, -0.24, 1), (3, 0.02, 2)),
    box("lid", (0, 0, 0.75), (3, 0.5, 0.02)),
)
"""Walls between which the arm cannot turn round, from LEFT to RIGHT."""
AXES = [f"absolute_{axis}_axis_tolerance" for axis in "xyz"]


@pytest.mark.nightly
def test_a_plan_ends_with_its_allowed_time_and_other_requests_are_answered_meanwhile(tmp_path):
    folder = tmp_path / "run"
    with bridge(scenario(tmp_path, HOLD, robot=UR), run={"report_dir": folder}) as (node, results):
        client = MoveGroupClient(node)
        assert client.move_to(joint_goal(LEFT)).result.error_code.val == SUCCESS
        assert client.apply(*CORRIDOR)

        def answer(**fields):
            requested = request(joint_goal(RIGHT), **fields)
            planned = client.call(
                "plan_kinematic_path", "GetMotionPlan", motion_plan_request=requested
            )
            return planned.motion_plan_response.error_code

        for allowed, checks in ((0.02, 4_000), (0.005, 1_000), (1e-9, 1)):
            code = answer(allowed_planning_time=allowed)
            assert code.val == NUMBERS["TIMED_OUT"]
            assert f"at most {checks} state checks" in code.message
            assert f"allowed_planning_time: {allowed:g} s" in code.message
        code = answer(allowed_planning_time=0.02, num_planning_attempts=8)
        assert code.val == NUMBERS["TIMED_OUT"]
        assert "8 searches with at most 500 state checks" in code.message
        level = moveit(
            "OrientationConstraint",
            link_name="end_effector_link",
            orientation=pose((0, 0, 0)).orientation,
            **dict(zip(AXES, (0.2, 0.2, 4.0), strict=True)),
        )
        code = answer(
            path_constraints=moveit("Constraints", orientation_constraints=[level]),
            allowed_planning_time=0.02,
        )
        assert code.val == NUMBERS["TIMED_OUT"]

        endless = request(joint_goal(RIGHT), allowed_planning_time=1e6)
        first, second = (
            client.move.send(message(f"{MOVE}_Goal", request=endless)) for _ in range(2)
        )
        node.wait(lambda: first.is_accepted and second.is_accepted)
        client.call("compute_fk", "GetPositionFK", fk_link_names=["end_effector_link"])
        target = moveit("PositionIKRequest", pose_stamped=stamped(pose((0.4, 0.1, 0.4))))
        client.call("compute_ik", "GetPositionIK", ik_request=target)
        assert len(client.scene().world.collision_objects) >= len(CORRIDOR)
        assert not first.is_over
        for each in (second, first):
            client.move.cancel(each)
            node.wait(lambda each=each: each.is_over)
            assert outcome(each) == (Status.CANCELED, NUMBERS["PREEMPTED"])
        assert answer(allowed_planning_time=0.005).val == NUMBERS["TIMED_OUT"]
        client.move.send(message(f"{MOVE}_Goal", request=endless))  # until the session ends
    assert results[0].case.outcome == "passed"
    assert replay(folder).digest == results[0].case.digest


@pytest.mark.nightly
def test_the_budget_of_the_scenario_is_the_most_that_a_request_may_use(tmp_path):
    own = "planning: {max_state_checks: 300}\nexpect: [{always: within_limits}]"
    with bridge(scenario(tmp_path, HOLD, own, robot=UR)) as (node, _):
        client = MoveGroupClient(node)
        assert client.move_to(joint_goal(LEFT)).result.error_code.val == SUCCESS
        assert client.apply(*CORRIDOR)
        for allowed in (0.0, -1.0, np.nan, 5.0, np.inf):
            goal = client.move_to(joint_goal(RIGHT), allowed_planning_time=allowed)
            assert goal.result.error_code.val == NUMBERS["TIMED_OUT"]
            assert "at most 300 state checks" in goal.result.error_code.message


CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.01, 0.01) for z in (-0.3, 0.3)])
FACES = ConvexHull(CORNERS).simplices
WALLS = {
    "mesh": {"meshes": [mesh(CORNERS, FACES)]},
    "cone": {"primitives": [primitive(4, 0.6, 0.3)]},
    "plane": {"planes": [message("shape_msgs/msg/Plane", coef=np.array([0, -2.0, 0, 0]))]},
}


@pytest.mark.nightly
def test_meshes_cones_and_planes_are_in_the_way_and_come_back_in_the_scene(tmp_path):
    folder = tmp_path / "run"
    with bridge(scenario(tmp_path, HOLD, robot=UR), run={"report_dir": folder}) as (node, results):
        client = MoveGroupClient(node)
        assert client.move_to(pose_goal(pose((0.4, 0.1, 0.3)))).result.error_code.val == SUCCESS

        def fraction():
            return client.call(
                "compute_cartesian_path", "GetCartesianPath",
                group_name=GROUP, waypoints=[pose((0.4, 0.5, 0.3))], max_step=0.01,
            ).fraction  # fmt: skip

        free, blocked = fraction(), {}
        at = pose((0.4, 0.35, 0.3), (0.0, 0.0, 0.0, 1.0))
        for name, shapes in WALLS.items():
            assert client.apply(moveit("CollisionObject", id=name, pose=at, **shapes)), name
            blocked[name] = fraction()
            kind = next(iter(shapes)) if name != "cone" else "meshes"
            [known] = [each for each in client.scene().world.collision_objects if each.id == name]
            assert len(getattr(known, kind)) == 1, name
            assert client.apply(moveit("CollisionObject", id=name, operation=1))
            assert fraction() == free, name
    assert free == 1.0
    assert all(0.05 < each < 0.8 for each in blocked.values()), blocked
    assert replay(folder).digest == results[0].case.digest


@pytest.mark.nightly
def test_a_whole_scene_replaces_the_one_before_and_a_scene_of_a_plan_is_of_it_alone(tmp_path):
    rest = CUBE + "expect: [{always: within_limits}]"
    folder = tmp_path / "run"
    with bridge(scenario(tmp_path, HOLD, rest, robot=UR), run={"report_dir": folder}) as (
        node,
        results,
    ):
        client = MoveGroupClient(node)

        def names():
            return sorted(each.id for each in client.scene().world.collision_objects)

        before = names()
        assert client.apply(box("wall", (0.4, 0.3, 0.3), (1, 0.02, 0.6)))
        whole = client.scene()
        apply = "apply_planning_scene", "ApplyPlanningScene"
        assert client.call(*apply, scene=whole).success, "what was sent is taken back"
        assert names() == sorted([*before, "wall"])
        whole.world.collision_objects = []
        assert client.call(*apply, scene=whole).success
        assert names() == []
        assert client.apply(moveit("CollisionObject", id="cube"))
        assert names() == ["cube"]

        def planned(*objects):
            world = moveit("PlanningSceneWorld", collision_objects=list(objects))
            diff = moveit("PlanningScene", is_diff=True, world=world)
            options = moveit("PlanningOptions", plan_only=True, planning_scene_diff=diff)
            goal = request(pose_goal(pose((0.4, 0.1, 0.3))))
            content = message(f"{MOVE}_Goal", request=goal, planning_options=options)
            return node.send(content, client.move).result.error_code.val

        assert planned(box("here", (0.4, 0.1, 0.3), [0.1] * 3)) == NUMBERS["GOAL_IN_COLLISION"]
        assert names() == ["cube"]
        assert planned() == SUCCESS
    assert replay(folder).digest == results[0].case.digest


def test_rviz_shows_plans_clears_octomaps_and_publishes_worlds(tmp_path):
    """What RViz' MotionPlanning uses besides MoveGroupInterface."""
    with bridge(scenario(tmp_path, HOLD, robot=UR)) as (node, _):
        client = MoveGroupClient(node)
        shown = node.listen("/display_planned_path", "moveit_msgs/msg/DisplayTrajectory")
        cleared, empty = [], node.graph.client("/clear_octomap", "std_srvs/srv/Empty")
        node.wait(empty.is_ready)
        empty.call(message("std_srvs/srv/Empty_Request"), cleared.append)
        worlds = node.graph.advertise("/planning_scene_world", "moveit_msgs/msg/PlanningSceneWorld")
        node.wait(lambda: worlds.subscribers and cleared)
        wall = box("wall", (0.4, 0.3, 0.3), (1, 0.02, 0.6))
        worlds.publish(moveit("PlanningSceneWorld", collision_objects=[wall]))
        names = []
        node.wait(
            lambda: (
                "wall" in names
                or names.extend(each.id for each in client.scene().world.collision_objects)
            )
        )
        plan = client.move_to(joint_goal({"elbow_joint": 1.0}), plan_only=True).result
        node.wait(lambda: shown)
        lasts = [
            each.joint_trajectory.points[-1].positions
            for each in (*shown[-1].trajectory, plan.planned_trajectory)
        ]
        assert np.array_equal(*lasts)
        assert shown[-1].trajectory_start.joint_state.name == plan.trajectory_start.joint_state.name
