"""What of URDF, SRDF and MoveIt's files is read, ignored, refused: rows that are test cases.

A row changes one of the files of an arm that is fine. *Read*: the change makes a difference that
`holds` sees. *Ignored*: the robot stays the same, and a note reports it unless it has no effect.
*Refused*: an error at the place.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from harness.robot.description import RobotDescription
from tests.robot.arm_files import INERTIAL as MASS
from tests.robot.arm_files import LIMIT, SHAPE

Holds = Callable[[RobotDescription], object]

LIMITS = """joint_limits:
  bend:
    has_velocity_limits: true
    max_velocity: 2
"""
KINEMATICS = """manipulator:
  kinematics_solver: kdl_kinematics_plugin/KDLKinematicsPlugin
"""
FINGER = (
    '<link name="{0}"><inertial><mass value="0.05"/><inertia ixx="1e-5" iyy="1e-5" izz="1e-5"/>'
    '</inertial><collision><origin xyz="0 {1} 0.05"/><geometry><box size="0.02 0.01 0.06"/>'
    '</geometry></collision></link><joint name="{0}_joint" type="prismatic"><parent link="tool"/>'
    '<child link="{0}"/><axis xyz="0 {2} 0"/><limit lower="0" upper="0.03" velocity="0.1" '
    'effort="40"/></joint>'
)
HAND = FINGER.format("left", 0.01, 1) + FINGER.format("right", -0.01, -1).replace(
    'effort="40"/>', 'effort="40"/><mimic joint="left_joint"/>'
)
END = "</robot>"


@dataclass(frozen=True)
class Row:
    """A line of the table.

    Attributes:
        word: As the page shows it.
        here: What becomes of it.
        meaning: In a few words, for people.
        old: In the file; it is replaced.
        new: What stands there then.
        holds: For what is read: true of the robot with the change, and false of that without.
        reported: In a note of what is ignored, or in the error of what is refused.
    """

    word: str
    here: Literal["read", "ignored", "refused"]
    meaning: str
    old: str
    new: str
    holds: Holds | None = None
    reported: str = ""


def read(word: str, meaning: str, old: str, new: str, holds: Holds, reported: str = "") -> Row:
    """A row of what makes a difference."""
    return Row(word, "read", meaning, old, new, holds, reported)


def ignored(word: str, meaning: str, old: str, new: str, reported: str = "") -> Row:
    """A row of what makes none."""
    return Row(word, "ignored", meaning, old, new, None, reported)


def refused(word: str, meaning: str, old: str, new: str, reported: str) -> Row:
    """A row of what is an error."""
    return Row(word, "refused", meaning, old, new, None, reported)


def link(arm: RobotDescription, name: str):
    """A link by its name."""
    return next(each for each in arm.links if each.name == name)


def shape(arm: RobotDescription):
    """What kind of solid the first shape of `upper` is."""
    return type(link(arm, "upper").collisions[0].geometry).__name__


LINK_UPPER = '<link name="upper">'
CYLINDER = '<cylinder radius="0.03" length="0.14"/>'
VISUAL = '<visual><geometry>{}</geometry><material name="red"/></visual>'
RED = '<color rgba="1 0 0 1"/>'
MESH = '<mesh filename="{}"/>'
FRAME = (
    '<link name="more"/><joint name="j" type="fixed">'
    '<parent link="tool"/><child link="more"/></joint>'
)
MIMIC = '<mimic joint="bend" multiplier="0.1" offset="0.02"/>'
CONTROL = (
    '<ros2_control name="c" type="system"><joint name="bend"><command_interface name="{}">'
    '<param name="min">-0.9</param><param name="max">0.9</param></command_interface></joint>'
    "</ros2_control>"
)
URDF_ROWS = (
    read("`<link>`", "a rigid body, or a frame if it has no mass and no shape", END,
          FRAME + END, lambda arm: "more" in arm.link_names),
    read("`<inertial>`: `<mass>`, `<origin>`, `<inertia>`", "turned into link axes",
          '<mass value="1"/>', '<mass value="2"/>', lambda arm: link(arm,
          "upper").inertial.mass == 2),
    read("an inertia that no body has", "taken as the nearest possible one, reported",
          'izz="0.002"', 'izz="0.9"',
          lambda arm: any("no body has the principal moments" in note for note in arm.notes)),
    refused("a mass below zero", "", '<mass value="1"/>', '<mass value="-1"/>', "weighs -1 kg"),
    read("no `<inertial>`", "where a joint moves it: 1000 kg/m^3 of its shapes, reported",
          LINK_UPPER + MASS, LINK_UPPER,
          lambda arm: abs(link(arm, "upper").inertial.mass - 0.396) < 1e-3),
    read("no `<inertia>`, or one of zeros", "that of its shapes at its mass, reported",
          '<inertia ixx="0.01" iyy="0.01" izz="0.002"/>', "",
          lambda arm: any("no inertia is given" in note for note in arm.notes)),
    read("no `<inertial>` and no shape",
          "where a joint moves it: a thousandth of what it carries, or 1 g, reported",
          LINK_UPPER + MASS + SHAPE, LINK_UPPER,
          lambda arm: 0 < link(arm, "upper").inertial.mass < 0.01),
    read("a mass of zero", "counts as none", '<mass value="1"/>', '<mass value="0"/>',
          lambda arm: abs(link(arm, "upper").inertial.mass - 0.396) < 1e-3),
    read("`<collision>`, `<visual>`", "each with its `<origin>`", SHAPE, SHAPE + SHAPE,
          lambda arm: len(link(arm, "upper").collisions) == 2),
    read("`<box>`", "full size", CYLINDER, '<box size="0.1 0.1 0.1"/>',
          lambda arm: shape(arm) == "Box"),
    read("`<cylinder>`", "", CYLINDER, '<cylinder radius="0.02" length="0.1"/>',
          lambda arm: link(arm, "upper").collisions[0].geometry.radius == 0.02),
    read("`<sphere>`", "", CYLINDER, '<sphere radius="0.05"/>',
          lambda arm: shape(arm) == "Sphere"),
    read("`<capsule>`", "`radius` and `length`, beyond URDF", CYLINDER,
          '<capsule radius="0.02" length="0.1"/>', lambda arm: shape(arm) == "Capsule"),
    *(
        read(f"`<mesh>` of {suffix.upper()}", meaning, CYLINDER, MESH.format(f"part.{suffix}"),
              lambda arm: shape(arm) == "Mesh")
        for suffix, meaning in (
            ("stl", "its convex parts touch; `scale` counts"),
            ("obj", "the same"),
            ("dae", "the same; `unit` counts, `up_axis` does not, as in RViz"),
            ("ply", "the same"),
            ("glb", "the same; its axes are kept"),
        )
    ),
    ignored("`<visual>` with another mesh", "is not drawn, reported", SHAPE,
             SHAPE + VISUAL.format(MESH.format("part.3ds")), "'part.3ds' is not a"),
    ignored("`<visual>` with a mesh that is not there", "the same", SHAPE,
             SHAPE + VISUAL.format(MESH.format("gone.stl")), "'gone.stl' is not there"),
    refused("`<collision>` with another mesh", "", CYLINDER, MESH.format("part.3ds"),
             "not a STL, OBJ, DAE, PLY or GLB file"),
    ignored("a shape without a thickness", "reported", SHAPE,
             SHAPE + SHAPE.replace(CYLINDER, '<box size="5 5 0"/>'), "has no thickness"),
    refused("any other shape", "", CYLINDER, '<cone radius="1"/>', "unknown geometry <cone>"),
    read("`<material>`, `<color>`", "by name or in place", SHAPE,
          SHAPE + VISUAL.format(CYLINDER).replace("/></v", f">{RED}</material></v"),
          lambda arm: [s.rgba for s in link(arm, "upper").visuals] == [(1.0, 0.0, 0.0, 1.0)]),
    ignored("`<texture>`", "looks are plain colours", '<link name="tool"/>',
             '<link name="tool"/><material name="wood"><texture filename="wood.png"/></material>'),
    read("`<joint>` fixed, revolute, continuous, prismatic", "", 'name="bend" type="revolute"',
          'name="bend" type="continuous"',
          lambda arm: arm.joint_by_name["bend"].kind == "continuous"),
    refused("floating, planar", "an arm has a fixed base", 'name="bend" type="revolute"',
             'name="bend" type="floating"', "an arm has a fixed base"),
    read("`<origin>`", "", '<origin xyz="0 0 0.1"/><axis', '<origin xyz="0 0 0.3"/><axis',
          lambda arm: arm.joint_by_name["turn"].pose.translation[2] == 0.3),
    read("`<axis>`", "of any length but none", '<axis xyz="0 1 0"/>', '<axis xyz="0 0 3"/>',
          lambda arm: list(arm.joint_by_name["bend"].axis) == [0, 0, 1]),
    read("`<limit>` lower, upper", "needed by revolute and prismatic", LIMIT,
          LIMIT.replace('"2" v', '"1" v'), lambda arm: arm.joint_by_name["bend"].upper == 1),
    refused("no `<limit>`", "of a revolute or prismatic joint that follows none", LIMIT, "",
             "has no <limit>"),
    read("lower = upper", "fixed there, with what follows it, reported", LIMIT,
          LIMIT.replace("-2", "2"), lambda arm: "bend" not in arm.joint_names),
    read("`velocity`, `effort`", "zero or less counts as none, reported",
          LIMIT, LIMIT.replace('velocity="2"', 'velocity="0"'),
          lambda arm: any("the velocity limit of 0" in note for note in arm.notes)),
    read("`<mimic>`", "followed in planning and in physics, over several joints if need be",
          '<limit lower="0"', MIMIC + '<limit lower="0"',
          lambda arm: arm.joint_by_name["reach"].mimic is not None),
    refused("`<mimic>` of itself, a fixed or an unknown joint", "", '<limit lower="0"',
             '<mimic joint="reach"/><limit lower="0"', "mimic each other in a circle"),
    read("`<safety_controller>` soft limits", "narrow the position, as MoveIt has it", LIMIT,
          LIMIT + '<safety_controller soft_lower_limit="-1" soft_upper_limit="1" k_velocity="0"/>',
          lambda arm: arm.joint_by_name["bend"].lower == -1),
    ignored("`k_position`, `k_velocity`", "no controller here has them", LIMIT,
             LIMIT + '<safety_controller k_position="100" k_velocity="10"/>'),
    read("`<dynamics>` damping, friction", "in physics", LIMIT,
          LIMIT + '<dynamics damping="0.5"/>',
          lambda arm: arm.joint_by_name["bend"].damping == 0.5),
    ignored("`<calibration>`", "of a joint's encoder", LIMIT, LIMIT + '<calibration rising="0"/>'),
    ignored("`<ros2_control>` command interfaces", "joints are driven by effort all the same",
             END, CONTROL.format("acceleration") + END),
    read("their `min`, `max`", "narrow position, velocity and effort", END,
          CONTROL.format("velocity") + END, lambda arm: arm.joint_by_name["bend"].velocity == 0.9),
    ignored("a `min` of a velocity or effort from zero on", "reported; `max` counts", END,
             CONTROL.format("velocity").replace("-0.9", "0").replace(">0.9", ">9") + END,
             "limits no magnitude"),
    ignored("`<ros2_control>` of a joint that is not there", "reported", END,
             CONTROL.format("position").replace("bend", "bond") + END, "no joint 'bond'"),
    ignored("`<transmission>`", "reported", END, "<transmission/>" + END,
            "1 <transmission> element"),
    ignored("`<gazebo>`", "reported", END, "<gazebo/>" + END, "1 <gazebo> element"),
    read("its `<mu1>`, `<mu2>`", "the smaller one is the friction of a gripper's pads, reported",
         END, '<gazebo reference="left"><mu1>0.3</mu1><mu2>0.4</mu2></gazebo>' + END,
         lambda arm: arm.gripper is not None and arm.gripper.friction == 0.3),
    ignored("any other element", "reported", END, "<sensor/>" + END, "1 <sensor> element"),
    ignored("of a link or joint", "the same", SHAPE, SHAPE + "<contact/>",
             "3 <contact> elements in <link>"),
    refused("several roots, none, a circle", "", END, '<link name="loose"/>' + END,
             "one root link"),
    refused("a name twice", "", END, '<link name="tool"/>' + END, "is there twice"),
    refused("`xacro:` words", "the key `xacro` renders them", END, "<xacro:a/>" + END,
             "is xacro, and this is read as a URDF"),
    refused("DOCTYPE, entities", "", '<?xml version="1.0"?>', "<!DOCTYPE robot>", "a DOCTYPE"),
)  # fmt: skip

BENT = '<joint name="bend" value="0.7"/>'
GROUP = '<group name="manipulator"><chain base_link="base_link" tip_link="tool"/></group>'
STATE = '<group_state name="up" group="manipulator"><joint name="bend" value="{}"/></group_state>'
TOOL = '<end_effector name="e" parent_link="tool" group="{}"/>'


def joints(arm: RobotDescription, group: str = "manipulator") -> tuple[str, ...]:
    """Of a group; none where there is no such group."""
    return arm.groups[group].joint_names if group in arm.groups else ()


XACRO_STATE = (
    '<xacro:property xmlns:xacro="http://www.ros.org/wiki/xacro" name="angle" value="${pi / 8}"/>'
    '<group_state name="home" group="manipulator"><joint name="turn" value="${angle}"/>'
)
SRDF_ROWS = (
    read("xacro elements", "rendered with `args`, by the rules of xacro files",
          '<group_state name="home" group="manipulator">\n    <joint name="turn" value="0.1"/>',
          XACRO_STATE, lambda arm: abs(arm.start_state["turn"] - 0.392699) < 1e-6),
    read("`<group>` of a `<chain>`", "pose goals refer to its tip, or the gripper's TCP", GROUP,
          GROUP.replace("tool", "lower"), lambda arm: joints(arm) == ("turn", "bend")),
    read("of `<joint>`s", "", GROUP,
          '<group name="manipulator"><joint name="turn"/><joint name="bend"/></group>',
          lambda arm: joints(arm) == ("turn", "bend")),
    read("of `<link>`s", "their parent joints", GROUP,
          '<group name="manipulator"><link name="lower"/><link name="wrist"/></group>',
          lambda arm: joints(arm) == ("bend", "reach")),
    read("of `<group>`s",
          "", GROUP, GROUP + '<group name="all"><group name="manipulator"/></group>',
          lambda arm: len(joints(arm, "all")) == 3),
    refused("joints, links, groups that are not there", "", GROUP, GROUP.replace("tool", "tol"),
             "no chain leads from"),
    read("of what is not there, in a group that is no arm's", "the rest of it, reported", GROUP,
          '<group name="hand"><joint name="reach"/><joint name="thumb"/></group>' + GROUP,
          lambda arm: joints(arm, "hand") == ("reach",)
          and any(note.endswith("does not have, ignored: thumb") for note in arm.notes)),
    ignored("a group of which nothing is there", "reported; its states and end effectors too",
             GROUP, '<group name="leg"><joint name="knee"/></group>' + GROUP,
             "the URDF has nothing of it"),
    refused("groups in a circle", "", GROUP, '<group name="a"><group name="a"/></group>' + GROUP,
             "contain each other in a circle"),
    read("`<group_state>`",
          "for `named_target`; `home`, `ready` ... is where the robot starts", END,
          STATE.format("0.3") + END, lambda arm: "up" in arm.states_of("manipulator")),
    read("a state outside the limits", "kept, reported; going there fails",
          END, STATE.format("3") + END,
          lambda arm: any("outside its limits" in note for note in arm.notes)),
    refused("a state of a joint that is not there", "", END,
             STATE.format("3").replace("bend", "bond") + END, "unknown joint 'bond'"),
    read("a hand's state without its joint",
          "left out, reported; where a `robot.yaml` describes the gripper it is refused", END,
          TOOL.format("hand") + '<group name="hand"><joint name="left_joint"/></group>'
          '<group_state name="shut" group="hand"/>' + END,
          lambda arm: any(
              note.endswith("'shut' of 'hand' left out: 'left_joint' is not placed")
              for note in arm.notes)),
    ignored("several values of a joint there", "of a virtual or a fixed one; it stands still",
             BENT, BENT + '<joint name="held" value="0 0 1"/>'),
    read("`<end_effector>`", "a gripper, if one joint closes two sides; else reported", END,
          TOOL.format("hand") + '<group name="hand"><joint name="left_joint"/></group>' + END,
          lambda arm: arm.gripper.group == "hand"),
    read("`<virtual_joint>`", "fixed; floating and planar count as fixed, reported",
          '"held" type="fixed"',
          '"held" type="floating"',
          lambda arm: any("counts as fixed" in note for note in arm.notes)),
    ignored("its attributes", "any may be missing, reported",
             ' type="fixed" parent_frame="world" child_link="base_link"',
             ' parent_frame="world" child_link="base_link"', "has no 'type'"),
    read("`<passive_joint>`", "in no group", END, '<passive_joint name="reach"/>' + END,
          lambda arm: joints(arm) == ("turn", "bend")),
    read("`<disable_collisions>`", "the pair may touch", END,
          '<disable_collisions link1="base_link" link2="wrist" reason="Never"/>' + END,
          lambda arm: ("base_link", "wrist") in arm.allowed_collisions),
    ignored("`<disable_collisions>` of links that are not there", "reported", END,
             '<disable_collisions link1="base_link" link2="gone" reason="Never"/>' + END,
             "unknown links ignored: gone"),
    *(
        ignored(f"`<{tag}>`", "reported", END, f"<{tag}/>" + END, f"1 <{tag}> element")
        for tag in ("disable_default_collisions", "enable_collisions", "joint_property",
                    "link_sphere_approximation")
    ),
)  # fmt: skip

BEND = "    max_velocity: 2\n"
LIMITS_ROWS = (
    read("`has_velocity_limits`, `max_velocity`", "narrows", BEND, "    max_velocity: 0.5\n",
          lambda arm: arm.joint_by_name["bend"].velocity == 0.5),
    read("a limit wider than the URDF's", "the URDF's stays, reported", BEND,
          "    max_velocity: 9\n",
          lambda arm: any("wider velocity limit" in note for note in arm.notes)),
    read("`has_acceleration_limits`, `max_acceleration`", "as it is, for no URDF says it", BEND,
          BEND + "    has_acceleration_limits: true\n    max_acceleration: 9\n",
          lambda arm: arm.joint_by_name["bend"].acceleration == 9),
    read("`has_position_limits`, `min_position`, `max_position`", "narrow", BEND,
          BEND + "    has_position_limits: true\n    min_position: -1\n    max_position: 1.5\n",
          lambda arm: arm.joint_by_name["bend"].upper == 1.5),
    read("`has_effort_limits`, `max_effort`", "narrows", BEND,
          BEND + "    has_effort_limits: true\n    max_effort: 20\n",
          lambda arm: arm.joint_by_name["bend"].effort == 20),
    ignored("`has_jerk_limits`, `max_jerk`", "the scenario's `planning` has `max_jerk`", BEND,
             BEND + "    has_jerk_limits: true\n    max_jerk: 20\n"),
    ignored("`default_velocity_scaling_factor`, `default_acceleration_scaling_factor`",
             "the scenario's `planning` says them", "joint_limits:",
             "default_velocity_scaling_factor: 0.1\njoint_limits:"),
    refused("a joint that is not there", "", "bend:", "bond:", "bond"),
)  # fmt: skip
KINEMATICS_ROWS = (
    read("`position_only_ik`", "pose goals of the group fix the position alone",
          "  kinematics_solver",
          "  position_only_ik: true\n  kinematics_solver",
          lambda arm: arm.position_only_groups == {"manipulator"}),
    ignored("`kinematics_solver` and its numbers", "solvers are the program's own", "kdl",
             "trac_ik"),
    refused("a group that is not there", "", "manipulator:", "manipulater:", "manipulater"),
)  # fmt: skip
