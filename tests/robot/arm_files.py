"""A three-joint arm as URDF and SRDF text, and the folder that a scenario finds it in."""

from pathlib import Path

from harness.language.scenario import RobotSpec
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot

INERTIAL = (
    '<inertial><origin xyz="0 0 0.1"/><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.002"/></inertial>'
)
SHAPE = (
    '<collision><origin xyz="0 0 0.1"/><geometry><cylinder radius="0.03" length="0.14"/></geometry>'
    "</collision>"
)
LIMIT = '<limit lower="-2" upper="2" velocity="2" effort="30"/>'
URDF = f"""<?xml version="1.0"?>
<robot name="three">
  <link name="base_link">{INERTIAL}</link>
  <link name="upper">{INERTIAL}{SHAPE}</link>
  <link name="lower">{INERTIAL}{SHAPE}</link>
  <link name="wrist">{INERTIAL}{SHAPE}</link>
  <link name="tool"/>
  <joint name="turn" type="continuous">
    <parent link="base_link"/><child link="upper"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>
    <limit velocity="2" effort="30"/>
  </joint>
  <joint name="bend" type="revolute">
    <parent link="upper"/><child link="lower"/><origin xyz="0 0 0.2"/><axis xyz="0 1 0"/>
    {LIMIT}
  </joint>
  <joint name="reach" type="prismatic">
    <parent link="lower"/><child link="wrist"/><origin xyz="0 0 0.2"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.2" velocity="0.3" effort="80"/>
  </joint>
  <joint name="tip" type="fixed">
    <parent link="wrist"/><child link="tool"/><origin xyz="0 0 0.2"/>
  </joint>
</robot>
"""
SRDF = """<?xml version="1.0"?>
<robot name="three">
  <group name="manipulator"><chain base_link="base_link" tip_link="tool"/></group>
  <group_state name="home" group="manipulator">
    <joint name="turn" value="0.1"/>
    <joint name="bend" value="0.7"/>
    <joint name="reach" value="0.05"/>
  </group_state>
  <virtual_joint name="held" type="fixed" parent_frame="world" child_link="base_link"/>
  <disable_collisions link1="upper" link2="wrist" reason="Never"/>
</robot>
"""


def write_arm(folder: Path, urdf: str = URDF, srdf: str = SRDF) -> None:
    """Write arm.urdf and arm.srdf."""
    (folder / "arm.urdf").write_text(urdf, encoding="utf-8")
    (folder / "arm.srdf").write_text(srdf, encoding="utf-8")


def load_arm(folder: Path, **options: object) -> RobotDescription:
    """The robot of arm.urdf and arm.srdf, with a scenario's options."""
    words = {"urdf": "arm.urdf", "srdf": "arm.srdf", **options}
    words = {key: value for key, value in words.items() if value is not None}
    return load_robot(RobotSpec.model_validate(words), folder)
