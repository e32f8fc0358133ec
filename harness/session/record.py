"""The robot as verdicts and reports need it."""

from __future__ import annotations

from harness.ports.kinematics import Kinematics
from harness.recording.robot_record import GripperRecord, JointRecord, LinkPlacement, RobotRecord
from harness.robot.description import RobotDescription


def robot_record(description: RobotDescription, kinematics: Kinematics) -> RobotRecord:
    """The robot without its planner and physics."""
    static = tuple(name for name in description.link_names if name in description.static_links)
    start = description.start_positions()
    return RobotRecord(
        name=description.name,
        joints=tuple(
            JointRecord(
                name=joint.name,
                kind=joint.kind,
                lower=joint.lower,
                upper=joint.upper,
                velocity=joint.velocity,
                acceleration=joint.acceleration,
                effort=joint.effort,
                is_mimic=joint.mimic is not None,
            )
            for joint in description.movable_joints
        ),
        groups={name: group.joint_names for name, group in description.groups.items()},
        named_states={
            group: {
                name: dict(state.positions) for name, state in description.states_of(group).items()
            }
            for group in description.groups
        },
        arm_group=description.arm_group,
        tcp_link=description.tcp_link,
        base_link=description.base_link,
        link_names=description.link_names,
        static_links=static,
        gripper=_gripper_record(description),
        link_visuals={link.name: link.visuals for link in description.links if link.visuals},
        urdf=description.urdf,
        srdf=description.srdf,
        static_link_poses={
            name: tuple(float(x) for x in kinematics.link_pose(start, name).as_vector())
            for name in static
        },
        placements=tuple(
            LinkPlacement(
                link=joint.child,
                parent=joint.parent,
                pose=tuple(float(x) for x in joint.pose.as_vector()),
                joint=joint.name if joint.is_movable else "",
                slides=joint.kind == "prismatic",
                axis=tuple(float(x) for x in joint.axis),
            )
            for joint in description.joints
        ),
        shapeless_links=description.shapeless_links,
    )


def _gripper_record(description: RobotDescription) -> GripperRecord | None:
    gripper = description.gripper
    if gripper is None:
        return None
    return GripperRecord(
        group=gripper.group,
        joint=gripper.joint,
        sides={side: tuple(links) for side, links in gripper.sides.items()},
        open_position=gripper.open_position,
        closed_position=gripper.closed_position,
        widths=tuple((float(q), float(width)) for q, width in gripper.widths),
        palm_link=gripper.palm_link,
    )
