"""A small MJCF file with two arms of six joints and a hand of two fingers each."""

LIMB = """
<body name="{name}" pos="{at} 0 0">
  <joint name="{name}" axis="{axis}" range="{range}" damping="1"/>
  <geom type="capsule" fromto="0 0 0 {length} 0 0" size="0.02" mass="{mass}"/>
"""
FINGER = """
<body name="{side}_{finger}" pos="0.11 {sign}0.045 0">
  <joint name="{side}_{finger}" type="slide" axis="0 {inward} 0" range="0 0.035"/>
  <geom type="box" size="0.03 0.005 0.01" mass="0.03" friction="1"/>
</body>"""
JOINTS = (
    ("shoulder", "0 -1 0", "-0.3 2.8", 0.2, 0.6),
    ("elbow", "0 -1 0", "-2.8 0.3", 0.2, 0.4),
    ("roll", "1 0 0", "-3.1 3.1", 0.08, 0.2),
    ("pitch", "0 -1 0", "-2 2", 0.08, 0.2),
    ("twist", "1 0 0", "-3.1 3.1", 0.06, 0.15),
)


def arm(side, y):
    """An arm that stands on a column and points along x."""
    text = (
        f'<body name="{side}_base" pos="0 {y} 0.3">'
        f'<geom type="cylinder" size="0.03 0.1" pos="0 0 -0.2"/>'
        f'<body name="{side}_waist"><joint name="{side}_waist" axis="0 0 1" range="-3.1 3.1"/>'
        '<geom type="sphere" size="0.03" mass="0.5"/>'
    )
    at = 0.0
    for name, axis, limits, length, mass in JOINTS:
        text += LIMB.format(
            name=f"{side}_{name}", at=at, axis=axis, range=limits, length=length, mass=mass
        )
        at = length
    text += f'<site name="{side}_tcp" pos="0.12 0 0"/>'
    text += '<geom type="box" size="0.01 0.06 0.015" pos="0.07 0 0" mass="0.05"/>'
    text += FINGER.format(side=side, finger="left_finger", sign="", inward="-1")
    text += FINGER.format(side=side, finger="right_finger", sign="-", inward="1")
    return text + "</body>" * (len(JOINTS) + 2)


def motors(side):
    """Position servos with effort limits, as public files have them."""
    joints = "".join(
        f'<position joint="{side}_{name}" kp="300" forcerange="-60 60"/>'
        for name in ("waist", *(each[0] for each in JOINTS))
    )
    fingers = "".join(
        f'<position joint="{side}_{name}_finger" kp="500" forcerange="-20 20"/>'
        for name in ("left", "right")
    )
    return joints + fingers


MJCF = f"""<mujoco model="two_arms">
<compiler angle="radian" autolimits="true"/>
<worldbody>{arm("port", 0.25)}{arm("starboard", -0.25)}</worldbody>
<actuator>{motors("port")}{motors("starboard")}</actuator>
</mujoco>"""
