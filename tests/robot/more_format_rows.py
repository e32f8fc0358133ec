"""What of xacro, MJCF and calibration files is read, ignored, refused: rows that are test cases."""

from __future__ import annotations

import numpy as np

from tests.robot.arm_files import URDF
from tests.robot.format_rows import END, FRAME, ignored, link, read, refused
from tests.robot.mjcf_arm import LINKAGE, MJCF

NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
XACRO = (
    URDF.replace('name="three"', f'name="three" {NAMESPACE}')
    .replace(
        '  <link name="base_link">',
        '  <xacro:arg name="high" default="0.1"/>\n'
        '  <xacro:property name="far" value="0.2"/>\n  <link name="base_link">',
    )
    .replace('<origin xyz="0 0 0.1"/><axis', '<origin xyz="0 0 $(arg high)"/><axis')
    .replace('<origin xyz="0 0 0.2"/><axis xyz="0 1', '<origin xyz="0 0 ${far}"/><axis xyz="0 1')
)
PARTS = {
    "more.xacro": f'<?xml version="1.0"?>\n<robot {NAMESPACE}>{FRAME}</robot>\n',
    "sizes.yaml": "far: 0.4\n",
}
"""Files next to the xacro file, and in its package `parts`."""

FAR = '"far" value="0.2"'
MACRO = (
    '<xacro:macro name="tip" params="name:=more"><link name="${name}"/><joint name="j" '
    'type="fixed"><parent link="tool"/><child link="${name}"/></joint></xacro:macro><xacro:tip/>'
)
INCLUDE = '<xacro:include filename="{}"/>' + END


def height(arm, joint):
    """Of a joint above the one before [m]."""
    return round(float(arm.joint_by_name[joint].pose.translation[2]), 9)


def has_more(arm):
    """Whether the link `more` is there."""
    return "more" in arm.link_names


XACRO_ROWS = (
    read("`<xacro:arg>`, `$(arg ...)`", "of `args:`, else as the file has it", 'default="0.1"',
         'default="0.3"', lambda arm: height(arm, "turn") == 0.3),
    read("`<xacro:property>`, `${...}`", "expressions: see below", FAR,
         '"far" value="${2 * 0.25}"', lambda arm: height(arm, "bend") == 0.5),
    read("`<xacro:macro>`", "with parameters, defaults and blocks", END, MACRO + END, has_more),
    read("`<xacro:if>`, `<xacro:unless>`", "", END,
         f'<xacro:if value="${{1 &lt; 2}}">{FRAME}</xacro:if>' + END, has_more),
    read("`<xacro:include>`", "of the given folders", END, INCLUDE.format("more.xacro"), has_more),
    read("`$(find name)`, `package://`", "lead where `package://` does in a URDF", END,
         INCLUDE.format("$(find parts)/more.xacro"), has_more),
    read("`xacro.load_yaml(...)`", "of the given folders", FAR,
         "\"far\" value=\"${xacro.load_yaml('sizes.yaml')['far']}\"",
         lambda arm: height(arm, "bend") == 0.4),
    read("`$(eval ...)`", "as far as xacro reads it", FAR, '"far" value="$(eval high * 5)"',
         lambda arm: height(arm, "bend") == 0.5),
    read("`$(optenv NAME default)`", "the default", FAR, '"far" value="$(optenv HOME 0.4)"',
         lambda arm: height(arm, "bend") == 0.4),
    refused("`$(env ...)`", "", FAR, '"far" value="$(env HOME)"', "HOME"),
    refused("a file outside of the given folders", "", END, INCLUDE.format("/etc/passwd"),
            "outside the robot's folder"),
    refused("a file or package that is not there", "", END, INCLUDE.format("gone.xacro"),
            "there is no file"),
    refused("files that include each other in a circle", "", END, INCLUDE.format("arm.xacro"),
            "include each other in a circle"),
    refused("an unknown macro, argument or name", "", END, "<xacro:tap/>" + END, "tap"),
    refused("a function or attribute that is not listed", "", FAR,
            "\"far\" value=\"${open('made', 'w')}\"", "open"),
    refused("what makes too much", "1,000,000 steps of a rendering, and of a result 100,000 "
            "characters, 10,000 items or 4096 bits, are the most", FAR,
            '"far" value="${[0] * 10**10}"', "more than 10000 items"),
)  # fmt: skip

