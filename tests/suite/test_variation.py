"""The cases that a file's values produce."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.errors import SpecError
from harness.language.reading.load import load_scenario
from harness.suite.header import read_header
from harness.suite.plan import SuiteRequest, planned_cases
from harness.suite.variation import Variation

FILE = """\
scenario: Varied
robot: open_manipulator_x
params: {time: 0.1 s, speed: 1}
steps:
  - wait: "${time}"
"""


def names(**values):
    return [case.name for case in Variation.of(values).cases()]


def test_a_file_without_variation_has_one_nameless_case():
    assert names() == [""]


def test_a_grid_has_every_combination_with_readable_names():
    grid = {"robot.model": ["ur3e", "ur5e"], "height": ["5 cm", 0.1]}
    cases = list(Variation.of({"parametrize": grid}).cases())
    assert [case.name for case in cases] == ["ur3e-5_cm", "ur3e-0.1", "ur5e-5_cm", "ur5e-0.1"]
    assert cases[1].overrides == {"robot.model": '"ur3e"', "height": "0.1"}
    assert cases[1].values == {"robot.model": "ur3e", "height": 0.1}


def test_named_cases_take_their_ids_and_names_never_meet():
    cases = [{"id": "small", "size": 1}, {"size": 2}, {"id": "small", "size": 3}, {"size": [1, 2]}]
    assert names(parametrize=cases) == ["small", "2", "case2", "value0"]
    assert names(parametrize={"a": [[1], [2]], "b": ["x y", "x/y"]}) == [
        "value0-x_y.0", "value0-x_y.1", "value1-x_y.0", "value1-x_y.1"
    ]  # fmt: skip


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"parametrize": {"a": [1, "sample1"], "b": ["x", 0.5]}},
        {"samples": 12},
        {"samples": 3, "parametrize": [{"id": "sample1", "a": 1}, {"id": "1-sample2", "a": 2}]},
    ],
)
def test_the_index_of_a_case_follows_from_its_name(values):
    cases = Variation.of(values).cases()
    found = [case.name for case in cases]
    assert [cases.index_of(name) for name in found] == list(range(len(cases)))
    others = {"sample", "sample-1", "sample01", "sample99", "sample\u0661", "asample1", "1-sample3"}
    assert [cases.index_of(name) for name in others - set(found)] == [None] * len(others - {*found})


def test_a_plan_finds_its_selected_cases_by_name(tmp_path):
    for name in ("first", "second"):
        (tmp_path / f"{name}.scenario.yaml").write_text(FILE + "parametrize: {speed: [1, 2, 3]}\n")
    files = sorted(tmp_path.iterdir())
    plan = planned_cases(files, SuiteRequest(cases=("2", "3")))
    assert [plan.find(str(each.file), each.name) for each in plan] == [0, 1, 2, 3]
    assert plan.find(str(files[1]), "1") is None
    assert plan.find("third.scenario.yaml", "2") is None


def test_a_sample_follows_from_seed_case_and_number_alone():
    values = {"seed": 3, "samples": 5, "randomize": {"a": {"uniform": ["1 cm", "2 cm"]}}}
    drawn = [case.overrides for case in Variation.of(values).cases()]
    assert drawn == [case.overrides for case in Variation.of(values).cases(samples=9)][:5]
    assert drawn != [case.overrides for case in Variation.of(values).cases(seed=4)]
    assert len({json.dumps(each) for each in drawn}) == 5
    number, unit = json.loads(drawn[0]["a"]).split()
    assert unit == "cm"
    assert 1 <= float(number) <= 2


@pytest.mark.parametrize(
    ("planning", "stated"),
    [
        ("", set()),
        ("planning: {seed: 5}\n", {"planning.seed"}),
        ("planning: {pose_resolution: 0.5 mm, padding: 1 mm}\n", {"planning.pose_resolution"}),
        ("planning: {seed: 5, pose_resolution: 0.5 mm}\n",
         {"planning.seed", "planning.pose_resolution"}),
    ],
)  # fmt: skip
def test_samples_plan_as_their_file_states(tmp_path, planning, stated):
    file = tmp_path / "a.scenario.yaml"
    random = 'randomize: {time: {uniform: ["0.1 s", "0.2 s"]}}\n'
    file.write_text(f"{FILE}{planning}{random}", encoding="utf-8")
    case = next(iter(read_header(file).variation.cases()))
    replaced = {"planning.seed", "planning.pose_resolution"} & case.overrides.keys()
    assert replaced == {"planning.seed", "planning.pose_resolution"} - stated


@given(st.integers(0, 2**31), st.floats(-5, 5), st.floats(0.1, 3))
def test_a_cut_normal_stays_within_its_bounds(seed, mean, std):
    normal = {"mean": mean, "std": std, "low": mean - std, "high": mean + 2 * std}
    values = {"seed": seed, "samples": 5, "randomize": {"a": {"normal": normal}}}
    for case in Variation.of(values).cases():
        assert mean - std <= case.values["a"] <= mean + 2 * std


def test_samples_of_each_parametrised_case_share_a_group():
    values = {"parametrize": {"a": [1, 2]}, "samples": 2}
    cases = list(Variation.of(values).cases())
    assert [(case.name, case.group, case.sample) for case in cases] == [
        ("1-sample0", "1", 0), ("1-sample1", "1", 1), ("2-sample0", "2", 0), ("2-sample1", "2", 1)
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("lines", "line", "column", "said"),
    [
        ("parametrize: {params.tme: [1]}", 6, 15, "tme"),
        ("parametrize: {time: 3}", 6, 14, "takes a list of values in turn"),
        ("parametrize: {time: []}", 6, 14, "takes a list of values in turn"),
        ("parametrize: {samples: [1, 2]}", 6, 15, "cannot be varied"),
        ("parametrize: [{id: a, time: 1 s}, {id: a, time: 2 s}]", 6, 14, "two cases are called"),
        ("parametrize: [3]", 6, 14, "a named case is a mapping"),
        (f"parametrize: {{time: [{'1, ' * 101}1], speed: [{'1, ' * 100}1]}}", 6, 14, "more than"),
        ("randomize: {time: {uniform: [2 s, 1 s]}}", 6, 19, "below"),
        ("randomize: {time: {uniform: [1 s, 2 cm]}}", 6, 19, "one unit"),
        ("randomize: {time: {uniform: [.inf, 1]}}", 6, 30, "finite"),
        ("randomize: {time: {uniform: [1, 2], choice: [1]}}", 6, 19, "exactly one of"),
        ("randomize: {time: {normal: {mean: 1, std: 0}}}", 6, 28, "more than 0"),
        ("randomize: {time: {normal: {mean: 1, std: 1, low: 9}}}", 6, 28, "too little"),
        ("randomize: {tim: {choice: [1]}}", 6, 13, "tim"),
        ("samples: 0", 6, 10, "1"),
        ("expect_rate: {at_least: 1.2}\nsamples: 3", 6, 25, "1"),
        ("expect_rate: {at_least: 0.5}", 1, 1, "more than one run"),
    ],
)
def test_a_mistake_is_reported_at_its_place_and_leaves_one_case(
    tmp_path, lines, line, column, said
):
    path = tmp_path / "varied.scenario.yaml"
    path.write_text(FILE + lines + "\n")
    with pytest.raises(SpecError) as caught:
        load_scenario(path)
    [problem] = caught.value.problems
    assert (problem.line, problem.column) == (line, column), problem
    assert said in problem.message
    assert read_header(path).variation.count <= 20
