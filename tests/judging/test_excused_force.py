"""What an excuse of a contact explains, in newtons and metres worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.judging.excused_force import (
    DRAG,
    dragged,
    grip_force,
    hand_limit,
    held_limit,
    load_of,
    mean_force,
)
from tests.judging.synthetic_run import (
    BOX,
    ROBOT,
    TABLE,
    at,
    changed,
    force,
    make_run,
    thing,
)

N = 40
WEIGHT = 0.98


def gripping(effort, widths=((0.0, 0.0), (0.03, 0.06)), position=0.02):
    """A run in which the gripper's joint exerts an effort."""
    run = make_run(
        N,
        robot=replace(
            ROBOT, gripper=replace(ROBOT.gripper, widths=np.array(widths).reshape(-1, 2))
        ),
    )
    efforts, positions = np.zeros((N, 2)), run.signals.joint_positions.copy()
    efforts[:, 0], efforts[:, 1], positions[:, 1] = 99.0, effort, position
    return changed(run, joint_efforts=efforts, joint_positions=positions)


@pytest.mark.parametrize("effort", [4.0, -4.0])
def test_the_grip_does_the_work_of_the_grippers_motor(effort):
    """The gap changes twice as fast as the joint, and the other way round as well."""
    assert grip_force(gripping(effort)) == pytest.approx(2.0)
    assert grip_force(gripping(effort, ((0.0, 0.06), (0.03, 0.0)))) == pytest.approx(2.0)
    bent = ((0.02, 0.05), (0.0, 0.0), (0.01, 0.04))  # slopes of 4 at 0.005 m and 1 at 0.015 m
    assert grip_force(gripping(effort, bent, 0.005)) == pytest.approx(1.0)
    assert grip_force(gripping(effort, bent, 0.001)) == pytest.approx(1.0)
    assert grip_force(gripping(effort, bent, 0.01)) == pytest.approx(4 / 2.5)
    assert grip_force(gripping(effort, bent, 0.015)) == pytest.approx(4.0)
    assert grip_force(gripping(effort, ((0.0, 0.05), (0.03, 0.05)))) == pytest.approx(4e9)


@pytest.mark.parametrize("widths", [(), ((0.0, 0.0),)])
def test_a_grip_is_not_known_without_two_widths(widths):
    assert np.isinf(grip_force(gripping(4.0, widths))).all()


def test_forces_are_means_of_fifty_milliseconds():
    run = make_run(N, contact_forces={("palm", "box"): force(N, (20, 21), value=6.0)})
    mean = mean_force(run, "box", "palm")
    assert np.flatnonzero(mean).tolist() == list(range(20, 26))
    assert mean[20:26] == pytest.approx(1.0)
    efforts = np.zeros((N, 2))
    efforts[20, 1] = 12.0
    assert grip_force(changed(run, joint_efforts=efforts))[20:26] == pytest.approx(1.0)


def test_what_rests_on_an_object_is_part_of_its_load():
    cup, lid = thing("cup", mass=0.3), thing("lid", mass=0.5, static=True)
    forces = {
        ("box", "cup"): np.full(N, 3.0),
        ("box", "lid"): np.full(N, 3.0),
        ("arm_link", "cup"): force(N, (20, N)),
    }
    poses = {name: at(N, (0, 0, 0.06)) for name in ("cup", "lid")}
    run = make_run(N, objects=(TABLE, BOX, cup, lid), object_poses=poses, contact_forces=forces)
    load = load_of(run, "box")
    assert load[:20] == pytest.approx(4 * WEIGHT)
    assert load[20:] == pytest.approx(WEIGHT)
    assert load_of(run, "cup") == pytest.approx(3 * WEIGHT)


def test_limits_are_twice_what_is_explained_and_a_newton():
    run = gripping(4.0)
    assert hand_limit(run, "box") == pytest.approx(2 * (2.0 + WEIGHT) + 1)
    moves = np.arange(N) >= 20
    limit = held_limit(run, "box", moves)
    assert limit[:20] == pytest.approx(2 * WEIGHT + 1)
    assert limit[20:] == pytest.approx(2 * (2.0 + WEIGHT) + 1)


def test_an_object_is_dragged_by_its_motion_relative_to_the_other_since_a_sample():
    poses, moving = at(N), at(N)
    poses[:, :3] = np.arange(N)[:, None] * (0.003, 0.0, 0.004)
    run = make_run(N, object_poses={"box": poses, "Table": at(N, (1, 2, 3))})
    assert dragged(run, "box", "Table", 10, 14) == pytest.approx([0, 0.005, 0.01, 0.015])
    assert dragged(run, "box", "palm", 10, 14) == pytest.approx([0, 0.005, 0.01, 0.015])
    moving[:, :3] = poses[:, :3]
    along = make_run(N, object_poses={"box": poses, "Table": moving})
    assert dragged(along, "box", "Table", 0, N) == pytest.approx(0.0)
    assert DRAG == 0.02


def test_an_object_slides_in_the_gaps_of_a_contact_as_before_and_not_where_a_step_puts_it():
    slid = np.zeros(N)
    slid[12:18] = 0.004
    touching = force(N, (10, 14)) + force(N, (16, 18))
    run = make_run(N, slides={("Table", "box"): slid}, contact_forces={("Table", "box"): touching})
    whole = [0, 0, 0.004, 0.008, 0.012, 0.016, 0.02, 0.024]
    assert dragged(run, "box", "Table", 10, 18) == pytest.approx(whole)
    assert dragged(run, "Table", "box", 10, 18) == pytest.approx(whole)
    assert dragged(run, "box", "Table", 13, 18) == pytest.approx([0, 0, 0, 0.004, 0.008])
    put = replace(BOX, present=((0.0, 0.12), (0.12, 1e9)))
    there = replace(run, objects=(TABLE, put))
    assert dragged(there, "box", "Table", 10, 18)[3] == pytest.approx(0.004)


def test_without_a_record_of_slides_the_middle_of_an_object_is_dragged():
    """It turns about its origin, 30 cm from its middle."""
    far = replace(BOX, center_of_mass=(0.3, 0.0, 0.0))
    poses = at(N)
    poses[20:, 3:] = SE3.from_xyz_rpy(rpy=(0, 0, 0.1)).quat_wxyz
    run = make_run(N, objects=(TABLE, far), object_poses={"box": poses})
    assert dragged(run, "box", "Table", 10, 30)[-1] == pytest.approx(0.6 * np.sin(0.05))


def test_an_object_is_dragged_where_it_is_not_known_how_far_it_slides():
    slid = np.zeros(N)
    slid[20] = np.nan
    touching = {("Table", "box"): force(N, (0, N))}
    run = make_run(N, slides={("Table", "box"): slid}, contact_forces=touching)
    assert dragged(run, "box", "Table", 10, 30).max() >= DRAG
    assert dragged(run, "box", "Table", 21, 30).max() == 0
