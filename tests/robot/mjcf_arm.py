"""Arms as MJCF text: one with a mesh at its tip, one with a hand of closed linkages."""

MJCF = """\
<mujoco model="arm">
  <compiler angle="degree" meshdir="assets"/>
  <asset><mesh name="tip" file="t.obj" scale="0.02 0.02 0.02"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body name="base">
      <geom type="cylinder" size="0.05 0.05" pos="0 0 0.05"/>
      <body name="upper" pos="0 0 0.12" euler="0 0 30">
        <joint name="pan" axis="0 0 1"/>
        <joint name="lift" axis="0 1 0" pos="0 0 0.03" range="-100 100" ref="20" damping="0.5"/>
        <geom type="capsule" fromto="0 0 0.05 0 0 0.3" size="0.03"/>
        <body name="lower" pos="0 0 0.35">
          <joint name="elbow" axis="0 1 0" range="-120 120"/>
          <geom type="box" size="0.02 0.03 0.1" pos="0 0 0.1"/>
          <body name="wrist" pos="0 0 0.22">
            <joint name="slide" type="slide" axis="0 0 1" range="0 0.1"/>
            <geom type="mesh" mesh="tip" pos="0.01 0 0"/>
            <site name="tcp" pos="0 0 0.08"/>
            <body name="finger" pos="0.02 0 0.06">
              <joint name="pinch" type="slide" axis="1 0 0" range="0 0.05"/>
              <geom type="sphere" size="0.01"/>
            </body>
          </body>
        </body>
      </body>
    </body>
    <body name="cube" pos="1 0 0.5"><freejoint/><geom type="box" size="0.02 0.02 0.02"/></body>
  </worldbody>
  <actuator>
    <position name="a1" joint="pan" kp="100" forcerange="-50 50"/>
    <position name="a2" joint="lift" kp="100" forcerange="-60 60"/>
    <motor name="a3" joint="elbow" gear="30" ctrlrange="-1 1" ctrllimited="true"/>
  </actuator>
  <equality><joint joint1="pinch" joint2="slide" polycoef="0.01 0.4 0 0 0"/></equality>
  <contact><exclude body1="base" body2="lower"/></contact>
  <keyframe><key name="home" qpos="0.1 0.5 0.7 0.02 0.018 1 0 0.5 1 0 0 0"/></keyframe>
</mujoco>
"""
TIP = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def linkage_finger(name, y, turned):
    """Crank and rocker of 5 cm, 1 cm apart; the pad between their ends stays upright."""
    return f"""
    <body name="{name}_crank" pos="0 {y} 0" quat="{turned}"><geom type="sphere" size="0.003"/>
      <joint name="{name}_crank" axis="1 0 0" range="0 0.6" damping="0.01"/></body>
    <body name="{name}_rocker" pos="0 {y - 0.01 * (1 if y > 0 else -1)} 0" quat="{turned}">
      <geom type="sphere" size="0.003"/>
      <joint name="{name}_rocker" axis="1 0 0" range="-1 1" damping="0.001"/>
      <body name="{name}_pad" pos="0 0 0.05">
        <joint name="{name}_pad" axis="1 0 0" range="-1 1" damping="0.001"/>
        <geom type="box" size="0.01 0.003 0.02" pos="0 0 0.02"/>
      </body></body>"""


LINKAGE = f"""<mujoco>
  <compiler angle="radian" autolimits="true"/><option timestep="0.002"/>
  <worldbody>
  <body name="base"><geom size="0.05"/><body name="a" pos="0 0 0.1"><joint name="a" axis="0 0 1"
    range="-3 3"/><geom type="sphere" size="0.02"/><body name="b" pos="0 0 0.1">
    <joint name="b" axis="0 1 0" range="-2 2"/><geom type="sphere" size="0.02"/>
    <body name="c" pos="0 0 0.1"><site name="tcp" pos="0 0 0.08"/>
    <joint name="c" axis="0 1 0" range="-2 2"/>
    <geom type="sphere" size="0.01"/>
    {linkage_finger("left", 0.03, "0 0 0 1")}{linkage_finger("right", -0.03, "1 0 0 0")}
  </body></body></body></body></worldbody>
  <tendon><fixed name="both"><joint joint="left_crank" coef="0.5"/>
    <joint joint="right_crank" coef="0.5"/></fixed></tendon>
  <equality><joint joint1="right_crank" joint2="left_crank" polycoef="0 1 0 0 0"/>
    <connect body1="left_pad" body2="left_crank" anchor="0 -0.01 0"/>
    <connect body1="right_pad" body2="right_crank" anchor="0 -0.01 0"/></equality>
  <actuator><general tendon="both" forcerange="-5 5" ctrlrange="0 1"/></actuator></mujoco>"""
