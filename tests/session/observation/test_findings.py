"""What a run reports without a request, from records made by hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harness.cell.program import Program, ProgramExpectation
from harness.cell.scene_state import Belief
from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.judging.expectations.duration import DurationCheck
from harness.plugins.remarks.observers.looks import looks_differ
from harness.plugins.remarks.observers.physics import link_overlap_findings
from harness.plugins.remarks.observers.steps import findings_of
from harness.ports.scene import Touch
from harness.session.observation.beliefs import believed_poses
from harness.session.observation.findings import about_file, overlap_findings
from tests.judging.synthetic_run import BOX, heights, make_run, step


@pytest.mark.parametrize(
    ("distance", "text"), [(-0.0004, "0.4 mm deep"), (0.0, "0.0 mm apart"), (0.002, "2.0 mm apart")]
)
def test_a_lowered_margin_is_reported_with_its_step_and_distance(distance, text):
    entry = {"pair": ["box", "Table"], "start_distance": distance, "margin": 0.01}
    quiet = step("quiet", 0, 10)
    lift = step("lift", 20, 30, explanation={"lowered_margins": [entry, entry]})
    found = findings_of([quiet, lift])
    assert [each.kind for each in found] == ["lowered_margin"] * 2
    assert f"box and Table stood {text}" in found[0].message
    assert (found[0].step, found[0].time) == ("lift", pytest.approx(0.2))
    assert found[0].values["start_distance"] == distance
    assert findings_of([quiet]) == ()


def test_bodies_that_overlap_at_the_start_are_reported_with_their_depth():
    [found] = overlap_findings([Touch("box", "Table", -0.0031)])
    assert (found.kind, found.time) == ("overlap", 0.0)
    assert found.values == {"pair": ["box", "Table"], "depth": 0.0031}
    assert "overlap by 3.1 mm" in found.message


def test_a_belief_lasts_until_the_next_one_and_a_carried_object_moves_with_its_link():
    class Lift:
        """Every link is as high as the joint's number."""

        def link_poses(self, positions, links):
            assert links == ["hand"]
            return heights(positions[:, 0])[:, None]

    beliefs = {
        "ghost": [
            Belief(2, "", SE3.from_xyz_rpy((0, 0, 0.5))),
            Belief(4, "hand", SE3.from_xyz_rpy((0, 0, 0.1))),
            Belief(7, "", None),
        ]
    }
    poses = believed_poses(beliefs, np.arange(9.0)[:, None], Lift())["ghost"][:, 2]
    assert np.isnan(poses[[0, 1, 7, 8]]).all()
    assert poses[2:7] == pytest.approx([0.5, 0.5, 4.1, 5.1, 6.1])


def shown(geometry, place=(0, 0, 0), real=None):
    record = replace(BOX, shapes=(Shape(real or Box((0.1, 0.2, 0.04))),))
    return replace(record, visuals=(Shape(geometry, SE3.from_xyz_rpy(place)),))


@pytest.mark.parametrize(
    ("size", "place", "differs"),
    [
        ((0.1, 0.2, 0.04), (0, 0, 0), False),
        ((0.1, 0.2, 0.0499), (0, 0, 0), False),  # a side is off by 4.95 mm
        ((0.1, 0.2, 0.0501), (0, 0, 0), True),
        ((0.1, 0.239, 0.04), (0, 0, 0), False),  # by 19.5 mm, a tenth of the extent is 20 mm
        ((0.1, 0.241, 0.04), (0, 0, 0), True),
        ((0.1, 0.2, 0.04), (0.0099, 0, 0), False),
        ((0.1, 0.2, 0.04), (-0.0101, 0, 0), True),
    ],
)
def test_pictures_differ_where_a_side_is_off_by_5_mm_and_a_tenth_of_the_extent(
    size, place, differs
):
    assert bool(looks_differ([shown(Box(size), place)])) is differs


def test_the_axis_that_differs_most_is_named_with_both_lengths():
    [found] = looks_differ([shown(Box((0.12, 0.5, 0.04)))])
    assert found.values == {
        "object": "box", "shown": pytest.approx(0.5), "real": pytest.approx(0.2)
    }  # fmt: skip
    for text in ("500.0 mm long along its y axis", "are 200.0 mm", "off by 150.0 mm"):
        assert text in found.message
    [round_one] = looks_differ([shown(Sphere(0.3), real=Cylinder(0.1, 0.6))])
    assert round_one.values["shown"] == pytest.approx(0.6)
    assert round_one.values["real"] == pytest.approx(0.2)


def test_objects_without_pictures_of_their_own_and_planes_do_not_differ():
    assert looks_differ([BOX, shown(Plane()), replace(shown(Box((1, 1, 1))), shapes=())]) == ()


def test_links_inside_each_other_are_reported_where_they_are_deepest():
    depth = np.array([0.0, 0.0021, 0.0123, 0.001])
    signals = replace(make_run(4).signals, link_overlaps={("a", "b"): depth, ("a", "c"): depth / 2})
    found = link_overlap_findings(signals)
    assert [each.values["pair"] for each in found] == [["a", "b"], ["a", "c"]]
    assert [each.values["depth"] for each in found] == [0.0123, 0.00615]
    assert [each.time for each in found] == pytest.approx([0.02, 0.02])
    assert "were 12.3 mm inside each other" in found[0].message


