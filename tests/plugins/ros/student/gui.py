"""What ROBOTIS' GUI of the OpenMANIPULATOR-X sends for each button, by rclpy; prints JSON.

The GUI (open_manipulator_gui, src/open_manipulator_x/qnode.cpp) is C++ with Qt on two
MoveGroupInterfaces, of `arm` and `gripper`; the fields of their requests are those that
move_group_interface.cpp of moveit2 fills.
"""

import json
import sys
import threading
import time

import rclpy
from geometry_msgs.msg import Pose
from moveit_msgs.action import ExecuteTrajectory, MoveGroup
from moveit_msgs.msg import (
    AttachedCollisionObject,
    Constraints,
    JointConstraint,
    OrientationConstraint,
    PositionConstraint,
)
from moveit_msgs.srv import (
    GetCartesianPath,
    GetPlannerParams,
    QueryPlannerInterfaces,
    SetPlannerParams,
)
from rclpy.action import ActionClient
from rclpy.duration import Duration
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSPresetProfiles, QoSProfile
from sensor_msgs.msg import JointState
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import String
from std_srvs.srv import SetBool

ARM = ("joint1", "joint2", "joint3", "joint4")
GRIPPER = ("gripper_left_joint", "gripper_right_joint")  # the latter follows the former
NEAR = 0.03  # how close to its target the GUI calls a motion complete [rad]
rclpy.init()
node = rclpy.create_node(
    "open_manipulator_x_gui",
    parameter_overrides=[Parameter("use_sim_time", value=True)],
)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
default = QoSPresetProfiles.SYSTEM_DEFAULT.value
descriptions, states = {}, []


def until(holds, what):
    end = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < end, f"no {what}"
        time.sleep(0.001)


def description(topic):
    """A description as RDFLoader takes it: from a latched topic, where no parameter has it."""
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(
        String, topic, lambda text: descriptions.setdefault(topic, text.data), latched
    )
    until(lambda: topic in descriptions, topic)


class Interface:
    """One MoveGroupInterface."""

    def __init__(self, group):
        self.group, self.position_tolerance, self.orientation_tolerance = group, 1e-4, 1e-3
        self.stopping = node.create_publisher(String, "trajectory_execution_event", 1)
        node.create_publisher(AttachedCollisionObject, "attached_collision_object", 1)
        self.client = ActionClient(node, MoveGroup, "move_action")
        assert self.client.wait_for_server(60)
        self.execute = ActionClient(node, ExecuteTrajectory, "execute_trajectory")
        assert self.execute.wait_for_server(60)
        for kind, name in (
            (QueryPlannerInterfaces, "query_planner_interface"),
            (GetPlannerParams, "get_planner_params"),
            (SetPlannerParams, "set_planner_params"),
            (GetCartesianPath, "compute_cartesian_path"),
        ):
            node.create_client(kind, name, qos_profile=default)

    def goal(self, constraints, plan_only):
        goal = MoveGroup.Goal()
        request, options = goal.request, goal.planning_options
        request.group_name, request.num_planning_attempts = self.group, 1
        request.max_velocity_scaling_factor = request.max_acceleration_scaling_factor = 0.1
        request.allowed_planning_time, request.start_state.is_diff = 5.0, True
        request.goal_constraints = [constraints]
        options.plan_only = plan_only
        options.replan_delay = 0.0 if plan_only else 2.0
        options.planning_scene_diff.is_diff = options.planning_scene_diff.robot_state.is_diff = True
        return goal

    def send(self, constraints, *, plan_only):
        sent = self.client.send_goal_async(self.goal(constraints, plan_only))
        until(sent.done, "answer to a goal")
        return sent.result().get_result_async()

    def plan_and_move(self, constraints, meanwhile=lambda _: None):
        """`plan`, and `move` where it succeeds, which plans again; the error codes of both."""
        codes = []
        for plan_only in (True, False):
            ended = self.send(constraints, plan_only=plan_only)
            if not plan_only:
                meanwhile(ended)
            until(ended.done, "result")
            codes.append(ended.result().result.error_code.val)
            if codes[-1] != 1:
                break
        return codes

    def stop(self):
        self.stopping.publish(String(data="stop"))


