"""Varied suites through the command line: rates, early ends, tables, going on, one sample alone."""

import json

import pytest

from tests.commands import harness

VARIED = """\
scenario: Wait for a random time
robot: open_manipulator_x
seed: 5
params: {time: 0.1 s}
steps:
  - wait: "${time}"
expect:
  - duration: {at_most: 0.15 s}
randomize:
  time: {uniform: [0.01 s, 0.2 s]}
samples: 12
"""
GRID = """\
scenario: Wait
robot: open_manipulator_x
params: {time: 0.1 s, unused: 1}
steps:
  - wait: "${time}"
expect:
  - duration: {at_most: 0.15 s}
parametrize:
  time: [0.05 s, 0.1 s, 0.2 s]
  unused: [1, 2]
"""


def results(*words, cwd):
    return json.loads(harness("run", *words, "--json", cwd=cwd).stdout)


@pytest.fixture
def varied(tmp_path):
    def write(text=VARIED):
        path = tmp_path / "varied.scenario.yaml"
        path.write_text(text)
        return path

    return write


@pytest.fixture(scope="module")
def sampled(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sampled")
    path = folder / "varied.scenario.yaml"
    path.write_text(VARIED)
    said = harness("run", path, "-j", 2, "--no-page", cwd=folder).stdout
    return folder, path, said, json.loads((folder / "reports/results.json").read_text())


def test_a_rate_counts_each_sample_once_whatever_its_order(sampled):
    _, _, _, found = sampled
    [group] = found["rates"]
    passed = sum(case["outcome"] == "passed" for case in found["cases"])
    assert (group["rate"]["passed"], group["rate"]["total"]) == (passed, 12)
    assert 0 < passed < 12
    assert found["exit_code"] == 1
    assert len({case["seed"] for case in found["cases"]}) == 12


@pytest.mark.nightly
def test_samples_have_the_same_digests_in_one_process(sampled):
    folder, path, _, found = sampled
    alone = results(path, "--no-report", "--in-process", cwd=folder)
    assert [case["digest"] for case in alone["cases"]] == [
        case["digest"] for case in found["cases"]
    ]


def test_a_failing_sample_runs_alone_to_the_same_digest_with_the_printed_command(sampled):
    folder, _, said, found = sampled
    worst = next(case for case in found["cases"] if case["outcome"] == "failed")
    [command] = [
        line.split("again:")[1].split()
        for line in said.splitlines()
        if "again:" in line and line.endswith(f"--case {worst['case']}")
    ]
    [again] = results(*command[2:], "--no-report", cwd=folder)["cases"]
    assert (again["digest"], again["seed"]) == (worst["digest"], worst["seed"])


@pytest.mark.nightly
def test_only_failed_samples_leave_reports_unless_all_are_kept(sampled):
    folder, path, _, found = sampled
    root = folder / "reports/varied"
    failed = {case["case"] for case in found["cases"] if case["outcome"] == "failed"}
    assert {report.name for report in root.iterdir()} == failed
    words = ("--keep", "all", "--case", "sample[01]", "--no-page", "--report-dir", "all")
    results(path, *words, cwd=folder)
    assert {report.name for report in (folder / "all/varied").iterdir()} == {"sample0", "sample1"}


@pytest.mark.nightly
def test_the_sequential_test_ends_the_sampling_at_the_same_sample_however_many_work(varied):
    text = VARIED.replace("samples: 12", "samples: 60\nexpect_rate: {at_least: 0.2}")
    path = varied(text)
    totals = []
    for workers in (1, 2):
        found = results(path, "--no-report", "-j", workers, cwd=path.parent)
        [group] = found["rates"]
        assert group["rate"]["stopped_early"]
        assert group["rate"]["verdict"] == "shown"
        assert found["exit_code"] == 0
        totals.append([case["case"] for case in found["cases"]])
    assert totals[0] == totals[1]
    assert len(totals[0]) < 60


@pytest.mark.nightly
def test_a_rate_that_cannot_be_shown_fails_and_says_what_to_do(varied):
    path = varied(VARIED.replace("samples: 12", "samples: 4\nexpect_rate: {at_least: 0.6}"))
    done = harness("run", path, "--no-report", cwd=path.parent)
    assert done.returncode == 1
    assert "at least 60.0% is undecided: if as many pass, " in done.stdout


@pytest.mark.nightly
def test_samples_that_vary_nothing_are_reported_and_their_rate_is_refused(varied):
    same = "samples: 3\nexpect_rate: {at_least: 0.1, stop_early: false}"
    path = varied(VARIED.replace('wait: "${time}"', "wait: 0.1 s").replace("samples: 12", same))
    done = harness("run", path, "--no-report", cwd=path.parent)
    assert done.returncode == 1, done.stdout
    assert "the 3 samples are one and the same run (equal digests)" in done.stdout
    assert "success rate not confirmed" in done.stdout


@pytest.mark.nightly
def test_a_grid_that_varies_nothing_is_reported(tmp_path):
    """A parameter that only a step's name reads, and one that a wait reads."""
    text = "scenario: s\nrobot: open_manipulator_x\nparams: {x: 10 ms}\nsteps:\n  - {%s}\n"
    text += "parametrize: {params.x: [10 ms, 20 ms]}\n"
    (tmp_path / "same.scenario.yaml").write_text(text % 'wait: 10 ms, name: "waits ${x}"')
    (tmp_path / "varied.scenario.yaml").write_text(text % 'wait: "${x}"')
    said = harness("run", ".", "--no-report", cwd=tmp_path).stdout
    assert "same.scenario.yaml: its 2 runs have equal digests" in said
    assert "varied.scenario.yaml: its" not in said


@pytest.mark.nightly
@pytest.mark.parametrize("line", ["parametrize: {seed: []}", "parametrize: {time: [], seed: [1]}"])
def test_a_grid_without_values_is_an_error_of_its_file_in_a_suite(line, varied):
    path = varied()
    (path.parent / "none.scenario.yaml").write_text(VARIED.split("randomize")[0] + line + "\n")
    done = harness("run", path.parent, "--no-report", "--samples", 1, cwd=path.parent)
    assert done.returncode == 2
    assert "takes a list of values in turn" in done.stdout
    assert "2 files found, 2 collected, 2 run" in done.stdout


@pytest.mark.nightly
def test_a_suite_reports_the_files_that_a_selection_left_out(varied):
    path = varied()
    (path.parent / "grid.scenario.yaml").write_text(GRID)
    done = harness("run", path.parent, "--no-report", "--case", "0.05*", cwd=path.parent)
    assert "2 files found, 1 collected, 1 run" in done.stdout


@pytest.mark.nightly
def test_samples_of_what_has_none_are_refused_and_leave_files_next_to_sampled_ones_alone(varied):
    path = varied()
    plain = path.with_name("plain.scenario.yaml")
    plain.write_text(VARIED.partition("randomize:")[0])
    refused = harness("run", plain, "--samples", 3, cwd=path.parent)
    assert refused.returncode == 2
    assert "--samples 3: nothing is random here" in refused.stderr
    assert not (path.parent / "reports").exists()
    broken = path.with_name("broken.scenario.yaml")
    broken.write_text(VARIED.replace("uniform: [", "uniform: [x"))
    assert (
        "broken.scenario.yaml:10:20"
        in harness("run", broken, "--samples", 3, cwd=path.parent).stderr
    )
    both = results(path, plain, "--samples", 2, "--no-report", cwd=path.parent)
    assert [case["case"] for case in both["cases"]] == ["sample0", "sample1", ""]


@pytest.mark.nightly
def test_a_table_reports_which_quantity_decides(varied):
    path = varied(GRID)
    done = harness("run", path, "--no-report", cwd=path.parent)
    assert done.returncode == 1
    table = [" ".join(line.split()) for line in done.stdout.splitlines()]
    assert "✗ 0.2 s 0 of 2 0.0%" in table
    assert "✓ 0.05 s 2 of 2 100.0%" in table
    assert "again: harness run varied.scenario.yaml --case 0.2_s-1" in done.stdout.replace(
        str(path), path.name
    ).replace("  harness", " harness")


@pytest.mark.nightly
def test_what_is_known_is_not_computed_again_and_what_changed_is(varied):
    path = varied(GRID)
    first = results(path, "--no-page", cwd=path.parent)
    stream = path.parent / "reports/results.jsonl"
    lines = stream.read_text().splitlines()
    assert len(lines) == 7  # the files that all six results follow from come first
    written = json.loads((path.parent / "reports/results.json").read_text())
    assert written == first
    assert (path.parent / "reports/junit.xml").read_text().count("<failure ") == 2
    assert (path.parent / "reports/index.html").stat().st_size > 10_000
    # as an interruption leaves it: two whole results and a piece of one
    stream.write_text("\n".join([*lines[:3], lines[3][:40]]) + "\n")
    done = harness("run", path, "--no-page", "--resume", cwd=path.parent)
    assert "2 of them were known from before" in done.stdout
    again = results(path, "--no-page", "--resume", cwd=path.parent)
    assert again["cases"] == [
        {**case, "wall_times": other["wall_times"]}
        for case, other in zip(first["cases"], again["cases"], strict=True)
    ]
    path.write_text(GRID.replace("0.15 s}", "0.16 s}"))
    done = harness("run", path, "--no-page", "--resume", cwd=path.parent)
    assert "known from before" not in done.stdout


@pytest.mark.nightly
def test_a_case_that_is_not_there_is_named_with_those_that_are(varied):
    path = varied(GRID)
    done = harness("run", path, "--case", "0.3_s", cwd=path.parent)
    assert done.returncode == 2
    assert "0.05_s-1, 0.05_s-2" in done.stderr


@pytest.mark.nightly
def test_a_mistake_in_one_value_is_reported_of_its_cases_alone(varied):
    path = varied(GRID.replace("0.2 s]", "0.2 m]"))
    done = harness("check", path, cwd=path.parent)
    assert done.returncode == 2
    assert f"{path}:5:11: `0.2 m` is a length; a time is expected" in done.stdout
    assert "[0.05_s-1]: ok" in done.stdout
    ran = harness("run", path, "--no-report", cwd=path.parent)
    assert ran.returncode == 2
    assert "2 invalid, 4 passed of 6 cases" in ran.stdout


SOMETIMES_INVALID = """\
scenario: Sometimes too light to be
robot: open_manipulator_x
seed: 5
objects:
  - {name: ball, sphere: {radius: 1 cm}, mass: 1, pose: {xyz: [0.3, 0.3, 0.01]}}
steps:
  - wait: 0.05 s
expect:
  - duration: {at_most: 1 s}
randomize:
  objects.ball.mass: {normal: {mean: 1, std: 0.7}}
samples: 12
"""


@pytest.mark.nightly
def test_samples_that_cannot_be_run_do_not_count_in_the_rate(varied):
    path = varied(SOMETIMES_INVALID)
    done = harness("run", path, "--no-page", cwd=path.parent)
    assert done.returncode == 2
    found = json.loads((path.parent / "reports" / "results.json").read_text())
    outcomes = [case["outcome"] for case in found["cases"]]
    [rate] = [each["rate"] for each in found["rates"]]
    assert rate["invalid"] == outcomes.count("invalid") > 0
    assert rate["total"] == rate["passed"] == outcomes.count("passed") > 0
    said = f"{rate['passed']} of {rate['passed']} samples passed, 100.0%"
    assert said in done.stdout
    assert "1 sample invalid and not counted" in done.stdout
    assert f"{path}:11:22: `mass` must be more than 0, not `-" in done.stdout
    assert "--set" not in done.stdout


@pytest.mark.nightly
def test_a_mistake_of_the_file_is_reported_once_not_for_every_sample(varied):
    path = varied(VARIED.replace("wait:", "wiat:"))
    done = harness("run", path, "--no-report", cwd=path.parent)
    assert done.returncode == 2
    assert done.stdout.count("did you mean `wait`") <= 1
    assert "1 invalid of 1 case" in done.stdout


@pytest.mark.nightly
def test_failures_are_reported_in_the_format_that_is_requested(varied):
    path = varied(GRID)
    words = ("--no-report", "--case", "0.2_s-1")
    short = harness("run", path, *words, "--format", "short", cwd=path.parent)
    assert short.stdout.startswith(f"{path}:7:1: [0.2_s-1] duration")
    assert len(short.stdout.splitlines()) == 1
    passed = harness("run", path, "--no-report", "--case", "0.1_s-1", "--format", "short",
                     cwd=path.parent)  # fmt: skip
    assert (passed.returncode, passed.stdout) == (0, "1 case passed\n")
    reported = harness("run", path, *words, "--format", "github", cwd=path.parent)
    assert reported.stdout.startswith(f"::error file={path},line=7,title=Wait [0.2_s-1]::duration")
    path.write_text(GRID.replace("wait", "wiat"))
    checked = harness("check", path, "--format", "short", cwd=path.parent)
    assert checked.stdout.startswith(f"{path}:5:5: no verb is called `wiat`")
    assert len(checked.stdout.splitlines()) == 1
    assert (short.returncode, reported.returncode, checked.returncode) == (1, 1, 2)
