"""Fields of requests that mean what they mean in MoveIt: constraints, frames, defaults, speeds."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.handover import replay
from harness.plugins.ros.moveit.planning import motion_text
from harness.plugins.ros.moveit.values import NUMBERS
from tests.plugins.ros.bridging import bridge, scenario
from tests.plugins.ros.move_group_client import (
    GROUP,
    UR,
    MoveGroupClient,
    box,
    joint_goal,
    moveit,
    pose,
    pose_goal,
    primitive,
    request,
    stamped,
)

HOLD = "- external: {}"
SUCCESS = 1
TCP = "end_effector_link"
HERE = (0.4, 0.1, 0.4)
PILZ = {"pipeline_id": "pilz_industrial_motion_planner", "planner_id": "LIN"}


@pytest.fixture
def said():
    return []


@pytest.fixture
def client(tmp_path, said):
    """A client at an arm whose gripper points down at HERE; the run replays to its digest."""
    options = {"run": {"report_dir": tmp_path / "run"}, "say": said.append}
    with bridge(scenario(tmp_path, HOLD, robot=UR), **options) as (node, results):
        made = MoveGroupClient(node)
        assert made.move_to(pose_goal(pose(HERE))).result.error_code.val == SUCCESS
        yield made
    assert replay(tmp_path / "run").digest == results[0].case.digest


def tip(client, state=None):
    """Position and rotation of the tool."""
    fields = {} if state is None else {"robot_state": state}
    found = client.call("compute_fk", "GetPositionFK", fk_link_names=[TCP], **fields)
    at = found.pose_stamped[0].pose
    turn = Rotation.from_quat([getattr(at.orientation, axis) for axis in "xyzw"])
    return np.array([at.position.x, at.position.y, at.position.z]), turn


def path(client, *waypoints, frame="", **fields):
    header = message("std_msgs/msg/Header", frame_id=frame)
    return client.call(
        "compute_cartesian_path", "GetCartesianPath", group_name=GROUP, header=header,
        waypoints=list(waypoints), link_name=TCP,
        **{"max_step": 0.01, "avoid_collisions": True, **fields},
    )  # fmt: skip


def end_of(client, trajectory):
    """The tool at the end of a trajectory."""
    joints = trajectory.joint_trajectory
    state = moveit("RobotState")
    state.joint_state.name = list(joints.joint_names)
    state.joint_state.position = joints.points[-1].positions
    return tip(client, state)


def near(link, at, *sizes):
    """A constraint of a link's position to a box, or to a sphere of one radius."""
    region = moveit(
        "BoundingVolume",
        primitives=[primitive(1 if len(sizes) == 3 else 2, *sizes)],
        primitive_poses=[pose(at, (0.0, 0.0, 0.0, 1.0))],
    )
    place = moveit("PositionConstraint", link_name=link, constraint_region=region)
    return moveit("Constraints", position_constraints=[place])


def band(name, low, high):
    middle, half = (low + high) / 2, (high - low) / 2
    joint = moveit(
        "JointConstraint", joint_name=name, position=middle, tolerance_above=half,
        tolerance_below=half,
    )  # fmt: skip
    return moveit("Constraints", joint_constraints=[joint])


@pytest.mark.nightly
def test_defaults_of_the_allowed_collision_matrix_hold_where_no_entry_is(client):
    def allow(**fields):
        scene = moveit("PlanningScene", is_diff=True)
        scene.allowed_collision_matrix = moveit("AllowedCollisionMatrix", **fields)
        return client.call("apply_planning_scene", "ApplyPlanningScene", scene=scene).success

    def entries(*names, is_allowed):
        rows = [
            moveit("AllowedCollisionEntry", enabled=np.array([is_allowed] * len(names)))
            for _ in names
        ]
        return {"entry_names": list(names), "entry_values": rows}

    def fraction():
        return path(client, pose((0.4, 0.35, 0.4))).fraction

    default = {"default_entry_names": ["wall"], "default_entry_values": np.array([True])}
    assert allow(**default)  # before there is a wall
    assert client.apply(box("wall", (0.4, 0.3, 0.3), (1, 0.02, 0.6)))
    assert fraction() == 1.0
    links = [name for name in client.scene().allowed_collision_matrix.entry_names if name != "wall"]
    assert allow(**default, **entries("wall", *links, is_allowed=False))
    assert fraction() < 0.9
    assert (
        allow(default_entry_names=["wall", *links], default_entry_values=np.array([True] * 99))
        is False
    )
    never = {"default_entry_names": ["wall", *links]}
    never["default_entry_values"] = np.array([True] + [False] * len(links))
    assert allow(**never)
    assert fraction() < 0.9


