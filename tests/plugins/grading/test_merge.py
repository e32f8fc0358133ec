"""A student's steps with the assignment's world and expectations."""

import pytest

from harness.core.errors import SpecError
from harness.language.reading.load import read_scenario
from harness.plugins.grading.merge import merged_source

GRADED = """\
scenario: Wait
robot: open_manipulator_x
objects: [{name: box, box: {size: [0.1, 0.1, 0.1]}, static: true, pose: {xyz: [1, 0, 0.05]}}]
steps: [{wait: 1}]
expect:
  - duration: {at_most: 3 s}
    points: 2
"""
GIVEN = """\
# mine
robot: ur3e
expect: [{duration: {at_most: 99 s, points: 50}}]
steps:
  - wait: 2 s
  # a comment
  - wait: 1 s
objects: []
"""


@pytest.fixture
def merge(tmp_path):
    def merged(given, takes=("steps",), graded=GRADED):
        (tmp_path / "graded.yaml").write_text(graded)
        (tmp_path / "mine.yaml").write_text(given)
        source = merged_source(tmp_path / "mine.yaml", tmp_path / "graded.yaml", takes, "mine.yaml")
        return read_scenario(tmp_path / "mine.yaml", text=source)

    return merged


def test_steps_are_the_students_and_all_else_is_the_assignments(merge):
    loaded = merge(GIVEN).loaded
    scenario = loaded.scenario
    assert [step.summary() for step in scenario.steps] == ["2 s", "1 s"]
    assert (scenario.robot.model, len(scenario.objects)) == ("open_manipulator_x", 1)
    assert [each.points for each in scenario.expect] == [2]
    assert loaded.text.splitlines()[4:7] == GIVEN.splitlines()[4:7]


def test_objects_are_the_students_where_the_assignment_takes_them(merge):
    assert not merge(GIVEN, ("steps", "objects")).loaded.scenario.objects


def test_what_a_student_leaves_out_is_the_assignments(merge):
    loaded = merge("steps: [{wait: 2}]", ("steps", "objects")).loaded
    assert len(loaded.scenario.objects) == 1


def test_a_mistake_in_the_steps_has_the_students_line(merge):
    [problem] = merge(GIVEN.replace("wait: 1 s", "wait: 1 kg")).problems
    assert str(problem).startswith("mine.yaml:7:")


@pytest.mark.parametrize("filler", ["", "# more\n" * 9])
def test_a_mistake_of_the_assignment_has_the_line_of_its_file(merge, filler):
    [problem] = merge(filler + GIVEN, graded=GRADED.replace("3 s", "3 kg")).problems
    assert str(problem).startswith("graded.yaml:6:")


@pytest.mark.parametrize("filler", ["", "# more\n" * 9])
def test_steps_have_the_students_lines_and_the_assignments_expectations_none(merge, filler):
    loaded = merge(filler + GIVEN).loaded
    first = 5 + filler.count("\n")
    assert [loaded.lines.line_of(("steps", index))[0] for index in (0, 1)] == [first, first + 2]
    assert loaded.lines.line_of(("expect", 0)) == (0, 0)
    assert "duration: {at_most: 3 s}" not in loaded.text


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ("robot: ur3e\n", "has no `steps`"),
        ("", "the file is empty"),
        ("[1, 2]\n", "a file is a mapping"),
        ("{robot: ur3e, steps: [{wait: 1}]}\n", "a line of its own"),
        ("steps: [\n", "mine.yaml:"),
        ("steps: [{wait: 1}]\nsteps: [{wait: 2}]\n", "steps"),
    ],
)
def test_a_file_that_is_no_scenario_is_refused(merge, given, reason):
    with pytest.raises(SpecError, match=reason):
        merge(given)
