"""Edges checked in two stages: the covers never say what the exact shapes do not."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import coal
import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Shape, Sphere
from harness.planning.collision.checker import MotionChecker
from harness.planning.collision.compiled import use_compiled
from harness.planning.collision.sphere_cover import cover, cover_shapes, signed_distance
from harness.planning.model.robot_model import GroupSpace
from harness.ports import JointGoal, PlanningOptions
from harness.robot.mesh_file import convex_hull
from tests.planning.lesson import ARM, FIRST_BOXES, Cell, at, boxes, open_manipulator, thing, ur

pytest.importorskip("numba")

SOLIDS = [
    Box((0.16, 0.11, 0.1)),
    Box((0.05, 0.006, 0.02)),
    Cylinder(0.04, 0.25),
    Cylinder(0.07, 0.01),
    Capsule(0.045, 0.19),
    Sphere(0.03),
]


@pytest.fixture
def stages():
    """Switches the compiled stage on and off; as it was afterwards."""
    yield use_compiled
    use_compiled("when it pays")


def points_inside(solid, generator):
    """Points of a solid, many of them at its edges."""
    reach = np.array(solid.size if isinstance(solid, Box) else (0.1, 0.1, 0.3))
    points = np.clip(generator.uniform(-0.6, 0.6, (20_000, 3)), -0.5, 0.5) * reach
    return points[signed_distance(solid, points) <= 1e-12][:400]


def reaches_a_leaf(found, point):
    """Walk down the tree as the compiled stage does."""
    node = 0
    while node < len(found.skip):
        if np.linalg.norm(found.centers[node] - point) > found.outer[node] + 1e-9:
            node = found.skip[node]
        elif found.skip[node] == node + 1:
            return True
        else:
            node += 1
    return False


@pytest.mark.parametrize("solid", SOLIDS, ids=str)
def test_every_point_of_a_solid_is_in_a_leaf_and_in_every_sphere_above_it(solid):
    points = points_inside(solid, np.random.default_rng(1))
    assert len(points) > 50
    assert all(reaches_a_leaf(cover(solid), point) for point in points)


@pytest.mark.parametrize("solid", SOLIDS, ids=str)
def test_the_ball_inside_every_sphere_of_a_solid_is_inside_the_solid(solid):
    found = cover(solid)
    depths = -signed_distance(solid, found.centers)
    assert np.all(found.inner <= depths + 1e-9)


def test_a_hull_is_covered_and_the_balls_inside_it_touch_it(tmp_path):
    mesh = Mesh(write_mesh(tmp_path))
    found = cover(mesh)
    hull = convex_hull(mesh)
    corners = np.array(hull.points()).reshape(-1, 3)
    generator = np.random.default_rng(5)
    for weights in generator.dirichlet(np.full(len(corners), 0.3), 400):
        assert reaches_a_leaf(found, weights @ corners)
    for node in generator.integers(len(found.outer), size=60):
        ball = coal.Sphere(1e-6)
        pose = coal.Transform3s(np.eye(3), found.centers[node])
        result = coal.DistanceResult()
        away = coal.distance(hull, coal.Transform3s(), ball, pose, coal.DistanceRequest(), result)
        assert away <= -found.inner[node] + 2e-5


def test_a_mesh_is_covered_and_each_inner_radius_reaches_a_point_of_it(tmp_path):
    mesh = Mesh(write_mesh(tmp_path), collision="exact")
    found = cover(mesh)
    generator = np.random.default_rng(4)
    loaded = coal.MeshLoader().load(str(mesh.path), np.ones(3))
    vertices = np.array(loaded.vertices())
    for _ in range(200):
        face = loaded.tri_indices(int(generator.integers(loaded.num_tris)))
        weights = generator.dirichlet(np.ones(3))
        point = weights @ vertices[[face[0], face[1], face[2]]]
        assert reaches_a_leaf(found, point)
    for node in generator.integers(len(found.outer), size=60):
        ball = coal.Sphere(1e-6)
        pose = coal.Transform3s(np.eye(3), found.centers[node])
        result = coal.DistanceResult()
        away = coal.distance(loaded, coal.Transform3s(), ball, pose, coal.DistanceRequest(), result)
        assert max(away, 0.0) <= -found.inner[node] + 1e-5


def write_mesh(folder: Path) -> Path:
    """A bent bar of two boxes, as a mesh file."""
    corners, faces = [], []
    for size, middle in (((0.3, 0.05, 0.05), (0, 0, 0)), ((0.05, 0.05, 0.2), (0.15, 0, 0.1))):
        base = len(corners) + 1
        for x in (-1, 1):
            for y in (-1, 1):
                for z in (-1, 1):
                    corners.append(
                        [m + 0.5 * s * d for m, s, d in zip(middle, size, (x, y, z), strict=True)]
                    )
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        for a, b, c, d in quads:
            faces += [(base + a, base + b, base + c), (base + a, base + c, base + d)]
    path = folder / "bar.obj"
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += [f"f {a} {b} {c}" for a, b, c in faces]
    path.write_text("\n".join(lines) + "\n")
    return path


def meshed(description, collision):
    """The robot with the meshes it is drawn with as collision shapes of its last links."""
    links = []
    for link in description.links:
        meshes = tuple(
            replace(shape, geometry=replace(shape.geometry, collision=collision))
            for shape in link.visuals
            if isinstance(shape.geometry, Mesh)
        )
        is_small = link.name in ("wrist_3_link",)
        links.append(replace(link, collisions=meshes) if meshes and is_small else link)
    return replace(description, links=tuple(links))


def crowded(description, folder):
    """A cell with boxes, a mesh in the way, and something in the hand."""
    cell = Cell(description)
    cell.add(boxes(*FIRST_BOXES))
    bar = Mesh(write_mesh(folder), collision="exact")
    cell.add(thing("bar", at(0.25, -0.35, 1.35, (0.3, 0.5, 0)), Shape(bar)))
    tip = cell.kinematics.link_pose(cell.state, description.tcp_link)
    cell.add(thing("held", tip, Shape(Cylinder(0.02, 0.12))))
    gripper = description.gripper
    cell.scene.attach_object(
        "held", description.tcp_link, [*gripper.links, gripper.palm_link], cell.state
    )
    return cell


ROBOTS = {
    "ur3e": (lambda: ur("ur3e"), ARM),
    "ur5e with a mesh": (lambda: meshed(ur("ur5e"), "exact"), ARM),
    "ur5e with a hull": (lambda: meshed(ur("ur5e"), "hull"), ARM),
    "open_manipulator_x": (open_manipulator, "arm"),
}


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("padding", [0.0, 0.01])
def test_verdicts_and_counts_are_the_same_with_and_without_the_compiled_stage(
    name, padding, stages, tmp_path
):
    make, group = ROBOTS[name]
    cell = crowded(make(), tmp_path)
    space = GroupSpace(cell.kinematics.robot, group, cell.state)
    start = space.part(cell.state)
    checker = MotionChecker(cell.scene, space, start, padding)
    generator = np.random.default_rng(7)
    lower, upper = np.maximum(space.lower, -3), np.minimum(space.upper, 3)
    seen = {True: 0, False: 0}
    while min(seen.values()) < 40:
        first = start + generator.normal(0, 0.4, space.dof) * generator.integers(0, 2)
        first = np.clip(first, lower, upper)
        second = np.clip(first + generator.normal(0, 0.5, space.dof), lower, upper)
        stages("never")
        if not checker.state_free(first):
            continue
        verdicts, counts = [], []
        for when in ("never", "always"):
            stages(when)
            before = checker.checks
            verdicts.append(checker.edge_free(first, second, 1 / 40))
            counts.append(checker.checks - before)
        assert verdicts[0] == verdicts[1]
        assert counts[0] == counts[1]
        seen[verdicts[0]] += 1


def test_a_bent_motion_is_judged_alike_and_its_first_blocked_state_is_found(stages, tmp_path):
    cell = crowded(ur("ur3e"), tmp_path)
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    start = space.part(cell.state)
    checker = MotionChecker(cell.scene, space, start, 0.002)
    generator = np.random.default_rng(3)
    found = []
    for _ in range(30):
        bends = np.vstack([start, start + generator.normal(0, 0.5, (2, 6))])
        shares = np.linspace(0, 2, 181)
        states = np.column_stack([np.interp(shares, [0, 1, 2], column) for column in bends.T])
        answers = []
        for when in ("never", "always"):
            stages(when)
            answers.append(checker.first_blocked(states))
        assert answers[0] == answers[1]
        found.append(answers[0])
    assert None in found
    assert any(index is not None for index in found)


def test_plans_are_the_same_with_and_without_the_compiled_stage(stages):
    plans = []
    for when in ("never", "always"):
        stages(when)
        cell = Cell(ur("ur5e"))
        cell.state = cell.with_arm(cell.named("mogi_down"))
        cell.add(boxes(*FIRST_BOXES))
        goal = JointGoal(cell.named("up"))
        plans.append(cell.planner.plan(ARM, cell.state, goal, PlanningOptions(seed=3)))
    assert plans[0].statistics == plans[1].statistics
    assert np.array_equal(plans[0].trajectory.positions, plans[1].trajectory.positions)


def test_without_numba_everything_works_and_with_it_nothing_is_loaded_early():
    program = """
