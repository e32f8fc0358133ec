"""Drawn positions, poses and lines against Pinocchio and the limits; shrinking towards home."""

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, Phase, find, given, settings

from harness.planning.ik.kinematics import PinocchioKinematics
from harness.plugins.iktest.strategies import (
    joint_paths,
    joint_positions,
    load_chain,
    near_limit_positions,
    near_singular_positions,
    poses_around,
    reachable_poses,
    scenarios,
    straight_lines,
    unreachable_poses,
)
from harness.plugins.iktest.strategies.tasks import manipulability, natural_task
from harness.session.check import check_file

EACH_ARM = pytest.mark.parametrize("chain", ["open_manipulator_x", "ur3e"], indirect=True)
FEW = settings(max_examples=30, suppress_health_check=list(HealthCheck))
ENOUGH = settings(FEW, max_examples=500)


@pytest.fixture
def chain(request):
    return load_chain(request.param)


def drawn(strategy, count=60):
    """What a strategy draws, in order."""
    found = []

    @settings(FEW, max_examples=count, phases=[Phase.generate])
    @given(strategy)
    def collect(value):
        found.append(value)

    collect()
    return found


@EACH_ARM
def test_the_chain_is_where_pinocchio_has_it(chain):
    kinematics = PinocchioKinematics(chain.description)
    for positions in drawn(joint_positions(chain), 20):
        shift, turn = chain.link_pose(positions).distance_to(
            kinematics.link_pose(chain.whole(positions), chain.link)
        )
        assert max(shift, turn) < 1e-9


@EACH_ARM
def test_the_jacobian_is_the_change_of_the_pose(chain):
    step = 1e-6
    for positions in drawn(joint_positions(chain), 10):
        jacobian = chain.jacobians(positions[None])[0][0]
        for index, move in enumerate(step * np.eye(chain.dof)):
            before, after = chain.link_pose(positions - move), chain.link_pose(positions + move)
            linear = (after.translation - before.translation) / (2 * step)
            turn = after.rotation @ before.rotation.T
            angular = np.array([turn[2, 1], turn[0, 2], turn[1, 0]]) - np.array(
                [turn[1, 2], turn[2, 0], turn[0, 1]]
            )
            assert np.allclose(jacobian[:3, index], linear, atol=1e-6)
            assert np.allclose(jacobian[3:, index], angular / (4 * step), atol=1e-6)


@pytest.mark.nightly(but=["open_manipulator_x"])
@EACH_ARM
def test_positions_fill_the_limits_and_stay_inside(chain):
    for strategy in (joint_positions(chain), near_limit_positions(chain),
                     near_singular_positions(chain)):  # fmt: skip
        found = np.array(drawn(strategy))
        assert np.all(found >= chain.lower)
        assert np.all(found <= chain.upper)
    everywhere = np.array(drawn(joint_positions(chain), 500))
    share = (everywhere - chain.lower) / (chain.upper - chain.lower)
    for values in map(np.unique, share.T):  # Hypothesis repeats constants of whatever is imported
        assert np.quantile(values, 0.2) < 0.35
        assert np.quantile(values, 0.8) > 0.65


@EACH_ARM
def test_positions_near_limits_have_a_joint_within_a_hundredth_of_one(chain):
    for positions in drawn(near_limit_positions(chain)):
        away = np.minimum(positions - chain.lower, chain.upper - positions)
        assert away.min() <= 0.01 + 1e-12


@pytest.mark.nightly(but=["ur3e"])
@EACH_ARM
def test_positions_near_singularities_are_far_more_singular_than_others(chain):
    task = natural_task(chain)
    near = manipulability(chain, task, np.array(drawn(near_singular_positions(chain))))
    others = manipulability(chain, task, np.array(drawn(joint_positions(chain))))
    assert np.quantile(near, 0.9) < 0.02
    assert np.median(near) < 0.02 * np.median(others)


@EACH_ARM
def test_reachable_poses_carry_what_reaches_them(chain):
    for target in drawn(reachable_poses(chain), 20):
        again = chain.link_pose(target.joint_positions)
        assert np.array_equal(again.matrix(), target.pose.matrix())


@pytest.mark.nightly(but=["True-ur3e"])
@EACH_ARM
@pytest.mark.parametrize("any_orientation", [True, False])
def test_no_joint_positions_reach_an_unreachable_pose(chain, any_orientation):
    """Thousands of random states come close to the sphere, none to a pose outside it."""
    rng = np.random.default_rng(1)
    states = rng.uniform(chain.lower, chain.upper, (3000, chain.dof))
    tool_to_link = chain.tip.inverse()
    poses = [chain.link_pose(state) for state in states]
    if not any_orientation:
        poses = [pose @ tool_to_link for pose in poses]
    places = np.array([pose.translation for pose in poses])
    centre, radius = chain.farthest()
    radius += float(np.linalg.norm(chain.tip.translation)) if any_orientation else 0.0
    reached = np.linalg.norm(places - centre, axis=1).max()
    assert 0.8 * radius < reached <= radius
    for target in drawn(unreachable_poses(chain, any_orientation=any_orientation), 30):
        last = target.pose if any_orientation else target.pose @ tool_to_link
        assert np.linalg.norm(last.translation - centre) > radius * 1.0009


@pytest.mark.nightly(but=["open_manipulator_x"])
@EACH_ARM
def test_lines_are_straight_and_their_joints_never_jump(chain):
    lengths = []
    for line in drawn(straight_lines(chain), 30):
        poses = [chain.link_pose(each) for each in line.joint_positions]
        away = np.array([pose.translation - poses[0].translation for pose in poses])
        along = away @ line.direction
        assert np.linalg.norm(away - along[:, None] * line.direction, axis=1).max() < 1e-6
        assert np.all(line.joint_positions >= chain.lower)
        assert np.all(line.joint_positions <= chain.upper)
        steps = np.abs(np.diff(line.joint_positions, axis=0))
        assert steps.size == 0 or steps.max() <= 0.1
        if natural_task(chain) == "pose":
            assert all(pose.distance_to(poses[0])[1] < 1e-6 for pose in poses)
        lengths.append(along.max())
    assert np.mean(lengths) > 0.02


def test_paths_and_poses_anywhere_are_drawn():
    chain = load_chain("ur3e")
    for path in drawn(joint_paths(chain, min_size=3, max_size=4), 10):
        assert path.waypoints.shape[1] == 6
        assert 3 <= len(path.waypoints) <= 4
    known = [target.joint_positions is not None for target in drawn(poses_around(chain))]
    assert 0 < sum(known) < len(known)


@pytest.mark.nightly(but=["open_manipulator_x"])
@EACH_ARM
def test_what_fails_everywhere_shrinks_to_home(chain):
    assert np.array_equal(find(joint_positions(chain), lambda _: True, settings=FEW), chain.home)
    pose = find(reachable_poses(chain), lambda _: True, settings=FEW).pose
    assert pose.distance_to(chain.link_pose(chain.home)) == (0.0, 0.0)


@pytest.mark.nightly
def test_what_needs_one_joint_shrinks_to_that_joint_at_its_threshold():
    chain = load_chain("open_manipulator_x")
    found = find(joint_positions(chain), lambda q: q[0] < -1.2345, settings=ENOUGH)
    assert found == pytest.approx([-1.25, *chain.home[1:]])


def test_drawn_scenarios_are_valid(tmp_path):
    for number, document in enumerate(drawn(scenarios(), 5)):
        file = tmp_path / f"{number}.scenario.yaml"
        file.write_text(yaml.safe_dump(document), encoding="utf-8")
        assert not check_file(file).problems, document
