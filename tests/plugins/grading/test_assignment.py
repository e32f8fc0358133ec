"""`assignment.yaml`: what it may say, and where its mistakes are."""

import pytest

from harness.core.errors import SpecError
from harness.plugins.grading.assignment import read_assignment

EXERCISE = "scenario: Lift\nrobot: ur3e\nsteps: [{move_to: home}]\n"


@pytest.fixture
def folder(tmp_path):
    place = tmp_path / "lift"
    place.mkdir()
    (place / "lift.scenario.yaml").write_text(EXERCISE)
    return place


def read(folder, text):
    (folder / "assignment.yaml").write_text(text)
    return read_assignment(folder)


def mistakes(folder, text):
    with pytest.raises(SpecError) as refused:
        read(folder, text)
    return [(each.line, each.sentence) for each in refused.value.problems]


def test_an_assignment_has_a_title_an_exercise_and_defaults(folder):
    loaded = read(folder, "assignment: Lift it\nscenario: lift.scenario.yaml\n")
    assert (loaded.name, loaded.model.kind, loaded.model.takes) == ("lift", "scenario", ("steps",))
    assert loaded.scenario == folder / "lift.scenario.yaml"
    assert (loaded.model.points, loaded.model.hidden) == (None, ())


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("scenario: lift.scenario.yaml\nnode: python student.py", "node"),
        ("ik: ur5e", "ik"),
        ("ik: {robot: ur5e, function: solve, position_tolerance: 1 mm}", "ik"),
        ("recording: grading/pick_and_place", "recording"),
    ],
)
def test_the_kind_of_exercise_follows_from_its_keys(folder, text, kind):
    assert read(folder, f"assignment: One\n{text}\n").model.kind == kind


def test_hidden_cases_and_limits_carry_units(folder):
    text = """\
assignment: Lift it
scenario: lift.scenario.yaml
points: 10
hidden:
  - {seed: 7}
  - {robot: ur5e, set: {params.x: 0.31}}
limits: {simulated_time: 500 ms, memory: 2000}
"""
    model = read(folder, text).model
    assert [case.seed for case in model.hidden] == [7, None]
    assert model.hidden[1].set == {"params.x": 0.31}
    assert (model.limits.simulated_time, model.limits.memory) == (0.5, 2000)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("assignment: One", 1, "exactly one of `scenario`, `ik` and `recording`"),
        ("assignment: One\nik: ur5e\nscenario: lift.scenario.yaml", 1, "exactly one of"),
        ("assignment: One\nik: ur5e\nnode: python a.py", 3, "a node needs a `scenario`"),
        ("assignment: One\nik: ur5e\nhidden: [{set: {a: 1}}]", 3, "no values to set"),
        ("assignment: One\nik: ur5e\nhidden: [{}]", 3, "is the public case"),
        ("assignment: One\nrecording: grading/pick_and_place\nhidden: [{seed: 1}]", 3, "one case"),
        ("assignment: One\nscenario: ../lift/../other.yaml", 2, "outside the folder"),
        ("assignment: One\nscenario: lfit.scenario.yaml", 2, "no scenario file 'lfit"),
        (f"assignment: One\nscenario: {'a' * 300}", 2, "no scenario file 'aaaa"),
        (f"assignment: One\nrecording: {'a' * 300}/b", 2, "no scenario file 'aaaa"),
        ('assignment: One\nscenario: "a\\0b"', 2, "outside the folder"),
        ("assignment: One\nik: ur5e\nlimits: {memory: 3}", 3, "`memory`"),
        ("assignment: One\nik: ur5e\npoint: 3", 3, "points"),
    ],
)
def test_mistakes_are_reported_at_their_lines(folder, text, line, words):
    [(found, sentence)] = mistakes(folder, text + "\n")
    assert (found, words in sentence) == (line, True), sentence


def test_a_folder_without_an_assignment_is_refused_by_name(tmp_path):
    with pytest.raises(SpecError, match=r"assignment\.yaml.*there is no such file"):
        read_assignment(tmp_path)
