"""What of a robot in SDF is read, ignored, refused: an arm, and rows that are test cases."""

import numpy as np

from tests.robot.format_rows import Row, ignored, read, refused
from tests.robot.more_format_rows import link

INERTIAL = (
    "<inertial><pose>0 0 0.1 0 0 0</pose><mass>1</mass>"
    "<inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.002</izz></inertia></inertial>"
)
CYLINDER = "<cylinder><radius>0.03</radius><length>0.14</length></cylinder>"
SHAPE = f"<collision name='c'><pose>0 0 0.1 0 0 0</pose><geometry>{CYLINDER}</geometry></collision>"
SDF = f"""<sdf version="1.9">
<model name="three">
  <link name="base">{INERTIAL}</link>
  <link name="upper"><pose relative_to="turn"/>{INERTIAL}{SHAPE}</link>
  <link name="lower"><pose relative_to="upper">0 0 0.2 0 0 0</pose>{INERTIAL}{SHAPE}</link>
  <link name="wrist"><pose>0 0 0.5 0 0 0</pose>{INERTIAL}{SHAPE}
    <visual name="v"><geometry><sphere><radius>0.05</radius></sphere></geometry></visual>
  </link>
  <link name="left"><pose relative_to="wrist">0 0.03 0.2 0 0 0</pose>{INERTIAL}</link>
  <link name="right"><pose relative_to="wrist">0 -0.03 0.2 0 0 0</pose>{INERTIAL}</link>
  <joint name="turn" type="revolute"><pose relative_to="base">0 0 0.1 0 0 0</pose>
    <parent>base</parent><child>upper</child><axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="bend" type="revolute"><parent>upper</parent><child>lower</child>
    <axis><xyz>0 1 0</xyz><limit><lower>-2</lower><upper>2</upper>
      <effort>30</effort><velocity>1.5</velocity></limit></axis></joint>
  <joint name="reach" type="prismatic"><parent>lower</parent><child>wrist</child>
    <axis><xyz>0 0 1</xyz><limit><lower>0</lower><upper>0.2</upper></limit></axis></joint>
  <joint name="open_left" type="prismatic"><parent>wrist</parent><child>left</child>
    <axis><xyz>0 1 0</xyz><limit><lower>0</lower><upper>0.04</upper></limit></axis></joint>
  <joint name="open_right" type="prismatic"><parent>wrist</parent><child>right</child>
    <axis><xyz>0 -1 0</xyz><limit><lower>0</lower><upper>0.04</upper></limit></axis></joint>
</model>
</sdf>
"""
END = "</model>"
BEND = "<axis><xyz>0 1 0</xyz><limit><lower>-2"
LIMIT = "<effort>30</effort><velocity>1.5</velocity>"
BALL = "<sphere><radius>0.05</radius></sphere>"
FOLLOWS = "<mimic joint='open_left'><multiplier>1</multiplier><reference>0.01</reference></mimic>"


def drawn(arm):
    return [type(shape.geometry).__name__ for shape in link(arm, "wrist").visuals]


