"""The cases that a file's values produce."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.errors import SpecError
from harness.language.reading.load import load_scenario
from harness.plugins.campaigns.shards import stated_variation
from harness.suite.discovery import UsageError
from harness.suite.header import read_header
from harness.suite.plan import planned_cases
from harness.suite.request import SuiteRequest

FILE = """\
scenario: Varied
robot: open_manipulator_x
params: {time: 0.1 s, speed: 1}
steps:
  - wait: "${time}"
"""


def names(**values):
    return [case.name for case in stated_variation(values).cases()]


def test_a_file_without_variation_has_one_nameless_case():
    assert names() == [""]


def test_a_grid_has_every_combination_with_readable_names():
    grid = {"robot.model": ["ur3e", "ur5e"], "height": ["5 cm", 0.1]}
    cases = list(stated_variation({"parametrize": grid}).cases())
    assert [case.name for case in cases] == ["ur3e-5_cm", "ur3e-0.1", "ur5e-5_cm", "ur5e-0.1"]
    assert cases[1].overrides == {"robot.model": '"ur3e"', "height": "0.1"}
    assert cases[1].values == {"robot.model": "ur3e", "height": 0.1}


def test_named_cases_take_their_ids_and_names_never_meet():
    cases = [{"id": "small", "size": 1}, {"size": 2}, {"id": "small!", "size": 3}, {"size": [1, 2]}]
    assert names(parametrize=cases) == ["small", "2", "case2", "value0"]
    assert names(parametrize={"a": [[1], [2]], "b": ["x y", "x/y"]}) == [
        "value0-x_y.0", "value0-x_y.1", "value1-x_y.0", "value1-x_y.1"
    ]  # fmt: skip


def test_a_plan_finds_its_selected_cases_by_name(tmp_path):
    for name in ("first", "second"):
        (tmp_path / f"{name}.scenario.yaml").write_text(FILE + "parametrize: {speed: [1, 2, 3]}\n")
    files = sorted(tmp_path.iterdir())
    plan = planned_cases(files, SuiteRequest(cases=("2", "3")))
    assert [plan.index_of[str(each.file), each.name] for each in plan] == [0, 1, 2, 3]
    assert (str(files[1]), "1") not in plan.index_of
    assert ("third.scenario.yaml", "2") not in plan.index_of


def test_a_sample_follows_from_seed_case_and_number_alone():
    values = {"seed": 3, "samples": 5, "randomize": {"a": {"uniform": ["1 cm", "2 cm"]}}}
    drawn = [case.overrides for case in stated_variation(values).cases()]
    assert drawn == [case.overrides for case in stated_variation(values).cases(samples=9)][:5]
    assert drawn != [case.overrides for case in stated_variation(values).cases(seed=4)]
    assert len({json.dumps(each) for each in drawn}) == 5
    number, unit = json.loads(drawn[0]["a"]).split()
    assert unit == "cm"
    assert 1 <= float(number) <= 2


def test_samples_plan_with_the_seed_that_their_file_states_for_planning(tmp_path):
    file = tmp_path / "a.scenario.yaml"
    random = 'randomize: {time: {uniform: ["0.1 s", "0.2 s"]}}\n'
    file.write_text(f"{FILE}planning: {{seed: 5}}\n{random}", encoding="utf-8")
    cases = read_header(file).variation.cases()
    assert not any("planning.seed" in case.overrides for case in cases)
    assert len({case.overrides["seed"] for case in cases}) == len(cases)


@given(st.integers(0, 2**31 - 1), st.floats(-5, 5), st.floats(0.1, 3))
def test_a_cut_normal_stays_within_its_bounds(seed, mean, std):
    normal = {"mean": mean, "std": std, "low": mean - std, "high": mean + 2 * std}
    values = {"seed": seed, "samples": 5, "randomize": {"a": {"normal": normal}}}
    for case in stated_variation(values).cases():
        assert mean - std <= case.values["a"] <= mean + 2 * std


def test_samples_of_each_parametrised_case_share_a_group():
    values = {"parametrize": {"a": [1, 2]}, "samples": 2}
    cases = list(stated_variation(values).cases())
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
        ("expect_rate: {at_least: 1.0}\nsamples: 3", 6, 25, "must be less than 1"),
        ("expect_rate: 100 %\nsamples: 3", 6, 14, "must be less than 1"),
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


HEADER = """\
scenario: Pick at ${time}
tags: ["${tag}", slow]
robot: open_manipulator_x
params: {time: 0.1 s, tag: lesson, n: 3, rate: 80 %, low: 0.1 s, many: [1, 2], draws: [1, 2]}
steps:
  - wait: "${time}"