@pytest.mark.parametrize(
    ("geometry", "static", "said"),
    [
        (Box((1.0, 5.0, 2.0)), False, "measures 5 m"),
        (Box((1.0, 4.99, 2.0)), False, ""),
        (Box((1.0, 50.0, 2.0)), True, ""),
        (Sphere(2.5), False, "measures 5 m"),
        (Sphere(2.49), False, ""),
        (Cylinder(3.0, 0.1), False, "measures 6 m"),
        (Capsule(2.49, 0.1), False, ""),
        (Mesh("a.stl", np.ones(3)), False, ""),
    ],
)
def test_an_object_as_large_as_a_house_was_probably_given_in_millimetres(geometry, static, said):
    found = findings_about(thing(Shape(geometry), is_static=static))
    assert bool(found) == bool(said)
    assert all(said in each.message for each in found)


SOMETHING = ProgramExpectation(DurationCheck(at_most=600.0), "", 7)


def thing(*shapes, is_static=False, moment=0.0, mass=1.0, center=(0, 0, 0)):
    inertia = np.diag([moment / 2, moment, moment])
    return WorldObject("thing", shapes, SE3.identity(), is_static, mass, np.array(center), inertia)


def program_with(world=(), later=None, steps=(), expectations=(SOMETHING,)):
    """A program of objects, steps and expectations."""
    program = SimpleNamespace(
        world=SimpleNamespace(objects=world),
        later_objects=later or {},
        expectations=expectations,
        description=make_run(4).robot,
        all_steps=lambda: steps,
    )
    program.all_objects = lambda: Program.all_objects(program)
    return program


def findings_about(obj):
    """Of a program that has an object from the start on, the same as for one that a step adds."""
    both = []
    for world, later in (((obj,), {}), ((), {"thing": obj})):
        both.append(about_file(program_with(world, later), ()))
    assert repr(both[0]) == repr(both[1])  # NaN times are unequal in records from Python 3.13 on
    return both[0]


@pytest.mark.parametrize(
    ("obj", "is_said"),
    [
        (thing(Shape(Sphere(0.1)), moment=0.0199, mass=2.0), False),  # 2 kg at 10 cm: 0.02 kg m^2
        (thing(Shape(Sphere(0.1)), moment=0.0201, mass=2.0), True),
        (thing(Shape(Sphere(0.1)), moment=0.0799, mass=2.0, center=(0, 0.1, 0)), False),
        (thing(Shape(Sphere(0.1)), moment=0.0801, mass=2.0, center=(0, 0.1, 0)), True),
        (thing(Shape(Sphere(0.1)), Shape(Sphere(0.2)), moment=0.0799, mass=2.0), False),
        (thing(Shape(Sphere(0.1)), moment=100.0, is_static=True), False),
        (thing(Shape(Mesh("a.stl", np.ones(3))), moment=100.0), False),
        (thing(moment=100.0), False),
    ],
)
def test_no_mass_within_its_shapes_turns_more_heavily_than_at_their_far_end(obj, is_said):
    found = findings_about(obj)
    assert bool(found) is is_said
    assert all("so slowly that it seems to rest" in each.message for each in found)


@pytest.mark.parametrize(
    ("expectations", "error", "is_note"),
    [
        ((), None, True),
        ((), "PLANNING_FAILED", False),
        ((SOMETHING,), None, False),
        ((SOMETHING,), "X", False),
    ],
)
def test_a_file_that_expects_nothing_differs_from_one_that_expects_a_failure(
    expectations, error, is_note
):
    steps = [SimpleNamespace(spec=SimpleNamespace(expect_error=code)) for code in (None, error)]
    program = program_with(steps=steps, expectations=expectations)
    assert [each.kind for each in about_file(program, ())] == ["nothing_expected"] * is_note


@pytest.mark.parametrize(
    ("obj", "is_said"),
    [
        (thing(Shape(Sphere(0.1)), mass=94.0), False),  # 4.19 l of osmium have 94.6 kg
        (thing(Shape(Sphere(0.1)), mass=95.0), True),
        (thing(Shape(Box((0.1, 0.1, 0.1))), Shape(Sphere(0.1)), mass=117.0), False),
        (thing(Shape(Box((0.1, 0.1, 0.1))), Shape(Sphere(0.1)), mass=118.0), True),
        (thing(Shape(Sphere(0.1)), mass=1000.0, is_static=True), False),
        (thing(Shape(Mesh("a.stl", np.ones(3))), Shape(Sphere(0.01)), mass=1000.0), False),
        (thing(mass=1000.0), False),
    ],
)
def test_no_object_is_denser_than_the_densest_metal(obj, is_said):
    found = findings_about(obj)
    assert bool(found) is is_said
    assert all(f"write `{obj.mass:g} g` for grams" in each.message for each in found)
