"""search: a gantry whose quill is a peg finds a hole by a spiral, or says why it does not."""

import re

import pytest

import harness
from harness.core.resources import data_folder
from harness.plugins.contact.steps.search import Found
from tests.simulation.test_pushing import GANTRY

PEG = GANTRY.replace('type="capsule" size="0.015 0.15"', 'type="cylinder" size="0.01 0.15"')
SCENARIO = """
scenario: search
robot: {mjcf: gantry.xml, tcp_link: tip}
objects:
  - name: block
    static: true
    friction: 0.1
    box: {size: [80 mm, 80 mm, 50 mm], hole: {diameter: 20.2 mm, depth: 40 mm}}
    pose: {xyz: [0.1, 0, 0.1222]}
steps:
  - move_to: {joints: {x: %s, y: 0, z: 0}}
  - allow_collisions:
      pairs: [[quill, block]]
      during:
        - {%s}
"""
SEARCH = (
    "search: {direction: {xyz: [0, 0, -1]}, radius: 0.5 mm, pitch: 0.15 mm, speed: 5 mm/s},"
    " id: find"
)
PRESSING = "comply: {wrench: {z: -10 N}, during: [{wait: 0.25}, {%s}]}"


def run_of(folder, x, step):
    (folder / "gantry.xml").write_text(PEG, encoding="utf-8")
    file = folder / "search.scenario.yaml"
    file.write_text(SCENARIO % (x, step), encoding="utf-8")
    return harness.run(file)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return run_of(tmp_path_factory.mktemp("found"), 0.1003, PRESSING % SEARCH)


def test_a_pressed_peg_drops_where_the_spiral_passes_the_hole(found):
    assert found, str(found)
    result = found.step("find").result.find(Found)
    assert result.drop >= 0.001
    assert result.offset == pytest.approx(0.0003, abs=0.0002)


@pytest.mark.nightly
def test_a_search_repeats_to_the_same_digest(found, tmp_path):
    again = run_of(tmp_path, 0.1003, PRESSING % SEARCH)
    assert again.case.digest == found.case.digest


def test_a_search_without_pressing_says_so(tmp_path):
    result = run_of(tmp_path, 0.1003, SEARCH.replace("0.5 mm", "0.3 mm"))
    assert "nothing was pressed meanwhile: put the search inside a `comply`" in str(result)


def test_a_peg_that_presses_nothing_finds_no_hole(tmp_path):
    outside = run_of(tmp_path, 0.16, PRESSING % SEARCH)
    assert not outside
    assert "nothing was pressed meanwhile" in outside.step("find").message


@pytest.mark.parametrize("offset", [0.0, pytest.param(5e-5, marks=pytest.mark.nightly)])
def test_a_peg_that_begins_in_the_hole_finds_it_by_the_walls_around_it(offset, tmp_path):
    inside = run_of(tmp_path, 0.1 + offset, PRESSING % SEARCH)
    assert inside, str(inside)
    assert inside.step("find").result.find(Found).drop >= 0.001


@pytest.mark.parametrize("side", [1, pytest.param(-1, marks=pytest.mark.nightly)])
def test_a_peg_that_rubs_along_a_side_wall_finds_no_hole(side, tmp_path):
    aside = f"move_relative: {{direction: {{xyz: [{-side}, 0, 0]}}, distance: 10.3 mm}}"
    step = PRESSING.replace("wait: 0.25", aside) % SEARCH
    rubbing = run_of(tmp_path, 0.1 + 0.06 * side, step)
    find, forces = rubbing.step("find"), rubbing.run.signals.contact_forces["quill", "block"]
    assert forces[find.start_index] > 1.0
    assert "nothing was pressed meanwhile" in find.message


def test_a_drop_is_measured_from_the_face_that_is_pressed(found, tmp_path):
    early = run_of(tmp_path, 0.1003, PRESSING.replace("0.25", "0.12") % SEARCH)
    step = early.step("find")
    samples = early.run.signals.tcp_pose[step.start_index : step.end_index, 2]
    drop = step.result.find(Found).drop
    assert drop == pytest.approx(found.step("find").result.find(Found).drop, abs=2e-4)
    assert samples[0] - samples[-1] > drop + 1e-4


@pytest.mark.nightly
def test_a_hole_that_is_too_far_away_says_so(tmp_path):
    result = run_of(tmp_path, 0.102, PRESSING % SEARCH.replace("0.5 mm", "0.3 mm"))
    assert "the hole is farther away than the `radius`" in str(result)
    pressed = re.search(r"it was pressed with ([0-9.]+) N", str(result))
    assert float(pressed[1]) == pytest.approx(10, rel=0.03)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("radius: 0.1 mm", "more than the `radius`"),
        ("radius: 30 mm", "are searched"),
        ("radius: 1 mm, link: tpi", "`tip`"),
        ("radius: -1 mm", "radius"),
    ],
)
def test_bad_input_is_a_located_error(tmp_path, words, said):
    result = run_of(tmp_path, 0.1, SEARCH.replace("radius: 0.5 mm", words))
    assert result.case.outcome == "invalid"
    assert said in str(result)
    assert "search.scenario.yaml:15:" in str(result)


LESSON = data_folder("scenarios") / "contact/03_peg_in_hole.scenario.yaml"


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        ({"params.offset": "0 mm"}, ""),
        ({"params.offset": "3 mm"}, "the hole is farther away than the `radius`"),
    ],
)
def test_the_lesson_finds_its_hole_within_the_radius_alone(overrides, said):
    result = harness.run(LESSON, overrides=overrides)
    assert bool(result) == (not said), str(result)
    assert said in str(result)


@pytest.mark.nightly
def test_the_lesson_finds_no_hole_that_is_a_tenth_of_a_millimetre_too_narrow():
    result = harness.run(LESSON, overrides={"objects.block.box.hole.diameter": "19.9 mm"})
    assert "the hole is farther away than the `radius`" in str(result)


@pytest.mark.nightly
def test_the_lesson_fails_without_compliance_and_says_what_is_missing(tmp_path):
    text = LESSON.read_text(encoding="utf-8").replace("wrench: {z: -10 N}", "wrench: {rz: 0}")
    (tmp_path / "rigid.scenario.yaml").write_text(text, encoding="utf-8")
    result = harness.run(tmp_path / "rigid.scenario.yaml")
    assert "nothing was pressed meanwhile" in str(result)
