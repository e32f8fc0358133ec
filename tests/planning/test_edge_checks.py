"""The compiled check of motions gives the verdicts of Coal's check of every state."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Shape, Sphere
from harness.planning.collision.certificates import MotionArrays
from harness.planning.collision.checker import MotionChecker
from harness.planning.collision.rigid_shapes import RigidShapes
from harness.planning.collision.sampled_motion import SampledMotion
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import JointGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import FreeMotion
from tests.planning.lesson import ARM, FIRST_BOXES, Cell, at, boxes, open_manipulator, thing, ur
from tests.planning.problem import HOMES, description_of
from tests.second_opinion.runs import SRDF, URDF
from tests.session.front_door import run


@pytest.fixture
def stages(monkeypatch):
    """Switches the compiled check on and off: without it, all states are left to Coal."""
    compiled = MotionArrays.certify

    def nothing(_arrays, _check, _motion, low, high):
        return -1, np.array([[low, high]])

    def choose(when):
        monkeypatch.setattr(MotionArrays, "certify", compiled if when == "always" else nothing)

    return choose


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


@pytest.mark.nightly(but=["0.0-0.025-open_manipulator_x"])
@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize(("padding", "resolution"), [(0.0, 1 / 40), (0.01, 1 / 40), (0.0, 1 / 250)])
def test_verdicts_and_counts_are_the_same_with_and_without_the_compiled_check(
    name, padding, resolution, stages, tmp_path
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
            verdicts.append(checker.edge_free(first, second, resolution))
            counts.append(checker.checks - before)
        assert verdicts[0] == verdicts[1]
        assert counts[0] == counts[1]
        seen[verdicts[0]] += 1


@pytest.mark.nightly(but=["40-2"])
@pytest.mark.parametrize(("corners", "motions"), [(2, 30), (40, 2), (40, 4), (400, 20)])
def test_a_bent_motion_is_judged_alike_and_its_first_blocked_state_is_found(
    corners, motions, stages, tmp_path
):
    cell = crowded(ur("ur3e"), tmp_path)
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    start = space.part(cell.state)
    checker = MotionChecker(cell.scene, space, start, 0.002)
    generator = np.random.default_rng(3)
    found = []
    for _ in range(motions):
        far = generator.normal(0, 0.5, 6)
        bent = generator.normal(0, 1 / corners, (corners, 6))
        bends = np.vstack([start, start + np.linspace(0, 1, corners)[:, None] * far + bent])
        motion = SampledMotion.of(bends, space.metric, 1 / 90)
        each = [place for place in range(motion.last + 1) if checker.touches(motion.state(place))]
        for when in ("never", "always"):
            stages(when)
            blocked = checker.first_block(bends, 1 / 90)
            assert checker.path_free(bends, 1 / 90) == (blocked is None) == (not each)
            if blocked is not None:
                row, state, _ = blocked
                assert row == motion.row(each[0])
                assert np.array_equal(state, motion.state(each[0]))
        found.append(bool(each))
    assert {*found} == {True, False}


@pytest.mark.nightly(but=["always"])
@pytest.mark.parametrize("when", ["never", "always"])
def test_a_motion_that_ends_exactly_at_its_margin_is_judged_as_its_last_state(
    when, stages, tmp_path
):
    """The fingers end 2 mm above the ground, which is the padding, but for rounding."""
    (tmp_path / "gantry.urdf").write_text(URDF)
    (tmp_path / "gantry.srdf").write_text(SRDF)
    stages(when)
    robot = "{urdf: gantry.urdf, srdf: gantry.srdf, start_state: {named_target: ready}}"
    result, _ = run(tmp_path, "- ptp: {joints: {slide: 0.0, lift: 0.072}}", robot=robot)
    assert result.outcome == "passed"


@pytest.mark.nightly  # Coal checks each of the finest states: two minutes
def test_plans_are_the_same_with_and_without_the_compiled_check(stages):
    plans = []
    for when in ("never", "always"):
        stages(when)
        cell = Cell(open_manipulator(), with_tables=False)
        cell.state = cell.with_arm([-0.6, 0.6, -0.3, 0.4])
        cell.add(thing("wall", at(0.3, 0.0, 1.1), Shape(Box((0.1, 0.02, 0.2)))))
        goal = JointGoal(np.array([0.6, 0.6, -0.3, 0.4]))
        plans.append(
            cell.planner.plan(
                MotionRequest("arm", cell.state, FreeMotion(goal), PlanningOptions(seed=3))
            )
        )
    assert plans[0].statistics.parts[0].waypoints > 2
    assert plans[0].statistics == plans[1].statistics
    assert np.array_equal(plans[0].trajectory.positions, plans[1].trajectory.positions)


@pytest.mark.nightly(but=["open_manipulator_x-gripper", "open_manipulator_x-arm"])
@pytest.mark.parametrize("kind", ["arm", "gripper"])
@pytest.mark.parametrize("model", list(HOMES))
def test_whole_motions_are_as_free_as_their_states(model, kind, stages):
    """Straight ones and bent ones, with and without padding, of revolute and prismatic joints."""
    cell = cell_with_stick(model)
    groups = {"arm": cell.description.arm_group, "gripper": cell.description.gripper.group}
    space = GroupSpace(cell.kinematics.robot, groups[kind], cell.state)
    home = space.part(cell.state)
    generator = np.random.default_rng(2)
    verdicts = []
    for padding in (0.0, 0.02):
        checker = MotionChecker(cell.scene, space, home, padding)
        for number in range(20):
            start = drawn(space, generator)
            end = start + generator.normal(size=space.dof) * (0.1, 0.4)[number % 2]
            states = line(start, np.clip(end, space.lower, space.upper), space)
            stages("never")
            each = [checker.state_free(state) for state in states]
            verdicts.append(all(each))
            stages("always")
            assert checker.edge_free(start, states[-1], 1 / 512) == verdicts[-1]
            blocked = checker.first_block(np.array([start, states[-1]]), 1 / 512)
            assert (blocked is None) == verdicts[-1]
            if blocked is not None:
                assert blocked[0] == (each.index(False) + 1) / len(states)
    assert 0.1 < np.mean(verdicts) < 0.98 or kind == "gripper"


@pytest.mark.parametrize("model", list(HOMES))
def test_a_motion_that_only_just_touches_on_its_way_is_not_free(model, stages):
    """It goes 3 mrad beyond the last free state, and back."""
    stages("always")
    cell = cell_with_stick(model)
    space = GroupSpace(cell.kinematics.robot, cell.description.arm_group, cell.state)
    checker = MotionChecker(cell.scene, space, np.array(HOMES[model]), 0.0)
    generator = np.random.default_rng(6)
    seen = 0
    while seen < 60:
        free, blocked = (drawn(space, generator) for _ in range(2))
        if not checker.state_free(free) or checker.state_free(blocked):
            continue
        start = free
        while space.distance(free, blocked) > 0.003:
            middle = 0.5 * (free + blocked)
            free, blocked = (middle, blocked) if checker.state_free(middle) else (free, middle)
        back = blocked + (start - blocked) * generator.uniform(0.1, 0.9)
        seen += 1
        assert not checker.path_free(np.array([start, blocked, back]), 1 / 512)


@pytest.mark.nightly
def test_states_at_20_micrometres_from_their_margin_are_judged_by_the_distance(stages, tmp_path):
    """The padding is set next to the distance that Coal measures, for solids of every kind."""
    stages("always")
    cell = crowded(meshed(ur("ur5e"), "hull"), tmp_path)
    for number, solid in enumerate((Capsule(0.04, 0.2), Sphere(0.05), Cylinder(0.03, 0.1))):
        cell.add(thing(f"solid{number}", at(0.3, -0.1 * number, 1.5, (0.4, 0.3, 0)), Shape(solid)))
    space = GroupSpace(cell.kinematics.robot, ARM, cell.state)
    generator = np.random.default_rng(9)
    nearest = set()
    for _ in range(300):
        state = drawn(space, generator)
        padded = [touch for touch, padded in cell.scene.distances(space.whole(state)) if padded]
        others = [
            touch.distance
            for touch, padded in cell.scene.distances(space.whole(state))
            if not padded
        ]
        if min(others) < 1e-3 or not 1e-3 < padded[0].distance < 0.05:
            continue
        pair = padded[0].first, padded[0].second
        for shift in (-2e-5, 2e-5):
            padding = padded[0].distance + shift
            checker = MotionChecker(cell.scene, space, space.part(cell.state), padding)
            if pair not in {lowered.pair for lowered in checker.lowered}:
                assert checker.state_free(state) == (shift < 0)
                nearest.add(pair[1])
    assert len(nearest) >= 4


@pytest.mark.parametrize("collision", ["hull", "exact"])
def test_every_node_of_a_tree_contains_what_is_below_it(collision, tmp_path):
    shapes = [
        Shape(Mesh(write_mesh(tmp_path), collision=collision), at(0.1, 0, 0, (0.3, 0, 1))),
        Shape(Capsule(0.02, 0.1), at(0, 0, 1)),
        Shape(Cylinder(0.05, 0.1), at(0, 1, 0, (1, 2, 0))),
    ]
    rigid = RigidShapes(0, tuple(shapes), at(0.2, 0.1, 0, (1, 0, 0)))
    tree = rigid.tree
    low, high = rigid.box.reshape(2, 3)
    for node, (end, _) in enumerate(tree.nodes):
        center, radius = tree.spheres[node, :3], tree.spheres[node, 3]
        for below in range(node, end):
            if tree.nodes[below, 1] < 0:
                continue
            first, last, kind = tree.convexes[tree.nodes[below, 1]]
            points = tree.points[first:last] if kind < 2 else tree.spheres[below, None, :3]
            assert np.all(np.linalg.norm(points - center, axis=1) <= radius + 1e-9)
            assert np.all((low - 1e-9 <= points) & (points <= high + 1e-9))
    assert np.sum(tree.nodes[:, 0] == np.arange(len(tree.nodes)) + 1) == (
        24 + 2 if collision == "exact" else 3
    )


def cell_with_stick(model):
    """The lesson's tables and boxes, the arm at home, a stick in its hand."""
    cell = Cell(description_of(model))
    cell.add(boxes(*FIRST_BOXES))
    cell.state = cell.with_arm(HOMES[model])
    tcp = cell.kinematics.link_pose(cell.state, cell.description.tcp_link)
    cell.add(thing("stick", tcp @ at(0.05, 0, 0), Shape(Box((0.2, 0.01, 0.01)))))
    hand = cell.description.gripper.links
    cell.scene.attach_object("stick", cell.description.tcp_link, hand, cell.state)
    return cell


def drawn(space, generator):
    """Group positions within limits, a turn each way where there are none."""
    return generator.uniform(np.maximum(space.lower, -np.pi), np.minimum(space.upper, np.pi))


def line(first, second, space):
    """States every 1/512 rad, the first left out."""
    count = max(1, int(np.ceil(space.distance(first, second) * 512)))
    return first + (second - first) * np.arange(1, count + 1)[:, None] / count