@pytest.mark.nightly
def test_kinematics_and_validity_keep_constraints(client):
    forward = client.call("compute_fk", "GetPositionFK")
    assert forward.error_code.val == NUMBERS["INVALID_LINK_NAME"]  # as MoveIt, without a name

    def solve(constraints=None, **fields):
        fields = fields or {"pose_stamped": stamped(pose(HERE))}
        requested = moveit("PositionIKRequest", group_name=GROUP, **fields)
        if constraints is not None:
            requested.constraints = constraints
        return client.call("compute_ik", "GetPositionIK", ik_request=requested)

    free = solve()
    elbow = dict(
        zip(free.solution.joint_state.name, free.solution.joint_state.position, strict=True)
    )["elbow_joint"]
    other = solve(band("elbow_joint", -np.sign(elbow) * 3 - 0.1, -np.sign(elbow) * 0.1))
    assert other.error_code.val in (SUCCESS, NUMBERS["NO_IK_SOLUTION"])
    none = solve(band("elbow_joint", 3.0, 3.1))
    assert none.error_code.val == NUMBERS["NO_IK_SOLUTION"]
    assert "break the constraint of the joint 'elbow_joint'" in none.error_code.message
    of_one = solve(pose_stamped_vector=[stamped(pose(HERE))], ik_link_names=[TCP])
    assert of_one.error_code.val == SUCCESS
    two = solve(pose_stamped_vector=[stamped(pose(HERE))] * 2, ik_link_names=[TCP] * 2)
    assert two.error_code.val == NUMBERS["FAILURE"]

    def validity(constraints):
        found = client.call("check_state_validity", "GetStateValidity", constraints=constraints)
        return found.valid, [each.result for each in found.constraint_result]

    inside, outside = near(TCP, HERE, 0.1, 0.1, 0.1), near(TCP, (0.4, 0.3, 0.4), 0.1, 0.1, 0.1)
    assert validity(inside) == (True, [True])
    assert validity(outside) == (False, [False])
    outside.joint_constraints = band("elbow_joint", elbow - 1, elbow + 1).joint_constraints
    assert validity(outside) == (False, [True, False])
    turned = moveit("OrientationConstraint", link_name=TCP)
    for axis in "xyz":
        setattr(turned, f"absolute_{axis}_axis_tolerance", 0.1)
    turned.orientation = pose(HERE).orientation
    assert validity(moveit("Constraints", orientation_constraints=[turned])) == (True, [True])
    turned.orientation = pose(HERE, (0.0, 0.0, 0.0, 1.0)).orientation
    assert validity(moveit("Constraints", orientation_constraints=[turned])) == (False, [False])


@pytest.mark.nightly
def test_waypoints_in_the_frame_of_the_link_follow_each_other(client, said):
    begin, turn = tip(client)
    ahead = pose((0, 0, 0.05), (0.0, 0.0, 0.0, 1.0))
    aside = pose((0.03, 0, 0), (0.0, 0.0, np.sin(0.2), np.cos(0.2)))
    for waypoints, shift in (
        ([ahead, ahead], [0, 0, 0.1]),
        ([aside, aside], [0.03 * (1 + np.cos(0.4)), 0.03 * np.sin(0.4), 0]),
    ):
        found = path(client, *waypoints, frame=TCP)
        assert found.fraction == 1.0
        end, _ = end_of(client, found.solution)
        assert end == pytest.approx(begin + turn.apply(shift), abs=2e-3)
    nothing = path(client)
    assert (nothing.error_code.val, nothing.fraction) == (SUCCESS, 0.0)  # as MoveIt
    assert path(client, ahead, frame=TCP, avoid_collisions=False).fraction == 1.0
    assert any("also without `avoid_collisions`" in note for note in said)


