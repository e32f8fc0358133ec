"""Arms with grippers of their own: texts of their URDF and SRDF."""

from itertools import pairwise

from tests.robot.arm_files import INERTIAL, SRDF, URDF, write_arm

PALM = f"""  <link name="palm">{INERTIAL}</link>
  <joint name="palm_joint" type="fixed"><parent link="tool"/><child link="palm"/></joint>
"""
FINGER = """  <link name="{name}"><inertial><mass value="0.05"/>
    <inertia ixx="1e-5" iyy="1e-5" izz="1e-5"/></inertial>
    <collision><origin xyz="0 {y} 0.05"/><geometry><box size="0.02 0.01 0.06"/></geometry>
    </collision></link>
  <joint name="{name}_joint" type="prismatic"><parent link="palm"/><child link="{name}"/>
    <axis xyz="0 {side} 0"/><limit lower="0" upper="0.03" velocity="0.1" effort="40"/>{mimic}
  </joint>
"""
LEFT = FINGER.format(name="left", y=0.01, side=1, mimic="")

RIGHT = FINGER.format(name="right", y=-0.01, side=-1, mimic='<mimic joint="left_joint"/>')

HAND = PALM + LEFT + RIGHT

GROUP = """  <group name="hand"><joint name="left_joint"/></group>
  <end_effector name="grip" parent_link="tool" group="hand" parent_group="manipulator"/>
"""
LINKS = ("base_link", "a", "b", "c", "d", "e", "tool")

AXES = ("0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1")

SIX = (
    '<robot name="six">'
    + "".join(f'<link name="{name}">{INERTIAL}</link>' for name in LINKS)
    + "".join(
        f'<joint name="{after}_joint" type="revolute"><parent link="{before}"/>'
        f'<child link="{after}"/><origin xyz="0 0 0.15"/><axis xyz="{axis}"/>'
        '<limit lower="-3" upper="3" velocity="2" effort="100"/></joint>'
        for (before, after), axis in zip(pairwise(LINKS), AXES, strict=True)
    )
    + HAND
    + "</robot>"
)

SIX_SRDF = f"""<robot name="six">
  <group name="manipulator"><chain base_link="base_link" tip_link="tool"/></group>
{GROUP}</robot>
"""


def write(folder, hand=HAND, group=GROUP):
    end = "</robot>"
    write_arm(folder, URDF.replace(end, hand + end), SRDF.replace(end, group + end))


FRAME = """<link name="{0}">{2}</link><joint name="g" type="fixed"><parent link="palm"/>
    <child link="{0}"/><origin xyz="{1}" rpy="0 0 1"/></joint>"""
LIGHT = """<inertial><mass value="0.001"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6"/></inertial>"""
PALM_AT_THE_TIPS = f"""  <link name="palm">{INERTIAL}<collision><origin xyz="0 0 -0.09"/>
    <geometry><box size="0.06 0.08 0.08"/></geometry></collision></link>
  <joint name="palm_joint" type="fixed"><parent link="tool"/><child link="palm"/>
    <origin xyz="0 0 0.14"/></joint>
"""
TIPS = PALM_AT_THE_TIPS + (LEFT + RIGHT).replace(' 0.05"/>', ' -0.03"/>')
"""The palm, and with it the fingers, have their origins where the fingers end."""
TIP = (
    f'<link name="{{0}}_tip">{LIGHT}</link><joint name="{{0}}_bend" type="revolute">'
    '<parent link="{0}"/><child link="{0}_tip"/><origin xyz="0 0 0.08"/><axis xyz="1 0 0"/>'
    '<limit lower="0" upper="1" velocity="1" effort="1"/></joint>'
)
"""A link of a finger that bends by itself."""
UNCOUPLED = HAND.replace('<mimic joint="left_joint"/>', "")

JAW = PALM.replace(
    "</link>",
    """<collision><origin xyz="0 -0.025 0.05"/><geometry><box size="0.03 0.01 0.1"/></geometry>
    </collision></link>""",
    1,
) + FINGER.format(name="jaw", y=0.0, side=1, mimic="").replace(
    'upper="0.03"', 'upper="0.05"'
).replace('lower="0"', 'lower="-0.015"')

FLAT = (
    '<link name="{0}"><inertial><mass value="0.05"/><inertia ixx="1e-5" iyy="1e-5" izz="1e-5"/>'
    '</inertial><collision><origin xyz="0 {1} 0.05"/><geometry><box size="0.04 0.02 0.1"/>'
    "</geometry></collision></link>"
)

TURNING_JAW = (
    PALM.replace(f'<link name="palm">{INERTIAL}</link>', FLAT.format("palm", -0.01))
    + FLAT.format("jaw", 0.01)
    + '<joint name="jaw_joint" type="revolute"><parent link="palm"/><child link="jaw"/>'
    '<axis xyz="-1 0 0"/><limit lower="0" upper="1.2" velocity="1" effort="2"/></joint>'
)
"""As on the SO-101: the jaw lies on the palm when closed, and turns about its lower edge."""
SHAPE = """<collision><origin xyz="0.03 0 0.05"/><geometry><box size="0.08 0.06 0.1"/></geometry>
    </collision>"""
SIX_WITH_JAW = SIX.replace(HAND, JAW)

SIX_WITH_TURNING_JAW = SIX.replace(HAND, TURNING_JAW)

FIVE_WITH_TURNING_JAW = (
    SIX_WITH_TURNING_JAW.replace('name="d_joint" type="revolute"', 'name="d_joint" type="fixed"')
    .replace("</robot>", FRAME.format("jaw_tip_tcp", "0.002 0 0.09", "") + "</robot>")
    .replace('rpy="0 0 1"', 'rpy="0 0 1.2"')
)
"""The TCP's z axis points out of the hand, its x axis across it."""
BLOCK = """
    objects:
      - name: block
        pose: {xyz: [0.3, 0.1, 0.03]}
        box: {size: [0.03, 0.04, 0.06]}
        mass: 0.05
    expect:
      - grasped: {object: block, during: pick}
"""
PICK = "- {pick: {object: block, approach: {distance: 0.05}, lift: {distance: 0.05}}, id: pick}"

BLOCK_AT = """<collision><origin xyz="{}"/><geometry><box size="0.02 0.06 0.06"/></geometry>
    </collision>"""
