"""Trees of convex sets: hulls above the parts of a body, and trees that are stored."""

import dataclasses

import numpy as np
import pytest

from harness.core.geometry import Box, Mesh, Shape, Sphere
from harness.core.user_cache import cache_folder
from harness.planning.collision import stored_trees
from harness.planning.collision.convex_tree import ConvexTree
from harness.planning.collision.stored_trees import stored_tree
from harness.robot.mesh_file import hull_of
from tests.planning.test_edge_checks import at, write_mesh


def bracket():
    """Three boxes around a corner, as parts of one body."""
    return (
        Shape(Box((0.3, 0.1, 0.02)), at(0, 0, 0)),
        Shape(Box((0.02, 0.1, 0.2)), at(0.15, 0, 0.1, (0, 0.2, 0))),
        Shape(Box((0.05, 0.3, 0.05)), at(-0.1, 0.1, 0.05)),
    )


def farthest(tree, node, directions):
    """How far the convex set of a node extends along directions, shape (n,)."""
    first, last, _ = tree.convexes[tree.nodes[node, 1]]
    return (directions @ tree.points[first:last].T).max(axis=1)


def test_each_hull_above_the_parts_of_a_body_contains_them():
    tree = stored_tree(bracket())
    assert len(tree.nodes) == 5, "three parts, a hull of two of them, and one of all"
    assert (tree.nodes[:, 1] >= 0).all()
    directions = np.random.default_rng(1).normal(size=(200, 3))
    for node, (end, _) in enumerate(tree.nodes):
        for below in range(node + 1, end):
            hull, part = farthest(tree, node, directions), farthest(tree, below, directions)
            assert (hull >= part - 1e-12).all()


def test_a_body_with_a_round_part_has_balls_above_its_parts():
    tree = stored_tree((*bracket(), Shape(Sphere(0.1), at(0, 0, 0.3))))
    assert tree.nodes[0, 1] == -1
    assert np.count_nonzero(tree.nodes[:, 0] == np.arange(len(tree.nodes)) + 1) == 4


def test_corners_in_a_plane_have_no_hull():
    grid = np.stack(np.meshgrid(np.arange(7.0), np.arange(7.0), [0.0]), axis=-1).reshape(-1, 3)
    for turn in ((0, 0, 0), (0.3, 0.2, 0.1)):
        with pytest.raises(RuntimeError, match="in a plane"):
            hull_of(0.01 * grid @ at(0, 0, 0, turn).rotation.T)


@pytest.mark.parametrize("collision", ["hull", "exact"])
def test_a_stored_tree_is_the_computed_one_and_follows_the_mesh(collision, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    shapes = (Shape(Mesh(write_mesh(tmp_path), collision=collision), at(0.1, 0, 0)),)

    def tree():
        stored_tree.cache_clear()
        return stored_tree(shapes)

    computed = tree()
    [file] = (cache_folder() / "convex_trees").iterdir()
    with monkeypatch.context() as patch:
        patch.setattr(stored_trees, "joined", lambda _: pytest.fail("it is in the cache"))
        stored = tree()
    for each in dataclasses.fields(ConvexTree):
        assert np.array_equal(getattr(stored, each.name), getattr(computed, each.name))
    file.write_bytes(file.read_bytes()[:-1])
    assert np.array_equal(tree().points, computed.points), "a damaged file is computed again"
    moved = (Shape(shapes[0].geometry, at(0.2, 0, 0)),)
    assert np.allclose(stored_tree(moved).points - computed.points, [0.1, 0, 0])
    assert len(list((cache_folder() / "convex_trees").iterdir())) == 2
