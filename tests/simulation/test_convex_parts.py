"""Meshes that a convex hull would fill: planner and physics see the same parts of them."""

from itertools import product

import coal
import mujoco
import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.language.world import ObjectSpec
from harness.planning.collision.scene import CoalScene
from harness.robot.load import load_robot
from harness.robot.solids import coal_geometry
from harness.simulation.model import build_model
from harness.world.objects import resolve_object
from tests.robot.arm_files import SHAPE, SRDF, URDF
from tests.robot.vessels import vessel, write_obj
from tests.session.front_door import check, run

ARM = "{model: open_manipulator_x}"
CUP = """\
objects:
  - {name: cup, mesh: {file: cup.obj%s}, pose: {xyz: [0.4, 0, 0]}, static: true}
  - {name: ball, sphere: {radius: 0.012}, pose: {xyz: [0.41, 0, 0.12]}}
"""
BIN = """\
objects:
  - {name: bin, mesh: {file: bin.obj%s}, pose: {xyz: [0.2, 0, 0]}, static: true}
"""
INTO_THE_BIN = "- move_to: {position: [0.2, 0, 0.06], pitch: 90 deg}"


@pytest.fixture(scope="module", autouse=True)
def kept(tmp_path_factory):
    """A cache of this module's own, so that each mesh is cut into parts once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


def cup_file(folder):
    return write_obj(folder / "cup.obj", *vessel(sides=12))


def bin_file(folder):
    words = {"sides": 4, "outer": 0.12, "inner": 0.11, "height": 0.05, "floor": 0.005}
    return write_obj(folder / "bin.obj", *vessel(**words))


@pytest.mark.nightly
@pytest.mark.parametrize("mode", ["", ", collision: exact"])
def test_a_ball_that_falls_into_a_cup_stays_in_it(tmp_path, mode):
    cup_file(tmp_path)
    _, record = run(tmp_path, "- wait: 1 s", robot=ARM, rest=CUP % mode)
    x, y, z = record.signals.object_poses["ball"][-1, :3]
    assert np.hypot(x - 0.4, y) < 0.034 - 0.012 + 0.001
    assert z == pytest.approx(0.006 + 0.012, abs=0.004)  # their stated excess


@pytest.mark.nightly
def test_a_ball_stays_on_top_of_the_hull_of_a_cup(tmp_path):
    cup_file(tmp_path)
    _, record = run(tmp_path, "- wait: 0.2 s", robot=ARM, rest=CUP % ", collision: hull")
    assert record.signals.object_poses["ball"][-1, 2] > 0.08


@pytest.mark.nightly
@pytest.mark.parametrize("mode", ["", ", collision: exact"])
def test_a_gripper_reaches_into_a_bin(tmp_path, mode):
    bin_file(tmp_path)
    result, _ = run(tmp_path, INTO_THE_BIN, robot=ARM, rest=BIN % mode)
    assert result.outcome == "passed", result.steps[0].message


def test_a_goal_in_the_hull_of_a_bin_says_that_this_is_its_hull(tmp_path):
    bin_file(tmp_path)
    result, _ = run(tmp_path, INTO_THE_BIN, robot=ARM, rest=BIN % "" + "collision: hull\n")
    assert result.steps[0].error_code == "GOAL_IN_COLLISION"
    said = "\n".join(result.steps[0].explanation)
    assert "bin collides as its convex hull, at most" in said
    assert "(a `collision` of `parts` or `exact` is closer)" in said


def distance(objects, poses):
    """The smallest distance between two objects, with the shapes that the planner has."""
    placed = [
        [(coal_geometry(shape), pose @ shape.pose) for shape in obj.shapes]
        for obj, pose in zip(objects, poses, strict=True)
    ]
    least = np.inf
    for (one, at), (other, other_at) in product(*placed):
        result = coal.DistanceResult()
        places = [coal.Transform3s(each.rotation, each.translation) for each in (at, other_at)]
        coal.distance(one, places[0], other, places[1], coal.DistanceRequest(), result)
        least = min(least, result.min_distance)
    return least


@pytest.mark.nightly
def test_planner_and_physics_agree_on_random_poses_of_a_body_near_a_bin(tmp_path):
    mesh = {"name": "bin", "static": True, "mesh": {"file": str(bin_file(tmp_path))}}
    probe = {"name": "probe", "box": {"size": [0.03, 0.02, 0.04]}, "mass": 0.1}
    objects = [
        resolve_object(ObjectSpec.model_validate(words), SE3.identity(), tmp_path)
        for words in (mesh, probe)
    ]
    description = load_robot(RobotSpec(model="open_manipulator_x", base={"xyz": [5, 0, 0]}))
    physics = build_model(description, objects, ["bin", "probe"], gravity=(0, 0, 0), timestep=0.001)
    place, data = physics.objects["probe"], mujoco.MjData(physics.model)
    rng, agreed = np.random.default_rng(0), []
    for _ in range(400):
        xyz, rpy = rng.uniform([-0.1, -0.1, -0.03], [0.1, 0.1, 0.08]), rng.uniform(-3, 3, 3)
        pose = SE3.from_xyz_rpy(tuple(xyz), tuple(rpy))
        data.qpos[place.qpos : place.qpos + 7] = pose.as_vector()
        mujoco.mj_forward(physics.model, data)
        touching = {
            frozenset(physics.body_names[physics.model.geom_bodyid[geom]] for geom in contact.geom)
            for contact in data.contact
            if contact.dist < 0
        }
        apart = distance(objects, [SE3.identity(), pose])
        if abs(apart) > 1e-4:
            agreed.append((frozenset(("bin", "probe")) in touching, apart < 0))
    assert all(one == other for one, other in agreed)
    assert 0.2 < np.mean([one for one, _ in agreed]) < 0.8


@pytest.mark.nightly
def test_planner_and_physics_agree_on_random_states_of_an_arm_of_meshes(tmp_path):
    ring = {"sides": 6, "outer": 0.45, "inner": 0.4, "height": 0.3, "floor": 0.02}
    write_obj(tmp_path / "ring.obj", *vessel(**ring))
    cup_file(tmp_path)
    mesh = '<collision><origin xyz="0 0 {}"/><geometry><mesh filename="{}.obj"/></geometry>'
    upper, wrist = mesh.format(-0.1, "ring"), mesh.format(0.1, "cup")
    before, first, between, last = URDF.split(SHAPE.removesuffix("</collision>"))
    urdf = before + upper + first + SHAPE.removesuffix("</collision>") + between + wrist + last
    (tmp_path / "arm.urdf").write_text(urdf.replace('lower="-2" upper="2"', 'lower="-3" upper="3"'))
    (tmp_path / "arm.srdf").write_text(SRDF.replace('link2="wrist"', 'link2="lower"'))
    arm = load_robot(RobotSpec(urdf="arm.urdf", srdf="arm.srdf"), tmp_path)
    scene = CoalScene(arm)
    physics = build_model(arm, [], [], gravity=(0, 0, 0), timestep=0.001)
    data = mujoco.MjData(physics.model)
    rng, agreed = np.random.default_rng(0), []
    for _ in range(300):
        state = dict(zip(arm.joint_names, rng.uniform([-3, -3, 0], [3, 3, 0.2]), strict=True))
        for name, position in state.items():
            data.joint(name).qpos = position
        mujoco.mj_forward(physics.model, data)
        touching = {
            frozenset(physics.body_names[physics.model.geom_bodyid[geom]] for geom in contact.geom)
            for contact in data.contact
            if contact.dist < 0
        }
        for touch, _ in scene.distances(np.array(list(state.values()))):
            if abs(touch.distance) > 1e-4:
                agreed.append(
                    (frozenset((touch.first, touch.second)) in touching, touch.distance < 0)
                )
    assert all(one == other for one, other in agreed)
    assert 0.1 < np.mean([one for one, _ in agreed]) < 0.9


def test_an_unknown_link_of_the_robots_collision_is_reported(tmp_path):
    robot = "{model: open_manipulator_x, collision: {link9: hull}}"
    [problem] = check(tmp_path, "- wait: 1 s", robot=robot).problems
    assert "'open_manipulator_x' has no link 'link9'; did you mean `link" in problem.message


WORLD = """\
world: a bench
objects:
  - {name: jug, mesh: {file: gone.stl}, pose: {xyz: [0.3, 0, 0]}, static: true}
  - {name: lid, box: {size: [0.02, 0.02, 0.02]}, pose: {frame: jug, xyz: [0, 0, 0.1]}}
"""
JUG = "objects:\n  - {name: jug, box: {size: [0.1, 0.1, 0.1]}, replace: true, static: true}\n"


def test_an_object_with_a_missing_mesh_can_be_replaced(tmp_path):
    (tmp_path / "bench.world.yaml").write_text(WORLD)
    words = {"robot": ARM, "world": "bench.world.yaml"}
    [problem] = check(tmp_path, "- wait: 1 s", **words).problems
    assert "object 'jug': there is no mesh file 'gone.stl'" in problem.message
    assert "with `replace: true` in `objects` takes its place" in problem.hint
    assert not check(tmp_path, "- wait: 1 s", rest=JUG, **words).problems
