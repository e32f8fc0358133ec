"""Trees of meshes, kept in the user's cache directory by the content of the meshes."""

from __future__ import annotations

import dataclasses
import hashlib
import io
from functools import cache, lru_cache
from importlib.metadata import version

import numpy as np

from harness.core.geometry import Mesh, Shape
from harness.core.inputs import read_input
from harness.core.user_cache import cached, store
from harness.planning.collision.convex_tree import ConvexTree, joined
from harness.planning.collision.shape_tree import shape_tree
from harness.robot.mesh_file import decomposition_of, metres_per_unit

METHOD = 3  # Version of the trees; those of another version are computed again
_ARRAYS = tuple(each.name for each in dataclasses.fields(ConvexTree))


@lru_cache(maxsize=1024)
def stored_tree(shapes: tuple[Shape, ...]) -> ConvexTree:
    """One tree of shapes that move together, in the frame of their body.

    The key of the cache holds everything that it depends on, the versions of the libraries
    included, so that it makes no difference whether it was stored.

    Raises:
        RobotError: A mesh file cannot be read.
    """
    if not any(isinstance(shape.geometry, Mesh) for shape in shapes):
        return joined(list(map(shape_tree, shapes)))
    key = hashlib.sha256(repr((METHOD, *_versions())).encode())
    for shape in shapes:
        key.update(_content(shape))
    name = f"convex_trees/{key.hexdigest()}.npz"
    stored = cached(name)
    if stored is not None:
        with np.load(io.BytesIO(stored), allow_pickle=False) as arrays:
            return ConvexTree(*(arrays[each] for each in _ARRAYS))
    tree, content = joined(list(map(shape_tree, shapes))), io.BytesIO()
    np.savez(content, **{each: getattr(tree, each) for each in _ARRAYS})
    store(name, content.getvalue())
    return tree


def _content(shape: Shape) -> bytes:
    """What a shape's tree follows from."""
    geometry, pose = shape.geometry, shape.pose.matrix().tobytes()
    if not isinstance(geometry, Mesh):
        return repr(geometry).encode() + pose
    if geometry.collision != "exact":
        found, part = decomposition_of(geometry), geometry.part
        points = found.hull if part is None else found.parts[part]
        return repr(points.shape).encode() + points.tobytes() + pose
    scale = geometry.scale, metres_per_unit(geometry), geometry.path.suffix
    return repr(scale).encode() + hashlib.sha256(read_input(geometry.path)).digest() + pose


@cache
def _versions() -> tuple[str, ...]:
    return np.__version__, version("coal"), version("trimesh")