"""


@pytest.mark.parametrize(
    ("lines", "options"),
    [
        ("randomize: {time: {uniform: ['${low}', 0.3 s]}}\nsamples: ${n}", {}),
        ("randomize: {time: {uniform: [0.1 s, 0.3 s]}}\nsamples: 9", {"samples": "3"}),
        ("randomize: {time: {uniform: [0.1 s, 0.3 s]}}\nsamples: ${n}", {"n": "3", "low": "1 s"}),
        ("samples: ${n}", {"randomize": "{time: {uniform: [0.1 s, 0.3 s]}}"}),
        ("randomize: {time: {uniform: [0.1 s, 9 s]}}\nsamples: 3",
         {"randomize.time.uniform.1": "0.3 s"}),
        ("randomize: {params.time: {uniform: [0.1 s, 9 s]}}\nsamples: 3",
         {"randomize.params.time.uniform.1": "0.3 s"}),
    ],
)  # fmt: skip
def test_cases_follow_from_parameters_and_options(tmp_path, lines, options):
    plain = tmp_path / "plain.scenario.yaml"
    path = "params.time" if "params.time" in lines else "time"
    plain.write_text(f"{HEADER}randomize: {{{path}: {{uniform: [0.1 s, 0.3 s]}}}}\nsamples: 3\n")
    file = tmp_path / "a.scenario.yaml"
    file.write_text(f"{HEADER}{lines}\n")
    expected = [case.values for case in read_header(plain).variation.cases()]
    assert len(expected) == 3
    assert [case.values for case in read_header(file, options).variation.cases()] == expected


@pytest.mark.parametrize(
    ("lines", "options", "expected"),
    [
        ("samples: 5\nexpect_rate: ${rate}", {}, (0.8, 0.95, True)),
        ("samples: 5\nexpect_rate: {at_least: '${rate}', confidence: 99 %, stop_early: false}", {},
         (0.8, 0.99, False)),
        ("samples: 5", {"expect_rate.at_least": "0.7"}, (0.7, 0.95, True)),
        ("samples: 5\nexpect_rate: 90 %", {"expect_rate.confidence": "0.9", "rate": "1"},
         (0.9, 0.9, True)),
    ],
)  # fmt: skip
def test_the_required_rate_follows_from_parameters_and_options(tmp_path, lines, options, expected):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(f"{HEADER}{lines}\n")
    found = read_header(file, options).variation
    assert (found.at_least, found.confidence, found.stop_early) == expected


def test_seed_redraws_grid_title_and_tags_follow_from_parameters_and_options(tmp_path):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(
        f"{HEADER}seed: ${{n}}\nredraw_overlaps: true\nparametrize: {{params.tag: '${{many}}'}}\n"
        "randomize: {params.time: {choice: '${draws}'}}\n"
    )
    header = read_header(file, {"title": "x", "params.n": "7", "tags.1": "fast"})
    assert (header.title, header.tags) == ("Pick at 0.1 s", ("lesson", "fast"))
    assert (header.variation.seed, header.variation.redraw_overlaps) == (7, True)
    assert [case.name for case in header.variation.parametrized()] == ["1", "2"]
    assert {case.values["params.time"] for case in header.variation.cases()} == {1, 2}


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("parametrize: {params.n: [3, 4]}\nsamples: ${n}", "the cases follow from `${n}`"),
        ("parametrize: [{n: 3}, {n: 4}]\nsamples: ${n}", "the cases follow from `${n}`"),
        ("parametrize: {params: [{n: 1}]}\nsamples: ${n}", "the cases follow from `${n}`"),
        ("randomize: {low: {choice: [0.1 s, 0.2 s]}, time: {uniform: ['${low}', 0.3 s]}}",
         "the cases follow from `${low}`"),
        ("parametrize: {params.rate: [1]}\nsamples: 3\nexpect_rate: ${rate}", "`${rate}`"),
        ("parametrize: {seed: [1, 2]}\nsamples: 3", "a seed of its own"),
        ("randomize: {seed: {choice: [1, 2]}}", "a seed of its own"),
    ],
)  # fmt: skip
def test_what_the_cases_follow_from_does_not_vary_with_them(tmp_path, lines, said):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(f"{HEADER}{lines}\n")
    with pytest.raises(SpecError, match="cannot be varied") as caught:
        load_scenario(file)
    assert said in caught.value.problems[0].message
    assert caught.value.problems[0].line == 7


@pytest.mark.parametrize(
    ("drawn", "is_free"),
    [("params.n", False), ("n", False), ("params.low", True)],
)
@pytest.mark.parametrize("cases", ["{params.n: [3, 4]}", "{n: [3, 4]}", "[{id: a, n: 3}]"])
def test_what_the_cases_set_is_not_drawn_as_well(tmp_path, cases, drawn, is_free):
    file = tmp_path / "a.scenario.yaml"
    draws = f"randomize: {{{drawn}: {{choice: [5, 6]}}}}\n"
    file.write_text(f"{HEADER}samples: 2\nparametrize: {cases}\n{draws}")
    if is_free:
        assert load_scenario(file)
        return
    with pytest.raises(SpecError, match="is set by the cases of `parametrize`") as caught:
        load_scenario(file)
    assert caught.value.problems[0].line == 9


@pytest.mark.parametrize(
    "lines", ["expect_rate: 1\nrandomize: {}", "redraw_overlaps: true\nrandomize: {}"]
)
def test_an_empty_randomize_draws_nothing(tmp_path, lines):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(f"{HEADER}{lines}\n")
    with pytest.raises(SpecError, match="randomize"):
        load_scenario(file)


@pytest.mark.nightly(but=["lines1"])
@pytest.mark.parametrize(
    "lines",
    [
        f"parametrize: [{', '.join(['{low: 1 s}'] * 10_001)}]",
        f"parametrize: {{n: [{'1, ' * 2000}], low: [1, 2, 3]}}\nrandomize: {{n: {{choice: [1]}}}}",
    ],
)
def test_more_cases_than_a_file_may_have_are_refused(tmp_path, lines):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(f"{HEADER}{lines}\n")
    with pytest.raises(SpecError, match=r"more than 10000 cases|at most 100000"):
        load_scenario(file)
    assert read_header(file).variation.count == 1


@pytest.mark.parametrize("samples", [100_001, 10**15, 10**30])
def test_more_samples_than_a_file_may_have_are_refused_as_an_option(tmp_path, samples):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(f"{HEADER}randomize: {{low: {{uniform: [1, 2]}}}}\n")
    with pytest.raises(UsageError, match=f"has {samples} cases; at most 100000 are run of a file"):
        planned_cases([file], SuiteRequest(samples=samples))


@pytest.mark.parametrize(
    ("path", "option", "value"),
    [
        ("params.time", {"time": "0.2 s"}, "0.2 s"),
        ("time", {"params": "{time: 0.4 s, n: 1}"}, "0.4 s"),
        ("robot.start_state.joints.joint1", {"robot": "open_manipulator_x"}, None),
        ("objects.cube.pose.xyz.0", {"objects.0.pose": "{xyz: [0.3, 0, 0]}"}, 0.3),
    ],
)
def test_a_value_that_an_option_gives_is_shown(tmp_path, path, option, value):
    cube = "objects: [{name: cube, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [0.1, 0.2, 0.1]}}]\n"
    for varied in (f"randomize: {{{path}: {{choice: [1, 2]}}, n: {{choice: [1]}}}}",
                   f"parametrize: {{{path}: [1, 2], n: [1]}}"):  # fmt: skip
        file = tmp_path / "a.scenario.yaml"
        file.write_text(f"{HEADER}{cube}{varied}\n")
        cases = read_header(file, option).variation.cases()
        assert {json.dumps(case.values) for case in cases} == {json.dumps({path: value, "n": 1})}
        plan = planned_cases([file], SuiteRequest(overrides=option))
        assert plan[0].values == {path: value, "n": 1}


def test_a_seed_in_an_option_is_the_seed_of_all_samples(tmp_path):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(f"{HEADER}samples: 3\n")
    jobs = [each.job for each in planned_cases([file], SuiteRequest(overrides={"seed": "5"}))]
    expected = [each.job for each in planned_cases([file], SuiteRequest(seed=5))]
    assert [job.overrides for job in jobs] == [job.overrides for job in expected]
    assert len({job.overrides["seed"] for job in jobs}) == 3