def current(names):
    """Joint positions that are not older than now, in simulated time."""
    now = node.get_clock().now().nanoseconds

    def is_new():
        stamp = states[-1].header.stamp if states else None
        return stamp and stamp.sec * 10**9 + stamp.nanosec >= now

    until(is_new, "new joint state")
    found = dict(zip(states[-1].name, states[-1].position, strict=True))
    return [found[name] for name in names]


def joint_constraints(names, values):
    return Constraints(
        joint_constraints=[
            JointConstraint(
                joint_name=name,
                position=float(value),
                tolerance_above=1e-4,
                tolerance_below=1e-4,
                weight=1.0,
            )
            for name, value in zip(names, values, strict=True)
        ]
    )


def joint_space(values, meanwhile=lambda _: None):
    """The buttons of poses and of joint angles, and each line that is played."""
    current(ARM)
    codes = arm.plan_and_move(joint_constraints(ARM, values), meanwhile)
    reached = zip(current(ARM), values, strict=True)
    return [*codes, all(abs(each - value) <= NEAR for each, value in reached)]


def task_space(pose, position_only, tolerance=0.05):
    """The button of a pose; the tolerances are what its two boxes show at first."""
    goal = Constraints()
    place = PositionConstraint(link_name="end_effector_link", weight=1.0)
    place.header.frame_id = "world"
    sphere = SolidPrimitive(type=SolidPrimitive.SPHERE, dimensions=[tolerance])
    place.constraint_region.primitives = [sphere]
    turn = OrientationConstraint(link_name="end_effector_link", weight=1.0, header=place.header)
    turn.parameterization = OrientationConstraint.ROTATION_VECTOR
    turn.absolute_x_axis_tolerance = turn.absolute_y_axis_tolerance = tolerance
    turn.absolute_z_axis_tolerance = tolerance
    at = Pose()
    at.position.x, at.position.y, at.position.z = pose[:3]
    place.constraint_region.primitive_poses = [at]
    turn.orientation.x, turn.orientation.y, turn.orientation.z, turn.orientation.w = pose[3:]
    goal.position_constraints = [place]
    if not position_only:
        goal.orientation_constraints = [turn]
    return arm.plan_and_move(goal)


def tool(value):
    """The buttons of the gripper; what still moves after two seconds is stopped.

    The seconds are simulated ones here, so that a busy machine does not matter.
    """
    current(GRIPPER)

    def stop(ended):
        end = node.get_clock().now() + Duration(seconds=2)
        until(lambda: ended.done() or node.get_clock().now() >= end, "time")
        if not ended.done():
            gripper.stop()

    codes = gripper.plan_and_move(joint_constraints(GRIPPER, [value] * 2), stop)
    return [*codes, round(current(GRIPPER)[0], 3)]


for name in ("robot_description", "robot_description_semantic"):
    description(name)
arm, gripper = Interface("arm"), Interface("gripper")
node.create_subscription(JointState, "joint_states", states.append, default)
torque = node.create_client(SetBool, "dynamixel_hardware_interface/set_dxl_torque")
said = {"home": joint_space([0.0, -1.0, 0.7, 0.3]), "init": joint_space([0.0] * 4)}
said["close"] = tool(-0.01)
for name, angles in (("before", [0.0, -0.442, 0.672, 0.07]), ("at", [0.0, -0.147, 0.988, -0.541])):
    tool(0.019)
    said[f"{name} the box"] = joint_space(angles)
said["grip"] = tool(-0.01)[:2]
said["lift"] = joint_space([0.0, -0.442, 0.672, 0.07])
said["release"] = tool(0.019)
said["angles"] = joint_space([0.5, -0.479, 0.332, 0.141])
said["position"] = task_space([0.15, 0.05, 0.2, 0.0, 0.0, 0.0, 1.0], position_only=True)
joint_space([0.0, -1.0, 0.7, 0.3])
said["pose"] = task_space([0.134, 0.0, 0.241, 0.0, 0.0, 0.0, 1.0], position_only=False)
said["stopped"] = joint_space([1.0, 0.0, 0.0, 0.0], lambda _: (time.sleep(0.5), arm.stop()))
said["torque"] = torque.wait_for_service(timeout_sec=1.0)
sys.stdout.write(json.dumps(said))
