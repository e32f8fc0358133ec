"""Links that nothing can touch: a note of the robot, and a warning of verdicts about contacts."""

from itertools import pairwise

import pytest

from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from tests.running import run_case

LINK = """
<link name="{name}"><inertial><mass value="{mass}"/>
<inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>{shapes}</link>
"""
JOINT = """
<joint name="{child}_joint" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
<origin xyz="0 0 0.2"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" velocity="1" effort="50"/></joint>
"""
SHAPE = '<geometry><box size="0.05 0.05 0.18"/></geometry>'
SOLID, DRAWN = f"<collision>{SHAPE}</collision>", f"<visual>{SHAPE}</visual>"
SCENARIO = """
scenario: Next to a wall
robot: {urdf: arm.urdf}
objects:
  - {name: wall, static: true, box: {size: [0.02, 1, 2]}, pose: {xyz: [2, 0, 1.4]}}
steps: [{wait: 0.1 s}]
expect:
  - never: collision
  - never: {in_contact: {between: [robot, wall]}}
  - clearance: {between: [robot, wall], at_least: 0.0001}
  - duration: {at_most: 60 s}
"""


def warnings(folder, lower, upper, fixed, masses=(1, 1, 0.001)):
    """Names of links in the robot's note, and the warning of each verdict."""
    links = {"base": SOLID, "lower": lower, "upper": upper, "tip": fixed, "hand": SOLID}
    text = "".join(
        LINK.format(name=name, shapes=shapes, mass=mass)
        for (name, shapes), mass in zip(links.items(), (1, *masses, 1), strict=True)
    )
    names = list(links)
    for parent, child in pairwise(names):
        kind = "fixed" if child == "tip" else "revolute"
        text += JOINT.format(parent=parent, child=child, kind=kind)
    (folder / "arm.urdf").write_text(f'<robot name="arm">{text}</robot>')
    (folder / "a.scenario.yaml").write_text(SCENARIO)
    result = run_case(folder / "a.scenario.yaml", stills=False)
    assert result.outcome == "passed", result
    robot = load_robot(RobotSpec(urdf="arm.urdf"), folder)
    notes = [note for note in robot.notes if "pass through everything" in note]
    return notes, [each.warnings[0].message for each in result.verdicts if each.warnings]


@pytest.mark.parametrize(
    ("lower", "upper", "fixed", "masses", "names"),
    [
        (DRAWN, DRAWN, "", (1, 1, 0.001), "lower, upper"),
        ("", "", "", (1, 0.005, 0.001), "lower"),
        ("", "", DRAWN, (0.005, 0.005, 0.001), "upper"),
    ],
)
def test_links_that_pass_through_everything_are_named(tmp_path, lower, upper, fixed, masses, names):
    notes, warned = warnings(tmp_path, lower, upper, fixed, masses)
    assert len(notes) == 1
    assert f": {names};" in notes[0]
    assert warned == [f"nothing can touch these links: {names}"] * 3


@pytest.mark.parametrize(("upper", "fixed"), [("", ""), (DRAWN, SOLID), ("", SOLID)])
def test_frames_and_links_with_shapes_fixed_to_them_are_not(tmp_path, upper, fixed):
    masses = (1, 0.005 if not upper else 1, 0.001)
    solid_lower = SOLID.replace("0.18", "0.1")
    notes, warned = warnings(tmp_path, solid_lower, upper, fixed, masses)
    assert notes == []
    assert warned == []
