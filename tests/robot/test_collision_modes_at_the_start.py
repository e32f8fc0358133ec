"""What follows from shapes follows from those that collide: allowed pairs, the gripper."""

import pytest

from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from tests.robot.arm_files import INERTIAL, SHAPE, URDF, load_arm, write_arm
from tests.robot.vessels import vessel, write_obj
from tests.session.front_door import run

CUP = '<collision><geometry><mesh filename="cup.obj"/></geometry></collision>'
BALL = """<collision><origin xyz="0 0 -0.35"/><geometry><sphere radius="0.01"/></geometry>
</collision>"""
PAIR = ("upper", "wrist")


def write_cup_and_ball(folder, inertial=INERTIAL):
    """An arm whose first link is a cup, in which a ball of its last link hangs at the start."""
    write_obj(folder / "cup.obj", *vessel())
    upper = f'<link name="upper">{INERTIAL}{SHAPE}</link>'
    urdf = URDF.replace(upper, f'<link name="upper">{inertial}{CUP}</link>')
    wrist = f'<link name="wrist">{INERTIAL}'
    write_arm(folder, urdf.replace(wrist + SHAPE, wrist + BALL))


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("options", "scenario", "is_allowed"),
    [
        ({}, None, False),
        ({}, "parts", False),
        ({}, "exact", False),
        ({}, "hull", True),
        ({"collision": "hull"}, "parts", True),
        ({"collision": {"upper": "hull"}}, None, True),
        ({"collision": {"upper": "parts"}}, "hull", False),
    ],
)
def test_pairs_that_touch_at_the_start_are_those_of_the_shapes_in_use(
    tmp_path, options, scenario, is_allowed
):
    write_cup_and_ball(tmp_path)
    spec = RobotSpec.model_validate({"urdf": "arm.urdf", **options})
    arm = load_robot(spec, tmp_path, scenario)
    assert (PAIR in arm.allowed_collisions) == is_allowed
    note = "the pairs that touch at the start are allowed: upper - wrist"
    assert any(note in each for each in arm.notes) == is_allowed


@pytest.mark.nightly(but=["parts"])
@pytest.mark.parametrize("mode", ["hull", "parts"])
def test_the_arm_moves_away_from_its_start(tmp_path, mode):
    write_cup_and_ball(tmp_path)
    robot, rest = "{urdf: arm.urdf}", f"collision: {mode}\n"
    result, _ = run(tmp_path, "- move_to: {joints: {turn: 0.5}}", robot=robot, rest=rest)
    assert result.outcome == "passed"


def test_an_estimated_mass_is_the_same_however_meshes_collide(tmp_path):
    write_cup_and_ball(tmp_path, inertial="")
    masses = {
        mode: load_arm(tmp_path, collision=mode).links[2].inertial.mass
        for mode in ("parts", "hull", "exact")
    }
    assert masses["hull"] == masses["parts"] == masses["exact"] > 0