import sys
if {hide}: sys.modules["numba"] = None
from harness.planning.collision import compiled
from tests.planning.lesson import Cell, ARM, FIRST_BOXES, boxes, ur
from harness.ports import JointGoal, PlanningOptions
from harness.robot.mesh_file import convex_hull
cell = Cell(ur("ur3e"))
if {hide}: compiled.use_compiled("always")
plan = cell.planner.plan(ARM, cell.state, JointGoal(cell.named("up")), PlanningOptions())
assert {hide} or "numba" not in sys.modules
assert not {hide} or compiled.compiled_stage() is None
print(plan.trajectory.duration)
"""
    durations = [
        subprocess.run(
            [sys.executable, "-c", program.format(hide=hide)],
            capture_output=True,
            text=True,
            check=True,
            cwd=Path(__file__).parents[2],
        ).stdout
        for hide in (True, False)
    ]
    assert durations[0] == durations[1]


def test_shapes_that_move_together_have_one_tree():
    shapes = [Shape(Box((0.1, 0.02, 0.02)), at(0.05, 0, 0)), Shape(Capsule(0.02, 0.1), at(0, 0, 1))]
    found = cover_shapes(shapes)
    assert found.skip[0] == len(found.outer)
    assert np.all(np.linalg.norm(found.centers - found.centers[0], axis=1) <= found.outer[0] + 1e-6)
