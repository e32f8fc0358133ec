"""What the compiled computation finds within effort limits is what Pinocchio finds."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.planning.collision.collision_model import SceneObject
from harness.planning.efforts import InverseDynamics
from harness.planning.model.robot_model import GroupSpace, RobotModel
from harness.robot.load import load_robot


def drawn_dynamics(rng, folder):
    """A tree of joints of all kinds, some of which the group moves, with a load at its tip."""
    count = int(rng.integers(2, 9))
    parts, chain = ['<link name="base"/>'], ["base"]
    for number in range(count):
        is_side = number > 0 and rng.random() < 0.3
        parent = f"l{rng.integers(number)}" if is_side else chain[-1]
        chain += [] if is_side else [f"l{number}"]
        square, mass = rng.uniform(0.02, 0.3, 3) ** 2, rng.uniform(0.1, 5)
        a, b, c = mass / 12 * (square.sum() - square)
        x, y, z, i, j, k = rng.uniform(-1, 1, 6)
        mimic = '<mimic joint="j0" multiplier="-0.7" offset="0.2"/>' if is_side else ""
        parts.append(
            f'<link name="l{number}"><inertial><origin xyz="{i} {j} {k}" rpy="{z} {y} {x}"/>'
            f'<mass value="{mass}"/><inertia ixx="{a}" iyy="{b}" izz="{c}" ixy="0" ixz="0" '
            f'iyz="0"/></inertial></link><joint name="j{number}" '
            f'type="{rng.choice(["revolute", "continuous", "prismatic"])}">'
            f'<parent link="{parent}"/><child link="l{number}"/><axis xyz="{j} {k} {i}"/>'
            f'<origin xyz="{x} {y} {z}" rpy="{z} {x} {y}"/>{mimic}'
            '<limit lower="-9" upper="9" velocity="2" effort="5000"/></joint>'
        )
    (folder / "arm.urdf").write_text(f'<robot name="arm">{"".join(parts)}</robot>')
    group = f'<group name="arm"><chain base_link="base" tip_link="{chain[-1]}"/></group>'
    (folder / "arm.srdf").write_text(f'<robot name="arm">{group}</robot>')
    robot = RobotModel(load_robot(RobotSpec(urdf="arm.urdf", srdf="arm.srdf"), folder))
    held = SE3.from_xyz_rpy(tuple(rng.uniform(-1, 1, 3)), tuple(rng.uniform(-1, 1, 3)))
    inertia = np.diag([0.02, 0.03, 0.04])
    load = SceneObject("load", (), held, chain[-1], mass=2.0, inertia=inertia)
    return InverseDynamics.of(GroupSpace(robot, "arm", rng.uniform(-2, 2, count)), [load])


@pytest.mark.parametrize("seed", range(8))
def test_each_effort_is_found_clearly_within_a_limit_right_above_it_alone(seed, tmp_path):
    rng = np.random.default_rng(seed)
    dynamics = drawn_dynamics(rng, tmp_path)
    states = rng.uniform(-3, 3, (3, int(rng.integers(1, 6)), len(dynamics.limits)))
    most = np.abs(dynamics.efforts(*states)).max(axis=0)
    for joint, effort in enumerate(most):
        for away in (1e-7 * most.max(), -1e-7 * most.max()):
            limits = np.full(len(most), np.inf)
            limits[joint] = effort + away
            assert replace(dynamics, limits=limits).are_clearly_within(1.0, *states) == (away > 0)


def test_an_effort_at_its_limit_is_left_to_pinocchio(tmp_path):
    rng = np.random.default_rng(1)
    dynamics = drawn_dynamics(rng, tmp_path)
    still = np.zeros((1, len(dynamics.limits)))
    exact = replace(dynamics, limits=np.abs(dynamics.efforts(still, still, still)[0]))
    assert not exact.are_clearly_within(1.0, still, still, still)
    assert exact.can_hold(still)
