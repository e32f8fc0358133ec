"""A client of MoveIt's interface without ROS: it sends what MoveGroupInterface sends."""

import numpy as np

from harness.plugins.ros.actions import ActionClient
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.interfaces import EXECUTE, MOVE, register_move_group

register_move_group()

UR = "{model: ur5e, gripper: rh_p12_rn_a}"
GROUP = "ur_manipulator"
DOWN = (1.0, 0.0, 0.0, 0.0)
"""The orientation of a gripper that points down: x, y, z, w."""


class MoveGroupClient:
    """Calls the services and actions of a bridge through a node of its domain."""

    def __init__(self, node):
        self.node = node
        self.move = ActionClient(node.graph, "/move_action", MOVE)
        self.execute = ActionClient(node.graph, "/execute_trajectory", EXECUTE)
        node.wait(lambda: self.move.is_ready and self.execute.is_ready)
        self._clients = {}

    def call(self, name, kind, **fields):
        kind = f"moveit_msgs/srv/{kind}"
        if name not in self._clients:
            self._clients[name] = self.node.graph.client(f"/{name}", kind)
            self.node.wait(self._clients[name].is_ready)
        answers = []
        self._clients[name].call(message(f"{kind}_Request", **fields), answers.append)
        self.node.wait(lambda: answers)
        return answers[0]

    def move_to(self, constraints, *, plan_only=False, **fields):
        options = moveit("PlanningOptions", plan_only=plan_only)
        goal = message(
            f"{MOVE}_Goal", request=request(constraints, **fields), planning_options=options
        )
        return self.node.send(goal, self.move)

    def follow(self, trajectory):
        return self.node.send(message(f"{EXECUTE}_Goal", trajectory=trajectory), self.execute)

    def scene(self):
        return self.call("get_planning_scene", "GetPlanningScene").scene

    def apply(self, *objects, attached=()):
        state = moveit("RobotState", attached_collision_objects=list(attached), is_diff=True)
        world = moveit("PlanningSceneWorld", collision_objects=list(objects))
        scene = moveit("PlanningScene", is_diff=True, world=world, robot_state=state)
        return self.call("apply_planning_scene", "ApplyPlanningScene", scene=scene).success


def moveit(kind, **fields):
    return message(f"moveit_msgs/msg/{kind}", **fields)


def pose(xyz, quaternion=DOWN):
    position = message("geometry_msgs/msg/Point", **dict(zip("xyz", map(float, xyz), strict=True)))
    turn = message("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", quaternion, strict=True)))
    return message("geometry_msgs/msg/Pose", position=position, orientation=turn)


def stamped(at, frame=""):
    header = message("std_msgs/msg/Header", frame_id=frame)
    return message("geometry_msgs/msg/PoseStamped", header=header, pose=at)


def primitive(kind, *sizes):
    return message("shape_msgs/msg/SolidPrimitive", type=kind, dimensions=np.array(sizes, float))


def mesh(corners, faces):
    points = [
        message("geometry_msgs/msg/Point", **dict(zip("xyz", map(float, each), strict=True)))
        for each in corners
    ]
    triangles = [
        message("shape_msgs/msg/MeshTriangle", vertex_indices=np.array(each, np.uint32))
        for each in faces
    ]
    return message("shape_msgs/msg/Mesh", vertices=points, triangles=triangles)


def box(name, xyz, size, **fields):
    return moveit(
        "CollisionObject",
        id=name,
        pose=pose(xyz, (0.0, 0.0, 0.0, 1.0)),
        primitives=[primitive(1, *size)],
        primitive_poses=[pose((0, 0, 0), (0.0, 0.0, 0.0, 1.0))],
        **fields,
    )


def joint_goal(positions):
    each = [
        moveit("JointConstraint", joint_name=n, position=float(v)) for n, v in positions.items()
    ]
    return moveit("Constraints", joint_constraints=each)


def pose_goal(at, link="end_effector_link", frame="", *, region=None, tolerance=0.001):
    header = message("std_msgs/msg/Header", frame_id=frame)
    region = region or moveit(
        "BoundingVolume", primitives=[primitive(2, 0.001)], primitive_poses=[at]
    )
    place = moveit("PositionConstraint", header=header, link_name=link, constraint_region=region)
    axes = {f"absolute_{axis}_axis_tolerance": tolerance for axis in "xyz"}
    turn = moveit(
        "OrientationConstraint", header=header, link_name=link, orientation=at.orientation, **axes
    )
    return moveit("Constraints", position_constraints=[place], orientation_constraints=[turn])


def request(*constraints, group=GROUP, **fields):
    return moveit(
        "MotionPlanRequest",
        group_name=group,
        goal_constraints=list(constraints),
        **{"max_velocity_scaling_factor": 1.0, "max_acceleration_scaling_factor": 1.0, **fields},
    )
