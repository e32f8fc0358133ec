"""Joint limits: those of the arm, none of joints without any, in as many digits as differ."""

from math import atan2, hypot, pi

import numpy as np
import pytest

from harness.plugins.iktest import IkTest, run_ik_test
from harness.plugins.iktest.text import report_lines
from harness.robot.robot_source import RobotSource
from tests.plugins.iktest.arms import OM, correct
from tests.robot.arm_files import SRDF, URDF, write_arm

SHOULDER = 0.3  # [m] above the base
SHORTEST = 0.4  # [m] from the shoulder to the tool, with the slide at 0
SCARA = """<mujoco model="scara"><compiler angle="radian"/>
  <worldbody><body name="base"><geom type="box" size="0.05 0.05 0.02"/>
    <body name="upper" pos="0 0 0.1"><joint name="spin" axis="0 0 1"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02"/>
      <body name="lower" pos="0.3 0 0.05"><joint name="bend" axis="0 0 1"{limits}/>
        <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.02"/>
        <site name="tcp" pos="0.2 0 0"/></body></body></body></worldbody>
  <actuator><motor joint="spin" ctrlrange="-20 20"/><motor joint="bend" ctrlrange="-20 20"/>
  </actuator></mujoco>"""


def spherical(start):
    """Inverse kinematics of the arm with a slide, its first joint within a turn from a start."""

    def ik(x, y, z):
        out, up = hypot(x, y), z - SHOULDER
        slide = hypot(out, up) - SHORTEST
        if not -1e-9 <= slide <= 0.2 + 1e-9:
            return None
        ways = [(atan2(y, x), atan2(out, up)), (atan2(-y, -x), atan2(-out, up))]
        return [
            [(turn - start) % (2 * pi) + start, bend, min(max(slide, 0.0), 0.2)]
            for turn, bend in ways
            if abs(bend) <= 2 + 1e-9
        ]

    return ik


def planar(x, y, z):
    """Inverse kinematics of the SCARA with every angle between one and two turns."""
    cosine = (x * x + y * y - 0.13) / 0.12
    if abs(cosine) > 1 + 1e-12 or abs(z - 0.15) > 1e-9:
        return None
    bend = np.arccos(np.clip(cosine, -1, 1))
    spin = atan2(y, x) - atan2(0.2 * np.sin(bend), 0.3 + 0.2 * cosine)
    return [spin % (2 * pi) + 2 * pi, bend + 2 * pi]


def result(report, name):
    return next(each for each in report.properties if each.name == name)


@pytest.mark.nightly
@pytest.mark.parametrize("start", [0.0, -pi, 4.0])
def test_a_continuous_joint_may_be_answered_at_any_turn(tmp_path, start):
    write_arm(tmp_path)
    source = RobotSource(str(tmp_path / "arm.urdf"), srdf=str(tmp_path / "arm.srdf"))
    report = run_ik_test(IkTest(spherical(start), source))
    assert result(report, "limits").observed == 100
    assert report.has_passed


@pytest.mark.nightly
def test_the_same_joint_with_limits_is_judged_by_them(tmp_path):
    limited = URDF.replace(
        '"continuous"', '"revolute"').replace('<limit velocity="2" effort="30"/>',
        '<limit lower="-3.1" upper="3.1" velocity="2" effort="30"/>', 1)  # fmt: skip
    write_arm(tmp_path, limited, SRDF)
    source = RobotSource(str(tmp_path / "arm.urdf"), srdf=str(tmp_path / "arm.srdf"))
    report = run_ik_test(IkTest(spherical(0.0), source, examples=40))
    [finding] = [each for each in report.findings if each.property == "limits"]
    assert finding.detail.startswith("turn at ")
    assert finding.detail.endswith(" rad, limits -3.1 to 3.1")


@pytest.mark.nightly(but=["-True"])
@pytest.mark.parametrize(("limits", "is_kept"), [("", True), (' range="-2 2"', False)])
def test_a_hinge_of_a_mjcf_without_a_range_has_no_limits(tmp_path, limits, is_kept):
    (tmp_path / "scara.xml").write_text(SCARA.format(limits=limits), encoding="utf-8")
    examples = 10 if is_kept else 40
    report = run_ik_test(IkTest(planar, str(tmp_path / "scara.xml"), examples=examples))
    assert not result(report, "reaches").flawed
    assert not result(report, "continuity").flawed
    assert (not result(report, "limits").flawed) == is_kept
    assert all("bend at" in each.detail for each in report.findings if each.property == "limits")


@pytest.mark.nightly
@pytest.mark.parametrize(("excess", "text"), [(2e-7, "1.5000002"), (1e-3, "1.501")])
def test_an_excess_is_written_with_the_digits_that_show_it(excess, text):
    def ik(x, y, z, pitch):
        return [[a, b + excess * (b > 1.499), c, d] for a, b, c, d in correct(x, y, z, pitch)]

    report = run_ik_test(IkTest(ik, OM, position_tolerance=0.01, orientation_tolerance=0.1))
    [finding] = report.findings
    assert finding.detail.startswith(f"joint2 at {text}")
    assert finding.detail.endswith(" rad, limits -1.5 to 1.5")


@pytest.mark.nightly
def test_outcomes_and_claims_are_two_columns_however_many_findings_there_are():
    def ik(x, y, z, pitch):
        found = correct(x, y, z, pitch)
        if x < 0:
            return [[2 * each for each in answer] for answer in found]
        return [[a, b, c + (y > 0) * 2, d] for a, b, c, d in found]

    report = run_ik_test(IkTest(ik, OM, examples=40))
    lines = report_lines(report)[1 : 1 + len(report.properties)]
    pairs = [line.split(each.says) for line, each in zip(lines, report.properties, strict=True)]
    assert len({len(before) for before, _ in pairs}) == 1
    assert all(before.endswith("  ") for before, _ in pairs)
