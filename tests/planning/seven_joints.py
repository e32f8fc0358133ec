"""A small arm of seven joints: turns and bends in alternation."""

from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot

LENGTHS = (0.16, 0.17, 0.16, 0.17, 0.16, 0.10, 0.08)
INERTIA = '<inertia ixx="0.003" iyy="0.003" izz="0.002" ixy="0" ixz="0" iyz="0"/>'


def seven_joint_urdf():
    links = ['<link name="base"/>']
    joints = []
    parent, height = "base", 0.1
    for number, length in enumerate(LENGTHS, start=1):
        axis = "0 0 1" if number % 2 else "0 1 0"
        shape = f'<geometry><cylinder radius="0.03" length="{0.6 * length}"/></geometry>'
        middle = f'<origin xyz="0 0 {length / 2}"/>'
        links.append(
            f'<link name="l{number}"><inertial>{middle}<mass value="0.8"/>{INERTIA}</inertial>'
            f"<collision>{middle}{shape}</collision></link>"
        )
        joints.append(
            f'<joint name="j{number}" type="revolute"><parent link="{parent}"/>'
            f'<child link="l{number}"/><origin xyz="0 0 {height}"/><axis xyz="{axis}"/>'
            '<limit lower="-2.8" upper="2.8" velocity="2.5" effort="80"/></joint>'
        )
        parent, height = f"l{number}", length
    links.append('<link name="tool"/>')
    joints.append(
        '<joint name="tip" type="fixed"><parent link="l7"/><child link="tool"/>'
        '<origin xyz="0 0 0.08"/></joint>'
    )
    return f'<robot name="seven">{"".join(links)}{"".join(joints)}</robot>'


SRDF = """<robot name="seven"><group name="arm"><chain base_link="base" tip_link="tool"/></group>
</robot>"""


def seven_joints(folder):
    (folder / "seven.urdf").write_text(seven_joint_urdf())
    (folder / "seven.srdf").write_text(SRDF)
    return load_robot(RobotSpec(urdf="seven.urdf", srdf="seven.srdf"), folder)
