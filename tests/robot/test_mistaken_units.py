"""Units that are not those of a URDF: the file is read, and a note names what looks mistaken."""

import numpy as np
import pytest

from harness.core.errors import RobotOptionError
from harness.robot.random_positions import sample_robot_positions
from tests.robot.arm_files import LIMIT, SHAPE, URDF, load_arm, write_arm

CYLINDER = '<cylinder radius="0.03" length="0.14"/>'


def turns(arm):
    return [note for note in arm.notes if "turns from zero" in note]


def small(arm):
    return [note for note in arm.notes if "far smaller than the links" in note]


@pytest.mark.parametrize(("lower", "upper"), [(-176, -4), (10, 170), (-180, 180)])
def test_limits_in_degrees_are_noted_and_positions_can_be_drawn(tmp_path, lower, upper):
    limit = LIMIT.replace('"-2"', f'"{lower}"').replace('"2" velocity', f'"{upper}" velocity')
    write_arm(tmp_path, urdf=URDF.replace(LIMIT, limit))
    arm = load_arm(tmp_path)
    [note] = turns(arm)
    assert note.startswith(f"joint bend turns from {lower} to {upper} rad, ")
    assert note.endswith("angles in a URDF are radians")
    drawn = sample_robot_positions(arm, 50, np.random.default_rng(1))[:, 1]
    assert ((drawn >= lower) & (drawn <= upper)).all()


@pytest.mark.parametrize("limit", [2, 6.3, 12.6, 1e9])
def test_a_few_turns_or_no_bound_at_all_are_not_noted(tmp_path, limit):
    wider = LIMIT.replace('"2" velocity', f'"{limit}" velocity')
    write_arm(tmp_path, urdf=URDF.replace(LIMIT, wider))
    assert not turns(load_arm(tmp_path))


@pytest.mark.parametrize(
    ("shape", "noted"),
    [
        (SHAPE, False),
        (SHAPE.replace('radius="0.03" length="0.14"', 'radius="3e-5" length="1.4e-4"'), True),
        (SHAPE.replace(CYLINDER, '<sphere radius="1e-3"/>'), True),
        (SHAPE.replace(CYLINDER, '<sphere radius="0.02"/>'), False),
        (SHAPE.replace(CYLINDER, '<sphere radius="1e-3"/>') + SHAPE, False),
    ],
)
def test_collision_shapes_far_smaller_than_their_link_are_noted(tmp_path, shape, noted):
    write_arm(tmp_path, urdf=URDF.replace(SHAPE, shape))
    found = small(load_arm(tmp_path))
    assert len(found) == noted
    assert all("of upper, lower are far smaller" in note for note in found)


def test_a_mesh_of_the_wrong_scale_is_noted_with_its_link(tmp_path):
    corners = [(x, y, z) for x in (0, 0.1) for y in (0, 0.1) for z in (0, 0.2)]
    faces = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {face}" for face in faces]
    (tmp_path / "upper.obj").write_text("\n".join(lines))
    mesh = '<collision><geometry><mesh filename="upper.obj" scale="{}"/></geometry></collision>'
    for scale, count in (("1 1 1", 0), ("0.001 0.001 0.001", 1)):
        urdf = URDF.replace(SHAPE, mesh.format(scale), 1)
        write_arm(tmp_path, urdf=urdf)
        found = small(load_arm(tmp_path))
        assert len(found) == count
        assert all("at upper 0.2 mm of 200 mm" in note for note in found)


def test_a_misspelt_group_of_the_arms_own_gripper_is_suggested(tmp_path):
    write_arm(tmp_path)
    with pytest.raises(RobotOptionError, match="did you mean `manipulator`"):
        load_arm(tmp_path, gripper="manipulatr")
