"""What RViz' MotionPlanning sends, in its order, by rclpy; prints JSON."""

import json
import sys
import threading
import time

import rclpy
from geometry_msgs.msg import Pose
from moveit_msgs.action import ExecuteTrajectory, MoveGroup
from moveit_msgs.msg import (
    CollisionObject,
    Constraints,
    DisplayTrajectory,
    JointConstraint,
    PlanningScene,
    PlanningSceneComponents,
)
from moveit_msgs.srv import GetCartesianPath, GetPlanningScene, QueryPlannerInterfaces
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import String
from std_srvs.srv import Empty

GROUP = "ur_manipulator"
EVERYTHING = 1023  # all components of a scene
EPSILON = 2.220446049250313e-16  # tolerance of constructGoalConstraints [rad]
rclpy.init()
node = Node("rviz")
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
heard = {}


def listen(kind, topic, qos=10):
    messages = heard.setdefault(topic, [])
    node.create_subscription(kind, topic, messages.append, qos)


def until(holds):
    end = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < end, "no answer"
        time.sleep(0.001)


def wait(future):
    until(future.done)
    return future.result()


def call(kind, name, request):
    client = node.create_client(kind, name)
    assert client.wait_for_service(30), name
    return wait(client.call_async(request))


def act(client, goal):
    assert client.wait_for_server(30)
    return wait(wait(client.send_goal_async(goal)).get_result_async())


def scene():
    components = PlanningSceneComponents(components=EVERYTHING)
    return call(
        GetPlanningScene, "/get_planning_scene", GetPlanningScene.Request(components=components)
    ).scene


def goal(state, plan_only):
    """A motion from a whole state to joint positions of the group, one of which is another."""
    made = MoveGroup.Goal()
    request = made.request
    request.group_name, request.pipeline_id, request.planner_id = GROUP, "ompl", "RRTConnect"
    request.num_planning_attempts, request.allowed_planning_time = 10, 5.0
    request.max_velocity_scaling_factor = request.max_acceleration_scaling_factor = 0.3
    request.start_state = state
    for corner, value in (
        (request.workspace_parameters.min_corner, -1.0),
        (request.workspace_parameters.max_corner, 1.0),
    ):
        corner.x = corner.y = corner.z = value
    positions = dict(zip(state.joint_state.name, state.joint_state.position, strict=True))
    positions["elbow_joint"] += 0.7
    request.goal_constraints = [
        Constraints(
            joint_constraints=[
                JointConstraint(
                    joint_name=name,
                    position=positions[name],
                    weight=1.0,
                    tolerance_above=EPSILON,
                    tolerance_below=EPSILON,
                )
                for name in state.joint_state.name[:6]
            ]
        )
    ]
    options = made.planning_options
    options.plan_only = plan_only
    options.planning_scene_diff.is_diff = options.planning_scene_diff.robot_state.is_diff = True
    return made


for topic in ("/robot_description", "/robot_description_semantic"):
    listen(String, topic, latched)
listen(PlanningScene, "/monitored_planning_scene", latched)
listen(DisplayTrajectory, "/display_planned_path")
planners = call(
    QueryPlannerInterfaces, "/query_planner_interface", QueryPlannerInterfaces.Request()
)
before = scene()
move = ActionClient(node, MoveGroup, "/move_action")
execute = ActionClient(node, ExecuteTrajectory, "/execute_trajectory")
plan = act(move, goal(before.robot_state, plan_only=True))
until(lambda: heard["/display_planned_path"])
executed = act(execute, ExecuteTrajectory.Goal(trajectory=plan.result.planned_trajectory))
both = act(move, goal(scene().robot_state, plan_only=False))
waypoint = Pose()
waypoint.position.x, waypoint.position.y, waypoint.position.z = 0.4, 0.2, 0.4
waypoint.orientation.x, waypoint.orientation.w = 1.0, 0.0
line = call(
    GetCartesianPath,
    "/compute_cartesian_path",
    GetCartesianPath.Request(
        group_name=GROUP,
        start_state=scene().robot_state,
        waypoints=[waypoint],
        max_step=0.01,
        avoid_collisions=True,
        link_name="end_effector_link",
    ),
)
changed = scene()  # the whole scene with another object, which it publishes before it plans
wall = CollisionObject(id="Box_0", pose=Pose())
wall.header.frame_id, wall.pose.position.y = "world", 0.6
wall.primitives = [SolidPrimitive(type=SolidPrimitive.BOX, dimensions=[0.2, 0.2, 0.2])]
wall.primitive_poses = [Pose()]
changed.world.collision_objects = [*changed.world.collision_objects, wall]
publisher = node.create_publisher(PlanningScene, "/planning_scene", 1)
until(publisher.get_subscription_count)
publisher.publish(changed)
until(
    lambda: any(
        each.id == "Box_0"
        for each in heard["/monitored_planning_scene"][-1].world.collision_objects
    )
)
call(Empty, "/clear_octomap", Empty.Request())
sys.stdout.write(
    json.dumps(
        {
            "descriptions": sorted(
                heard[each][-1].data.lstrip()[:6] for each in heard if "description" in each
            ),
            "pipelines": [each.pipeline_id for each in planners.planner_interfaces],
            "plan": [plan.status, plan.result.error_code.val],
            "shown": len(heard["/display_planned_path"][0].trajectory),
            "execute": [executed.status, executed.result.error_code.val],
            "plan and execute": [both.status, both.result.error_code.val],
            "line": line.error_code.val,
            "added": sorted(
                {each.id for each in scene().world.collision_objects}
                - {each.id for each in before.world.collision_objects}
            ),
        }
    )
)
