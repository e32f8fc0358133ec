"""`--conditions`: the samples of one campaign, run again with something else."""

import json
from pathlib import Path

import pytest

from harness.cli.main import main

SCENARIO = """\
scenario: Wait at a ball
robot: open_manipulator_x
seed: 4
params: {x: 0.0, time: 2 ms}
objects:
  - {name: ball, sphere: {radius: 2 cm}, pose: {xyz: ["${x}", 0.2, 0.5]}, static: true}
steps:
  - wait: "${time}"
expect:
  - formula: "always (x(ball) < 0.3)"
randomize:
  x: {uniform: [-20 cm, 60 cm]}
samples: 6
expect_rate: {at_least: 10 %, stop_early: false}
"""


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A working directory with the scenario."""
    monkeypatch.chdir(tmp_path)
    Path("ball.scenario.yaml").write_text(SCENARIO)
    return tmp_path


@pytest.fixture
def campaign(project, capsys):
    """The working directory of a campaign with its report in `first`."""
    assert run("ball.scenario.yaml", "--report-dir", "first") == 0
    capsys.readouterr()
    return project


def run(*words):
    return main(["run", *words, "--no-page", "-j", "2"])


def cases(folder):
    found = json.loads(Path(folder, "results.json").read_text())["cases"]
    return {each["case"]: (each["seed"], each["values"], each["digest"]) for each in found}


@pytest.mark.nightly
@pytest.mark.usefixtures("campaign")
def test_stored_conditions_are_the_same_runs_whatever_the_file_draws():
    text = SCENARIO.replace("[-20 cm, 60 cm]", "[-1 m, 1 m]").replace("seed: 4", "seed: 9")
    Path("ball.scenario.yaml").write_text(text.replace("samples: 6", "samples: 50"))
    assert run("ball.scenario.yaml", "--report-dir", "again", "--conditions", "first") == 0
    assert cases("again") == cases("first")


@pytest.mark.nightly
@pytest.mark.usefixtures("project")
def test_a_value_that_an_option_gave_is_part_of_the_conditions():
    run("ball.scenario.yaml", "--report-dir", "first", "--set", "x=0.1", "--seed", "3")
    assert {values["x"] for _, values, _ in cases("first").values()} == {0.1}
    run("ball.scenario.yaml", "--report-dir", "again", "--conditions", "first")
    assert cases("again") == cases("first")


@pytest.mark.nightly
@pytest.mark.usefixtures("project")
def test_conditions_that_were_drawn_again_repeat_their_digests():
    cube = "  - {name: cube, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [0, 0.2, 0.5]}}\n"
    text = SCENARIO.replace("steps:", cube + "steps:").replace(
        "samples: 6", "redraw_overlaps: true"
    )
    Path("ball.scenario.yaml").write_text(text + "samples: 12\n")
    run("ball.scenario.yaml", "--report-dir", "first")
    results = json.loads(Path("first/results.json").read_text())["cases"]
    assert any(each["redraws"] for each in results)
    run("ball.scenario.yaml", "--report-dir", "again", "--conditions", "first")
    assert cases("again") == cases("first")


@pytest.mark.nightly
def test_the_same_conditions_meet_something_else_and_are_compared_in_pairs(campaign, capsys):
    conditions = str(campaign / "first/conditions.jsonl")
    Path("other.scenario.yaml").write_text(SCENARIO.replace("< 0.3", "< 0.1"))
    run("other.scenario.yaml", "--report-dir", "other", "--conditions", conditions,
        "--set", "time=3 ms")  # fmt: skip
    first, other = cases("first"), cases("other")
    assert {name: each[:2] for name, each in first.items()} == {
        name: each[:2] for name, each in other.items()
    }
    assert all(first[name][2] != other[name][2] for name in first)
    capsys.readouterr()
    main(["results", "first", "--against", "other", "--json"])
    assert json.loads(capsys.readouterr().out)["comparison"]["pairs"] == 6


@pytest.mark.nightly
@pytest.mark.usefixtures("campaign")
def test_every_condition_is_run_although_a_sequential_test_could_stop():
    text = SCENARIO.replace("stop_early: false", "stop_early: true")
    Path("ball.scenario.yaml").write_text(text)
    run("ball.scenario.yaml", "--report-dir", "again", "--conditions", "first")
    assert len(cases("again")) == 6


@pytest.mark.nightly
@pytest.mark.usefixtures("campaign")
def test_conditions_are_divided_into_parts_and_merged(capsys):
    text = SCENARIO.replace("[-20 cm, 60 cm]", "[-1 m, 1 m]")  # what the file draws does not matter
    Path("ball.scenario.yaml").write_text(text)
    for number in (1, 2):
        words = ("--shard", f"{number}/2", "--report-dir", f"part{number}")
        assert run("ball.scenario.yaml", "--conditions", "first", *words) == 0
    Path("ball.scenario.yaml").unlink()
    assert cases("part1").keys().isdisjoint(cases("part2"))
    assert main(["merge", "part1", "part2", "--report-dir", "all"]) == 0
    assert cases("all") == cases("first")
    assert Path("all/conditions.jsonl").read_bytes() == Path("first/conditions.jsonl").read_bytes()
    lines = Path("first/conditions.jsonl").read_text().splitlines()[:-1]
    Path("fewer.jsonl").write_text("\n".join(lines) + "\n")
    Path("ball.scenario.yaml").write_text(text)
    run("ball.scenario.yaml", "--conditions", "fewer.jsonl", "--shard", "2/2",
        "--report-dir", "other")  # fmt: skip
    capsys.readouterr()
    assert main(["merge", "part1", "other", "--report-dir", "mixed"]) == 2
    assert "they differ in the samples of --conditions" in capsys.readouterr().err


@pytest.mark.nightly(but=[0, 2])
@pytest.mark.usefixtures("project")
@pytest.mark.parametrize(
    ("content", "options", "message"),
    [
        (None, (), "a suite with samples writes conditions.jsonl"),
        ("", (), "cannot be read"),
        ('{"format": "other"}', (), "is not of the format armharness-conditions/1"),
        ('{"format": "armharness-conditions/1"}\n', (), "has no conditions"),
        ('{"format": "armharness-conditions/1"}\n{"file": 3}\n', (), "line 2: file: Input should"),
        ('{"format": "armharness-conditions/1"}\nnothing\n', (), "line 2: Invalid JSON"),
        ("", ("--samples", "3"), "--conditions and --samples exclude each other"),
    ],
)
def test_what_is_no_file_of_conditions_is_refused(capsys, content, options, message):
    if content is not None:
        Path("c.jsonl").write_text(content)
    words = ("ball.scenario.yaml", "--report-dir", "no", "--conditions", "c.jsonl", *options)
    assert run(*words) == 2
    assert message in capsys.readouterr().err
    assert not Path("no").exists()


@pytest.mark.nightly
@pytest.mark.usefixtures("project")
def test_a_file_without_conditions_is_named(capsys):
    run("ball.scenario.yaml", "--report-dir", "first", "--samples", "2")
    for name in ("one", "two"):
        Path(f"{name}.scenario.yaml").write_text(SCENARIO)
    assert run("one.scenario.yaml", "two.scenario.yaml", "--conditions", "first") == 2
    assert "has none for 'one.scenario.yaml'; it has some for: ball" in capsys.readouterr().err