SDF_ROWS: tuple[Row, ...] = (
    read(
        "`<model>`",
        "the one whose joints move; the base is the file's origin",
        '<link name="base">',
        '<pose>0 0 0.3 0 0 0</pose><link name="base">',
        lambda arm: "robot_world" in arm.link_names,
    ),
    ignored(
        "a `<model>` without joints that move",
        "reported",
        "</sdf>",
        "<model name='floor'><static>1</static></model></sdf>",
        "the model 'floor' is left out",
    ),
    refused(
        "a second `<model>` whose joints move",
        "",
        "</sdf>",
        SDF[SDF.index("<model") :].replace("three", "four"),
        "several models could be the robot",
    ),
    read(
        "a nested `<model>`, `<include>`",
        "its names begin with its own and `::`",
        END,
        "<model name='m'><link name='l'/></model><joint name='j' type='fixed'>"
        "<parent>wrist</parent><child>m::l</child></joint></model>",
        lambda arm: "m::l" in arm.link_names,
    ),
    read(
        "`<pose>`",
        "with `relative_to`, `degrees` and `rotation_format`",
        '"upper">0 0 0.2 0 0 0',
        '"upper" degrees="true">0 0 0.2 90 0 0',
        lambda arm: abs(arm.joint_by_name["bend"].pose.rotation[2, 1] - 1) < 1e-9,
    ),
    read(
        "`<frame>`",
        "a link without mass",
        END,
        "<frame name='tool' attached_to='wrist'/></model>",
        lambda arm: "tool" in arm.link_names,
    ),
    read(
        "`<inertial>`",
        "with its `<pose>`; without it 1 kg and 1 kg m^2, as SDF has it, reported",
        f'<link name="base">{INERTIAL}',
        '<link name="base">',
        lambda arm: link(arm, "base").inertial.inertia[0, 0] == 1.0,
    ),
    read(
        "`auto` of it",
        "from the densities of primitive shapes",
        f'<link name="base">{INERTIAL}',
        "<link name='base'><inertial auto='true'/><collision name='c'><geometry>"
        "<box><size>0.1 0.1 0.1</size></box></geometry></collision>",
        lambda arm: (
            round(link(arm, "base").inertial.mass, 9) == 1.0
            and link(arm, "base").inertial.inertia[0, 0] < 0.002
        ),
    ),
    read(
        "`<collision>`, `<visual>`",
        "box, cylinder, sphere, capsule, cone, ellipsoid, mesh",
        BALL,
        "<ellipsoid><radii>0.1 0.2 0.1</radii></ellipsoid>",
        lambda arm: drawn(arm) == ["Mesh"],
    ),
    read(
        "a mesh's `<uri>`",
        "`model://`, `package://`, `file://`, a path; all that a world finds",
        BALL,
        "<mesh><uri>part.stl</uri></mesh>",
        lambda arm: drawn(arm) == ["Mesh"],
    ),
    refused(
        "a `<collision>` with a mesh that is not there",
        "",
        SHAPE,
        SHAPE.replace(CYLINDER, "<mesh><uri>model://gone/a.stl</uri></mesh>"),
        "is not found",
    ),
    ignored(
        "a `<plane>`",
        "reported",
        BALL,
        BALL + "</geometry></visual><visual name='p'><geometry><plane/>",
        "a <plane> of a <visual> has no thickness and is left out",
    ),
    read(
        "a shape without a thickness",
        "is left out, reported",
        SHAPE,
        SHAPE.replace("0.03", "0"),
        lambda arm: any("no thickness" in note for note in arm.notes),
    ),
    read(
        "`<material>`",
        "its diffuse colour",
        f"<geometry>{BALL}</geometry>",
        f"<geometry>{BALL}</geometry><material><diffuse>1 0 0 1</diffuse></material>",
        lambda arm: link(arm, "wrist").visuals[0].rgba[0] == 1,
    ),
    read(
        "`<joint>` revolute, continuous, prismatic, fixed",
        "its `<pose>` too",
        '"open_right" type="prismatic"',
        '"open_right" type="fixed"',
        lambda arm: arm.joint_by_name["open_right"].kind == "fixed",
    ),
    refused(
        "ball, universal, screw, gearbox, revolute2",
        "",
        'name="turn" type="revolute"',
        'name="turn" type="ball"',
        "known are revolute",
    ),
    read(
        "`<axis>`: `<xyz>`",
        "with `expressed_in`; in the model's frame until SDF 1.4",
        BEND,
        BEND.replace("<xyz>0 1 0", "<xyz expressed_in='base'>1 0 0"),
        lambda arm: np.allclose(arm.joint_by_name["bend"].axis, [1, 0, 0]),
    ),
    read(
        "`<limit>`",
        "`inf`, 1e16 and more, and negative rates are none",
        LIMIT,
        "<effort>inf</effort><velocity>1.5</velocity>",
        lambda arm: arm.joint_by_name["bend"].effort_source == "",
    ),
    read(
        "a revolute joint without a range",
        "is continuous",
        "<lower>-2</lower><upper>2</upper>",
        "",
        lambda arm: arm.joint_by_name["bend"].kind == "continuous",
    ),
    refused("one end of a range", "", "<lower>-2</lower>", "", "has one end of its range"),
    read(
        "`<dynamics>` damping, friction",
        "in physics",
        BEND,
        BEND.replace("</xyz>", "</xyz><dynamics><damping>0.5</damping></dynamics>"),
        lambda arm: arm.joint_by_name["bend"].damping == 0.5,
    ),
    ignored(
        "a spring, `<physics>`, any other element",
        "reported",
        BEND,
        "<physics/>" + BEND,
        "<physics> of <joint> is left out",
    ),
    read(
        "`<mimic>`",
        "with `<multiplier>`, `<offset>`, `<reference>`",
        "<xyz>0 -1 0</xyz>",
        f"<xyz>0 -1 0</xyz>{FOLLOWS}",
        lambda arm: getattr(arm.joint_by_name["open_right"].mimic, "offset", 0) == -0.01,
    ),
    read(
        "`<gripper>`",
        "the end effector: its fingers and its palm",
        END,
        "<gripper name='hand'><gripper_link>left</gripper_link><gripper_link>right</gripper_link>"
        "<palm_link>wrist</palm_link></gripper></model>",
        lambda arm: "hand" in arm.groups,
    ),
)
