"""What is recorded from a sample on is the last part of the whole record."""

from dataclasses import fields

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.simulation.mujoco_simulator import MujocoSimulator
from tests.simulation.physics_scenes import a_box


@pytest.fixture(scope="module")
def simulator(ur3e):
    """A box rides on a belt that starts late; another box comes, is moved and goes."""
    belt = a_box("belt", (2.0, 0.6, 0.1), (0.4, 0, 1.0), surface_motion=SurfaceMotion())
    boxes = [a_box(n, (0.05,) * 3, (0.4, y, 1.075), mass=0.3) for n, y in (("a", 0), ("b", 0.2))]
    found = MujocoSimulator(ur3e, (belt, *boxes), ("belt", "a"))
    found.hold(0.1)
    found.drive_surface("belt", SurfaceMotion((0.2, 0.0, 0.0)), 0.05)
    found.add_object("b", SE3(np.eye(3), np.array([0.4, 0.2, 1.075])))
    found.hold(0.1)
    found.move_object("b", SE3(np.eye(3), np.array([0.4, -0.2, 1.08])))
    found.hold(0.1)
    found.remove_object("b")
    found.hold(0.05)
    return found


def parts(signals):
    """Every array of the signals, by field and key."""
    for field in fields(signals):
        value = getattr(signals, field.name)
        if isinstance(value, np.ndarray):
            yield (field.name,), value
        elif hasattr(value, "items"):
            yield from (((field.name, key), rows) for key, rows in value.items())


@pytest.mark.parametrize("first", [0, 1, 99, 100, 160, 210, 330])
def test_the_rest_equals_the_end_of_the_whole(simulator, first):
    whole, rest = dict(parts(simulator.finish())), dict(parts(simulator.finish(first)))
    assert len(rest[("times",)]) == simulator.sample_count - first
    for key, rows in rest.items():
        expected = whole[key][first:]
        if key[0] == "slides":  # no motion is known before its first sample
            rows, expected = rows[1:], expected[1:]
        assert np.array_equal(rows, expected, equal_nan=True), key
    for key in whole.keys() - rest.keys():  # bodies that touch no more
        assert not np.nan_to_num(whole[key][first + 1 :]).any(), key
