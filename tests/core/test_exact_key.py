"""Keys of computations: any other byte of any input gives another key."""

from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from harness.core.exact_key import NoKeyError, exact_key
from harness.core.geometry import Box, Mesh, Shape
from harness.core.spatial import SE3


@dataclass(frozen=True)
class Inputs:
    name: str = "arm"
    start: tuple[float, ...] = (0.1, 0.2)
    pairs: frozenset[tuple[str, str]] = frozenset({("a", "b"), ("c", "d")})


@dataclass(frozen=True)
class Others(Inputs):
    pass


VALUES = [
    None, True, 1, 1.0, np.nextafter(1.0, 2.0), 0.0, -0.0, "1", b"1", "ab", ("a", "b"), ("ab", ""),
    (), ((),), {"a": 1}, {"a": 2}, {"a": 1, "b": 2}, {"b": 2, "a": 1}, Path("1"),
    np.array([1.0]), np.array([[1.0]]), np.array([1.0], dtype=np.float32), np.array([1]),
    np.array([0.0]), np.array([-0.0]), Inputs(), Others(), Inputs(name="arm2"),
    Inputs(start=(0.1, 0.2, 0.0)), Inputs(pairs=frozenset({("a", "b")})),
    SE3.from_xyz_rpy((0, 0, 1)), SE3.from_xyz_rpy((0, 0, np.nextafter(1.0, 2.0))),
    Shape(Box((1, 1, 1))), Shape(Box((1, 1, 1)), rgba=(0, 0, 0, 1)),
]  # fmt: skip


def test_values_that_differ_have_keys_that_differ():
    keys = [exact_key(value) for value in VALUES]
    same = [
        (first, second)
        for later, second in enumerate(VALUES)
        for first, key in zip(VALUES[:later], keys[:later], strict=True)
        if key == keys[later]
    ]
    assert same == []


def test_equal_values_have_equal_keys_whatever_objects_hold_them():
    ones = np.ones(6)
    assert exact_key(ones[::2]) == exact_key(np.ones(3))
    assert exact_key(Inputs()) == exact_key(Inputs(start=(0.1, 0.2)))
    assert exact_key(frozenset("ab")) == exact_key(frozenset("ba"))


def test_the_content_of_a_mesh_counts(tmp_path):
    keys = set()
    for name, content in (("a.stl", "one"), ("b.stl", "two"), ("c.stl", "two")):
        (tmp_path / name).write_text(content)
        keys.add(exact_key(Mesh(tmp_path / name)))
    assert len(keys) == 3
    folders = [tmp_path / "first", tmp_path / "second"]
    for folder in folders:
        folder.mkdir()
    (folders[0] / "a.stl").write_text("solid")
    before = exact_key(Mesh(folders[0] / "a.stl"))
    assert before != exact_key(Mesh(folders[1] / "a.stl"))


@pytest.mark.parametrize("value", [object(), len, MappingProxyType({}), np.array([object()])])
def test_what_has_no_exact_bytes_has_no_key(value):
    with pytest.raises(NoKeyError):
        exact_key(value)
