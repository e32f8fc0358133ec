"""A client of MoveIt on rclpy: kinematics, plans, motions, the planning scene, and their times."""

import json
import sys
import threading
import time

import rclpy
from geometry_msgs.msg import Pose
from moveit_msgs.action import ExecuteTrajectory, MoveGroup
from moveit_msgs.msg import (
    AttachedCollisionObject,
    CollisionObject,
    Constraints,
    JointConstraint,
    PlanningSceneComponents,
)
from moveit_msgs.srv import (
    ApplyPlanningScene,
    GetCartesianPath,
    GetMotionPlan,
    GetPlanningScene,
    GetPositionFK,
    GetPositionIK,
)
from rclpy.action import ActionClient
from rclpy.node import Node
from shape_msgs.msg import SolidPrimitive

GROUP = "ur_manipulator"
rclpy.init()
node = Node("move_group_client")
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
clients = {}


def wait(future):
    end = time.monotonic() + 60
    while not future.done():
        assert time.monotonic() < end, "no answer"
        time.sleep(0.0005)
    return future.result()


def call(kind, name, request):
    if name not in clients:
        clients[name] = node.create_client(kind, name)
        assert clients[name].wait_for_service(30), name
    return wait(clients[name].call_async(request))


def act(client, goal):
    assert client.wait_for_server(30)
    handle = wait(client.send_goal_async(goal))
    done = wait(handle.get_result_async())
    return [handle.accepted, done.status, done.result.error_code.val]


def median_time(kind, name, request, count):
    """The median wall time of a call [ms]."""
    times = []
    for _ in range(count):
        begin = time.monotonic()
        call(kind, name, request)
        times.append(1e3 * (time.monotonic() - begin))
    return sorted(times)[count // 2]


def pose(x, y, z, down=True):
    made = Pose()
    made.position.x, made.position.y, made.position.z = x, y, z
    made.orientation.x, made.orientation.w = (1.0, 0.0) if down else (0.0, 1.0)
    return made


def apply(**world):
    request = ApplyPlanningScene.Request()
    request.scene.is_diff = request.scene.robot_state.is_diff = True
    request.scene.world.collision_objects = world.get("objects", [])
    request.scene.robot_state.attached_collision_objects = world.get("attached", [])
    return call(ApplyPlanningScene, "/apply_planning_scene", request).success


said = {}
inverse = GetPositionIK.Request()
inverse.ik_request.group_name = GROUP
inverse.ik_request.pose_stamped.pose = pose(0.4, 0.1, 0.4)
inverse.ik_request.avoid_collisions = True
solved = call(GetPositionIK, "/compute_ik", inverse)
forward = GetPositionFK.Request(robot_state=solved.solution, fk_link_names=["end_effector_link"])
found = call(GetPositionFK, "/compute_fk", forward)
place = found.pose_stamped[0].pose.position
said["kinematics"] = [solved.error_code.val, found.error_code.val]
said["place"] = [round(value, 4) for value in (place.x, place.y, place.z)]

move = ActionClient(node, MoveGroup, "/move_action")
goal = MoveGroup.Goal()
goal.request.group_name = GROUP
goal.request.max_velocity_scaling_factor = goal.request.max_acceleration_scaling_factor = 0.5
joints = zip(solved.solution.joint_state.name, solved.solution.joint_state.position, strict=False)
goal.request.goal_constraints = [
    Constraints(
        joint_constraints=[
            JointConstraint(joint_name=name, position=position) for name, position in [*joints][:6]
        ]
    )
]
planned = GetMotionPlan.Request(motion_plan_request=goal.request)
said["milliseconds"] = {
    "compute_fk": median_time(GetPositionFK, "/compute_fk", forward, 21),
    "compute_ik": median_time(GetPositionIK, "/compute_ik", inverse, 21),
    "plan_kinematic_path": median_time(GetMotionPlan, "/plan_kinematic_path", planned, 5),
}
said["move"] = act(move, goal)
line = GetCartesianPath.Request(
    group_name=GROUP, waypoints=[pose(0.4, 0.2, 0.4)], max_step=0.01, avoid_collisions=True
)
path = call(GetCartesianPath, "/compute_cartesian_path", line)
said["line"] = [path.fraction, path.error_code.val]
execute = ActionClient(node, ExecuteTrajectory, "/execute_trajectory")
said["execute"] = act(execute, ExecuteTrajectory.Goal(trajectory=path.solution))
said["again"] = act(execute, ExecuteTrajectory.Goal(trajectory=path.solution))

wall = CollisionObject(id="wall", pose=pose(0.4, 0.3, 0.4, down=False))
wall.primitives = [SolidPrimitive(type=SolidPrimitive.BOX, dimensions=[1.0, 0.02, 1.0])]
wall.primitive_poses = [pose(0.0, 0.0, 0.0, down=False)]
said["apply"] = apply(objects=[wall])
line.waypoints = [pose(0.4, 0.5, 0.4)]
said["blocked"] = call(GetCartesianPath, "/compute_cartesian_path", line).fraction < 0.9
held = AttachedCollisionObject(link_name="end_effector_link", object=CollisionObject(id="cube"))
said["attach"] = apply(attached=[held])
components = GetPlanningScene.Request(components=PlanningSceneComponents(components=31))
scene = call(GetPlanningScene, "/get_planning_scene", components).scene
said["scene"] = sorted(each.id for each in scene.world.collision_objects)
said["attached"] = [each.object.id for each in scene.robot_state.attached_collision_objects]
sys.stdout.write(json.dumps(said))