@pytest.mark.nightly
def test_a_goal_of_an_orientation_alone_turns_the_link(client, said):
    goal = pose_goal(pose(HERE, (0.0, 1.0, 0.0, 0.0)), tolerance=0.02)
    goal.position_constraints = []
    moved = client.move_to(goal)
    assert moved.result.error_code.val == SUCCESS
    at, turn = tip(client)
    assert (turn * Rotation.from_quat([0, 1, 0, 0]).inv()).magnitude() < 0.04
    assert at == pytest.approx(HERE, abs=0.02)
    level = pose_goal(pose(HERE, (0.0, np.sin(np.pi / 4), 0.0, np.cos(np.pi / 4))), tolerance=0.05)
    level.position_constraints = []
    assert client.move_to(level, plan_only=True).result.error_code.val == SUCCESS
    refused = client.move_to(level, **PILZ).result.error_code
    assert refused.val == NUMBERS["INVALID_GOAL_CONSTRAINTS"]
    assert any("Pilz takes one goal" in note for note in said)
    text = motion_text(request(level, **PILZ))
    assert text == f" by {PILZ['pipeline_id']} LIN: {TCP} turned"


@pytest.mark.nightly
def test_path_constraints_and_speeds_limit_motions_that_have_one_path(client):
    there = pose_goal(pose((0.4, 0.3, 0.4)))
    free = client.move_to(there, plan_only=True, **PILZ).result
    assert free.error_code.val == SUCCESS
    near_it = {"path_constraints": near(TCP, HERE, 0.1, 0.1, 0.1)}
    held = client.move_to(there, plan_only=True, **PILZ, **near_it).result
    assert held.error_code.val == NUMBERS["INVALID_MOTION_PLAN"]
    assert f"breaks the constraint of the position of '{TCP}'" in held.error_code.message
    wide = {"path_constraints": near(TCP, (0.4, 0.2, 0.4), 0.3)}  # a sphere
    assert client.move_to(there, plan_only=True, **PILZ, **wide).result.error_code.val == SUCCESS
    around = client.move_to(there, plan_only=True, **wide).result
    assert around.error_code.val == SUCCESS
    limit = {"cartesian_speed_limited_link": TCP, "max_cartesian_speed": 0.02}
    slow = client.move_to(there, plan_only=True, **PILZ, **limit).result
    assert duration(slow.planned_trajectory) >= 0.2 / 0.02
    assert duration(free.planned_trajectory) < 5
    line = path(client, pose((0.4, 0.2, 0.4)), **limit)
    assert duration(line.solution) >= 0.1 / 0.02


def duration(trajectory):
    last = trajectory.joint_trajectory.points[-1].time_from_start
    return last.sec + last.nanosec * 1e-9


@pytest.mark.nightly
def test_objects_of_a_start_state_are_held_in_its_plan_alone(client):
    there = joint_goal({"shoulder_pan_joint": 0.3})
    assert client.move_to(there, plan_only=True).result.error_code.val == SUCCESS
    plate = moveit(
        "AttachedCollisionObject",
        link_name=TCP,
        object=box("plate", (*HERE[:2], 0.2), (0.1, 0.1, 0.45)),
    )
    state = moveit("RobotState", is_diff=True, attached_collision_objects=[plate])
    refused = client.move_to(there, plan_only=True, start_state=state).result
    assert refused.error_code.val == NUMBERS["START_STATE_IN_COLLISION"]
    assert not client.scene().robot_state.attached_collision_objects
    assert client.move_to(there, plan_only=True).result.error_code.val == SUCCESS
