"""Fingers that mimic each other stay together in the physics, whatever damping they have."""

from dataclasses import replace

import numpy as np
import pytest

from harness.plugins.remarks.observers.couplings import coupling_findings
from harness.simulation.robot_mjcf import joint_range
from tests.robot.arm_files import load_arm, write_arm
from tests.robot.hands import BLOCK, HAND, PALM, PICK, SIX
from tests.session.front_door import run

PROXIMAL = """<link name="{name}"><inertial><origin xyz="0 0 0.03"/><mass value="0.05"/>
    <inertia ixx="1e-6" iyy="1e-6" izz="1e-6"/></inertial></link>
  <joint name="{name}_joint" type="revolute"><parent link="palm"/><child link="{name}"/>
    <origin xyz="0 {y} 0"/><axis xyz="{side} 0 0"/><dynamics damping="{damping}"/>
    <limit lower="0" upper="1" velocity="3" effort="1000"/>{mimic}</joint>
"""
DISTAL = """<link name="{name}_tip"><inertial><origin xyz="0 0 0.02"/><mass value="0.05"/>
    <inertia ixx="1e-6" iyy="1e-6" izz="1e-6"/></inertial>
    <collision><origin xyz="0 {inward} 0.025"/><geometry><box size="0.02 0.01 0.05"/></geometry>
    </collision></link>
  <joint name="{name}_tip_joint" type="revolute"><parent link="{name}"/>
    <child link="{name}_tip"/><origin xyz="0 0 0.06"/><axis xyz="{back} 0 0"/>
    <limit lower="0" upper="1" velocity="3" effort="1000"/><dynamics damping="{damping}"/>
    <mimic joint="left_joint"/></joint>
"""
MIMIC = '<mimic joint="left_joint"/>'


def hand(damping):
    """Two fingers of two links each that stay parallel, of light links with a large damping."""
    left = {"name": "left", "y": 0.05, "side": 1, "back": -1, "inward": -0.005, "mimic": ""}
    right = {"name": "right", "y": -0.05, "side": -1, "back": 1, "inward": 0.005, "mimic": MIMIC}
    parts = [form.format(**each, damping=damping) for form in (PROXIMAL, DISTAL)
             for each in (left, right)]  # fmt: skip
    return PALM + "".join(parts)


def test_a_follower_s_damping_acts_at_the_joint_that_it_follows(tmp_path):
    halved = '<mimic joint="left_joint" multiplier="-0.5"/>'
    text = hand(0.7).replace(MIMIC, halved, 1)
    write_arm(tmp_path, SIX.replace(HAND, text))
    joints = load_arm(tmp_path, srdf=None).joint_by_name
    assert joints["left_joint"].damping == pytest.approx(0.7 * (1 + 0.25 + 1 + 1))
    assert joints["right_joint"].damping == joints["left_tip_joint"].damping == 0


@pytest.mark.parametrize(
    ("multiplier", "limits", "expected"),
    [("-1", (0, 1), (0, 1)), ("-1", (-0.5, 1), (0, 0.5)), ("2", (0, 1), (0, 0.5))],
)
def test_limits_of_a_follower_narrow_its_leader_unless_they_leave_nothing(
    tmp_path, multiplier, limits, expected
):
    """The fingers of PR2 follow with -1, within limits of the other sign."""
    text = hand(0.7).replace(MIMIC, f'<mimic joint="left_joint" multiplier="{multiplier}"/>', 1)
    write_arm(tmp_path, SIX.replace(HAND, text))
    arm = load_arm(tmp_path, srdf=None)
    lower, upper = limits
    follower = replace(arm.joint_by_name["right_joint"], lower=lower, upper=upper)
    joints = tuple(follower if each.name == follower.name else each for each in arm.joints)
    arm = replace(arm, joints=joints)
    assert joint_range(arm, arm.joint_by_name["left_joint"]) == pytest.approx(expected)


@pytest.mark.nightly(but=["3"])
@pytest.mark.parametrize("damping", ["0.7", "3"])
def test_light_fingers_with_a_large_damping_stay_parallel_and_hold(tmp_path, damping):
    write_arm(tmp_path, SIX.replace(HAND, hand(damping)))
    result, saved = run(tmp_path, PICK, robot="{urdf: arm.urdf}", rest=BLOCK)
    assert result.outcome == "passed", [step.message for step in result.steps]
    fingers = saved.signals.joint_positions[:, -4:]
    assert np.abs(fingers - fingers[:, :1]).max() < 0.02
    assert not any(finding.kind == "coupling" for finding in saved.findings)
    # A recording in which one finger lags behind is reported.
    name = list(saved.robot.joint_names)[-1]
    moved = saved.signals.joint_positions.copy()
    moved[500, -1] += 0.3
    lagging = replace(saved, signals=replace(saved.signals, joint_positions=moved))
    [finding] = coupling_findings(lagging.signals, load_arm(tmp_path, srdf=None))
    assert finding.values["joint"] == name
    assert finding.values["error"] == pytest.approx(0.3, abs=0.02)