BALL = '<geom type="sphere" size="0.01"/>'
SITE = '<site name="tcp" pos="0 0 0.08"/>'
ELBOW = '<joint name="elbow" axis="0 1 0" range="-120 120"/>'
WORLD = "<worldbody>"
EQUALITY = "<equality>"
SIX_JOINTS = "".join(
    f'<joint name="{kind}_{axis[0]}{axis[2]}" type="{kind}" axis="{axis}"/>'
    for kind in ("slide", "hinge")
    for axis in ("1 0 0", "0 1 0", "0 0 1")
)
MJCF_ROWS = (
    read("`<body>`, its `<inertial>`, or what its geoms weigh", "",
         '<geom type="box" size="0.02 0.03 0.1"', '<geom mass="3" type="box" size="0.02 0.03 0.1"',
         lambda arm: round(link(arm, "lower").inertial.mass, 9) == 3),
    read("`<joint>` hinge, slide", "several of a body too", ELBOW, '<joint name="elbow"/>',
         lambda arm: arm.joint_by_name["elbow"].kind == "continuous"),
    read("`range`", "a hinge without turns on and on", ELBOW, ELBOW.replace("120", "90"),
         lambda arm: round(arm.joint_by_name["elbow"].upper, 6) == 1.570796),
    read("`pos`, `ref`", "", 'ref="20"', 'ref="0"',
         lambda arm: np.allclose(arm.joint_by_name["lift"].pose.rotation, np.eye(3))),
    read("`damping`, `frictionloss`", "", 'damping="0.5"', 'damping="0.7"',
         lambda arm: arm.joint_by_name["lift"].damping == 0.7),
    ignored("`armature`, `stiffness`", "reported", ELBOW, ELBOW.replace("/>", ' armature="0.1"/>'),
            "1 joints have an armature or a spring"),
    read("`<geom>` box, sphere, cylinder, capsule, mesh",
         "of STL, OBJ, DAE, PLY or GLB files", BALL,
         BALL.replace("sphere", "capsule").replace("0.01", "0.01 0.02"),
         lambda arm: type(link(arm, "finger").collisions[0].geometry).__name__ == "Capsule"),
    ignored("other geoms", "reported; MuJoCo counts their mass", BALL,
            BALL.replace('"sphere" size="0.01"', '"ellipsoid" mass="0" size="0.01 0.01 0.02"')
            + BALL.replace("/>", ' mass="0.004188790204786391"/>'), "ellipsoid is left out"),
    read("`contype` and `conaffinity` of 0", "is drawn, and touches nothing", BALL,
         BALL.replace("/>", ' contype="0" conaffinity="0"/>'),
         lambda arm: not link(arm, "finger").collisions),
    read("`<site>`", "a frame", SITE, SITE + '<site name="more"/>', has_more),
    read("one with the name of a body or `world`", "has `_site` after its name, reported", SITE,
         SITE + '<site name="world"/>', lambda arm: "world_site" in arm.link_names
         and any("the site 'world' is called 'world_site'" in note for note in arm.notes)),
    read("`<equality>` of joints", "a mimic; of a curve the slope, reported", "0.4 0 0 0",
         "0.5 0 0 0",
         lambda arm: arm.joint_by_name["pinch"].mimic.multiplier == 0.5),
    read("`<equality>`: `<connect>` in a closed linkage", "its joints follow the driven one; "
         "how far they are from a line is reported", MJCF, LINKAGE,
         lambda arm: getattr(arm.joint_by_name.get("left_rocker"), "mimic", None) is not None),
    ignored("any other equality", "reported", EQUALITY, EQUALITY + '<weld body1="finger"/>',
            "an equality of the kind weld is ignored"),
    read("`<keyframe>`", "a state of its name", 'qpos="0.1 0.5', 'qpos="0.1 0.6',
         lambda arm: arm.start_state["lift"] == 0.6),
    read("`<contact>`: `<exclude>`", "the pair may touch", "<contact>",
         '<contact><exclude body1="base" body2="finger"/>',
         lambda arm: ("base", "finger") in arm.allowed_collisions),
    read("`actuatorfrcrange`, `forcerange`, `ctrlrange` of a motor", "the joint's effort",
         'forcerange="-50 50"', 'forcerange="-40 40"',
         lambda arm: arm.joint_by_name["pan"].effort == 40),
    ignored("`<actuator>` otherwise", "reported: every joint has the program's own servo",
            "<actuator>", '<actuator><velocity joint="slide" kv="3"/>', "4 actuators"),
    ignored("`<sensor>`", "reported", EQUALITY,
            '<sensor><jointpos joint="pan"/></sensor>' + EQUALITY,
            "1 sensors are ignored"),
    read("a fixed `<tendon>` of two joints, with an actuator", "the second follows the first",
         "<actuator>", '<tendon><fixed name="t"><joint joint="pan" coef="1"/>'
         '<joint joint="lift" coef="-2"/></fixed></tendon><actuator><motor tendon="t"/>',
         lambda arm: arm.joint_by_name["lift"].mimic.multiplier == -2
         if arm.joint_by_name["lift"].mimic else False),
    ignored("`<tendon>` otherwise", "reported", EQUALITY,
            '<tendon><fixed><joint joint="pan" coef="1"/></fixed></tendon>' + EQUALITY,
            "1 tendons are ignored"),
    ignored("geoms of the world", "reported", WORLD, WORLD + '<geom size="1"/>',
            "2 geoms of the world body"),
    ignored("bodies that are free or moved by hand", "reported", WORLD,
            WORLD + f'<body name="held" mocap="true">{BALL}</body>', "held, cube"),
    ignored("bodies that no actuator moves, where one moves others", "a scene's drawers, reported",
            "<freejoint/>", SIX_JOINTS + f'<body name="lid"><joint name="lid"/>{BALL}</body>',
            "left out: cube, lid"),
    ignored("a mesh that is not there, of a geom that touches nothing", "reported", "</asset>",
            '<mesh name="look" file="gone.obj"/></asset>', "not drawn: look"),
    ignored("`<option>`, `<visual>`, `<statistic>`", "the scenario's world says them", WORLD,
            '<option gravity="0 0 -1"/>' + WORLD),
    read("`<compiler>`, `<default>`, `<include>`, `<frame>`, `<replicate>`",
         "as MuJoCo compiles them", WORLD, '<default><joint damping="2"/></default>' + WORLD,
         lambda arm: arm.joint_by_name["elbow"].damping == 2),
    refused("a slide without a range", "", ' range="0 0.1"', "", "has no range"),
    refused("`<extension>`", "", EQUALITY, "<extension/>" + EQUALITY, "plugins are not loaded"),
    refused("`<composite>`, `<flexcomp>`", "", BALL, BALL + '<flexcomp name="a"/>',
            "deformable bodies"),
    refused("`<model>`, `<attach>`", "", "<asset>", '<asset><model name="a" file="arm.xml"/>',
            "are not attached"),
    refused("a file outside of the given folders", "", "t.obj", "/etc/passwd", "outside"),
    refused("DOCTYPE, entities", "", '<mujoco model="arm">',
            '<!DOCTYPE m><mujoco model="arm">', "a DOCTYPE"),
)  # fmt: skip

CALIBRATION_ROWS = (
    read("`shoulder` to `wrist_3`: `x` to `yaw`", "where planner and physics have the joint",
         "z: 0.16261", "z: 0.163", lambda arm: height(arm, "shoulder_pan_joint") == 0.163),
    ignored("`hash`", "", "hash: calib_1", "hash: calib_2"),
    refused("a joint or number that lacks", "", "x: 0.00021\n", "a: 0.00021\n",
            "a calibrated joint has `x`"),
    refused("one that moves the flange by more than 20 mm or 0.05 rad", "is of another type",
            "x: -0.42514", "x: -0.2", "of another type"),
)  # fmt: skip
