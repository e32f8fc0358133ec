"""The bundled worlds against the lesson's SDF files."""

from pathlib import Path

import pytest

from harness.language.reading.load import bundled_worlds, load_world

TABLE_TOP = 1.015


def world(name):
    return load_world(name, Path()).model


def objects(name):
    return {item.name: item for item in world(name).objects}


def bottom(item):
    """Height of an upright object's lowest point [m]."""
    shapes = item.shapes or (item,)
    lengths = [(s.box.size[2] if s.box else s.cylinder.length) for s in shapes]
    offsets = [s.pose.xyz[2] if item.shapes else 0.0 for s in shapes]
    return item.pose.xyz[2] + min(z - h / 2 for z, h in zip(offsets, lengths, strict=True))


def test_the_bundled_worlds_are_those_of_the_lesson():
    assert set(bundled_worlds()) == {"empty", "lesson_om", "lesson_ur"}


@pytest.mark.parametrize("name", ["lesson_om", "lesson_ur"])
def test_everything_that_can_fall_stands_on_a_table(name):
    found = objects(name)
    for table in ("Table", "Table_0"):
        slab = found[table].shapes[0]
        assert slab.pose.xyz[2] + slab.box.size[2] / 2 == pytest.approx(TABLE_TOP)
        assert found[table].static
        assert len(found[table].shapes) == 5
    for thing in ("red_box", "green_cylinder", "coke_can_steel", "beer_0"):
        assert bottom(found[thing]) == pytest.approx(TABLE_TOP, abs=1e-9), thing
        assert not found[thing].static


def test_the_two_lesson_worlds_differ_in_the_box_and_the_friction():
    om, ur = objects("lesson_om"), objects("lesson_ur")
    assert list(om) == list(ur)
    assert {name for name in om if om[name] != ur[name]} == {"red_box", "green_cylinder"}
    assert (om["red_box"].mass, ur["red_box"].mass) == (0.1, 0.3)
    assert (om["red_box"].friction, ur["red_box"].friction) == (1.0, 30.0)
    assert ur["green_cylinder"].cylinder.radius == 0.03
    assert ur["green_cylinder"].pose.xyz == (0.32, -0.168, 1.065)


@pytest.mark.parametrize("name", ["empty", "lesson_om", "lesson_ur"])
def test_every_world_has_a_floor_a_light_and_the_lessons_gravity(name):
    found = world(name)
    assert found.objects[0].plane is not None
    assert len(found.lights) == 1
    assert found.physics.gravity == (0.0, 0.0, -9.8)
    assert found.physics.timestep == 0.001
