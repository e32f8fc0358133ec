"""A student's steps with the assignment's world and expectations."""

import pytest

from harness.core.errors import SpecError
from harness.language.reading.load import parse_scenario
from harness.plugins.grading.merge import merged_text

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
        return merged_text(tmp_path / "mine.yaml", tmp_path / "graded.yaml", takes)

    return merged


def test_steps_are_the_students_and_all_else_is_the_assignments(merge, tmp_path):
    text = merge(GIVEN)
    scenario = parse_scenario(text, tmp_path / "mine.yaml").scenario
    assert [step.summary() for step in scenario.steps] == ["2 s", "1 s"]
    assert (scenario.robot.model, len(scenario.objects)) == ("open_manipulator_x", 1)
    assert [each.points for each in scenario.expect] == [2]
    assert text.splitlines()[4:7] == GIVEN.splitlines()[4:7]


def test_objects_are_the_students_where_the_assignment_takes_them(merge, tmp_path):
    text = merge(GIVEN, ("steps", "objects"))
    assert not parse_scenario(text, tmp_path / "mine.yaml").scenario.objects


def test_what_a_student_leaves_out_is_the_assignments(merge, tmp_path):
    text = merge("steps: [{wait: 2}]", ("steps", "objects"))
    assert len(parse_scenario(text, tmp_path / "mine.yaml").scenario.objects) == 1


def test_a_mistake_in_the_steps_has_the_students_line(merge, tmp_path):
    text = merge(GIVEN.replace("wait: 1 s", "wait: 1 kg"))
    with pytest.raises(SpecError, match=r"mine\.yaml:7:"):
        parse_scenario(text, tmp_path / "mine.yaml")


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
