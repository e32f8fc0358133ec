"""A suite in parts on several machines, merged: the same results, page and rates as one run."""

import json
import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import pytest
import yaml

from harness.core.resources import data_folder
from harness.plugins.campaigns.shards import Shard, read_shard_records, shard_of
from harness.suite.discovery import UsageError
from harness.suite.plan import planned_cases
from harness.suite.request import SuiteRequest
from tests.commands import harness

GUIDE = (Path(__file__).parents[3] / "docs/guides/many_machines.md").read_text(encoding="utf-8")
SAMPLED = """\
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
samples: 10
expect_rate: {at_least: 30 %, stop_early: EARLY}
"""
GRID = """\
scenario: Wait
robot: open_manipulator_x
tags: [grid]
params: {time: 0.1 s}
steps:
  - wait: "${time}"
expect:
  - duration: {at_most: 0.15 s}
parametrize:
  time: [0.05 s, 0.1 s, 0.2 s]
"""


def document(folder):
    return json.loads((folder / "results.json").read_text())


def case_facts(results):
    keys = ("file", "case", "outcome", "digest", "values", "tags", "worst_margin")
    return [{key: case[key] for key in keys} for case in results["cases"]]


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """A folder with one whole run, and its three parts, each below a folder of its own."""
    folder = tmp_path_factory.mktemp("parts")
    (folder / "sampled.scenario.yaml").write_text(SAMPLED.replace("EARLY", "true"))
    (folder / "grid.scenario.yaml").write_text(GRID)
    words = ("--no-page", "--in-process")
    whole = harness("run", ".", "--report-dir", "whole", *words, cwd=folder)
    codes = []
    for number in (1, 2, 3):
        part = harness(
            "run", ".", "--shard", f"{number}/3", "--report-dir", f"at{number}", *words, cwd=folder
        )  # fmt: skip
        codes.append(part.returncode)
    assert whole.returncode == 1  # one case of the grid waits too long
    assert sorted(codes) == [0, 0, 1]  # in the part that holds that case
    return folder


def test_merged_parts_are_what_one_run_is(parts, tmp_path):
    merged = harness(
        "merge", "at1", "at2", "at3", "--report-dir", tmp_path / "out", cwd=parts
    )  # fmt: skip
    whole, joined = document(parts / "whole"), document(tmp_path / "out")
    assert merged.returncode == whole["exit_code"] == joined["exit_code"] == 1
    assert case_facts(joined) == case_facts(whole)
    assert joined["rates"] == whole["rates"]
    assert whole["rates"][0]["rate"]["stopped_early"]
    assert "is confirmed" in merged.stdout
    assert (tmp_path / "out" / "junit.xml").is_file()


def test_every_case_is_in_exactly_one_part(parts):
    held = Counter(
        (line["result"]["file"], line["result"]["case"])
        for number in (1, 2, 3)
        for line in map(
            json.loads, (parts / f"at{number}" / "results.jsonl").read_text().splitlines()
        )
        if "result" in line
    )
    assert len(held) == 13
    assert set(held.values()) == {1}


def test_a_part_runs_all_its_samples_and_decides_no_rate(parts):
    for number in (1, 2, 3):
        assert document(parts / f"at{number}")["rates"] == []


def test_a_part_that_is_missing_is_named(parts, tmp_path):
    merged = harness("merge", "at1", "at3", "--report-dir", tmp_path / "out", cwd=parts)
    assert merged.returncode == 3
    assert "incomplete: part 2/3 is missing" in merged.stderr
    assert document(tmp_path / "out")["missing_parts"] == ["part 2/3 is missing"]
    assert "part 2/3 is missing" in (tmp_path / "out" / "index.html").read_text()


def test_a_part_that_was_cut_off_is_named_with_what_it_lacks(parts, tmp_path):
    cut = tmp_path / "cut"
    shutil.copytree(parts / "at2", cut)
    lines = (cut / "results.jsonl").read_text().splitlines()
    (cut / "results.jsonl").write_text("\n".join(lines[:-2]) + "\n" + lines[-1][:50])
    merged = harness("merge", "at1", cut, "at3", "--report-dir", tmp_path / "out", cwd=parts)
    assert merged.returncode == 3
    count = sum('"result"' in line for line in lines)
    assert f"part 2/3 in '{cut}' lacks 2 of {count} results" in merged.stderr


def test_links_of_merged_results_lead_to_where_the_parts_are_now(parts, tmp_path):
    moved = [shutil.copytree(parts / f"at{n}", tmp_path / f"download{n}") for n in (1, 2, 3)]
    harness("merge", *moved, "--report-dir", tmp_path / "out", cwd=tmp_path)
    folders = [case["report_dir"] for case in document(tmp_path / "out")["cases"]]
    written = [folder for folder in folders if folder]
    assert written
    assert all((tmp_path / folder / "run.json").is_file() for folder in written)


@pytest.mark.nightly
def test_parts_of_different_suites_are_refused(parts, tmp_path):
    grid = tmp_path / "grid.scenario.yaml"
    grid.write_text(GRID)
    harness("run", grid, "--shard", "2/3", "--report-dir", "other", "--no-page", cwd=tmp_path)
    refused = harness("merge", parts / "at1", "other", "--report-dir", "out", cwd=tmp_path)
    assert refused.returncode == 2
    assert "they differ in the scenario files" in refused.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.nightly
def test_a_part_that_leaves_nothing_to_merge_says_so(tmp_path):
    (tmp_path / "grid.scenario.yaml").write_text(GRID)
    words = ("run", ".", "--shard", "1/9", "--no-report")
    assert "a part leaves nothing to merge; use --no-page" in harness(*words, cwd=tmp_path).stderr
    assert not (tmp_path / "reports").exists()


def test_parts_of_two_versions_are_refused(parts, tmp_path):
    old = shutil.copytree(parts / "at2", tmp_path / "old")
    text = (old / "shard.json").read_text()
    version = json.loads(text)["installation"]["version"]
    (old / "shard.json").write_text(text.replace(f'"version": "{version}"', '"version": "0.0.1"'))
    refused = harness("merge", parts / "at1", old, "--report-dir", "out", cwd=tmp_path)
    assert refused.returncode == 2
    assert f"the program or its libraries: version 0.0.1 instead of {version}" in refused.stderr


@pytest.mark.nightly(but=['"outcome":"failed"-"outcome":"passed"'])
@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('"outcome":"failed"', '"outcome":"passed"'),
        ('"digest":"', '"digest":"0'),
        ('"seed":', '"seed":1'),
        ('"files":{', '"files":{"another.yaml":"",'),
    ],
)
def test_an_edited_line_is_refused(parts, tmp_path, before, after):
    edited = shutil.copytree(parts / "at2", tmp_path / "edited")
    text = "".join((parts / f"at{number}/results.jsonl").read_text() for number in (1, 2, 3))
    assert before in text
    (edited / "results.jsonl").write_text(text.replace(before, after, 1))
    number = text[: text.index(before)].count("\n") + 1
    refused = harness("merge", parts / "at1", edited, "--report-dir", "out", cwd=tmp_path)
    assert refused.returncode == 2
    assert f"line {number} of '" in refused.stderr
    assert "its checksum does not match" in refused.stderr
    assert not (tmp_path / "out/results.jsonl").exists()


@pytest.mark.nightly
def test_parts_that_ran_different_robots_are_refused(tmp_path):
    """The robot's folder is named, none of its files."""
    shutil.copytree(data_folder("robots") / "open_manipulator_x", tmp_path / "arm")
    text = GRID.replace("robot: open_manipulator_x", "robot: {model: ./arm}")
    text = text.replace("[0.05 s, 0.1 s, 0.2 s]", str([f"{2 * n} ms" for n in range(1, 9)]))
    (tmp_path / "grid.scenario.yaml").write_text(text)
    for number in (1, 2):
        options = ("--shard", f"{number}/2", "--report-dir", f"at{number}", "--no-page")
        assert harness("run", ".", *options, cwd=tmp_path).returncode == 0
        assert document(tmp_path / f"at{number}")["cases"]  # of eight, each part has some
        with (tmp_path / "arm/open_manipulator_x.urdf").open("a") as file:
            file.write("<!-- another arm -->\n")
    refused = harness("merge", "at1", "at2", "--report-dir", "out", cwd=tmp_path)
    assert refused.returncode == 2
    assert "different contents of 'arm/open_manipulator_x.urdf'" in refused.stderr


@pytest.mark.nightly(but=["{"])
@pytest.mark.parametrize("text", ["", "{", "[]", "null", '{"format": "armharness-shard/2"}'])
def test_a_damaged_description_is_refused(parts, tmp_path, text):
    broken = shutil.copytree(parts / "at2", tmp_path / "broken")
    (broken / "shard.json").write_text(text)
    refused = harness("merge", parts / "at1", broken, "--report-dir", "out", cwd=tmp_path)
    assert refused.returncode == 2
    assert "shard.json" in refused.stderr
    assert "Traceback" not in refused.stderr


@pytest.mark.parametrize(
    ("varied", "said"),
    [
        ({"time": {"uniform": [0]}}, "cannot be read"),
        ({"time": {"version": [0, 1]}}, "unknown key `version`"),
        ({"time": {"uniform": [0, 10**400]}}, "more than 308 digits"),
        ({"time": {"normal": {"mean": -(10**400), "std": 1}}}, "more than 308 digits"),
    ],
)
def test_impossible_variations_in_a_description_are_refused(parts, tmp_path, varied, said):
    broken = Path(shutil.copytree(next(parts.glob("*/shard.json")).parent, tmp_path / "broken"))
    record = json.loads((broken / "shard.json").read_text())
    sampled = next(each for each in record["files"] if "randomize" in each["varied"])
    sampled["varied"]["randomize"] = varied
    (broken / "shard.json").write_text(json.dumps(record))
    with pytest.raises(UsageError, match=re.escape(said)):
        read_shard_records([broken])


def test_a_description_with_endless_samples_is_refused(parts, tmp_path):
    broken = shutil.copytree(parts / "at1", tmp_path / "broken")
    record = json.loads((broken / "shard.json").read_text())
    record["selection"]["samples"] = 2**53
    (broken / "shard.json").write_text(json.dumps(record))
    refused = harness("merge", broken, "--report-dir", "out", cwd=tmp_path)
    assert refused.returncode == 2
    assert "cases; at most 100000 are run of a file" in refused.stderr


def test_a_folder_without_a_part_and_a_part_twice_are_refused(parts, tmp_path):
    nothing = harness("merge", parts / "at1", parts / "whole", cwd=tmp_path)
    assert nothing.returncode == 2
    assert "holds no shard.json" in nothing.stderr
    twice = harness("merge", parts / "at1", parts / "at1", cwd=tmp_path)
    assert twice.returncode == 2
    assert "both hold part 1/3" in twice.stderr


def test_a_merge_does_not_overwrite_one_of_its_parts(parts, tmp_path):
    folders = [parts / f"at{number}" for number in (1, 2, 3)]
    before = (folders[1] / "results.jsonl").read_bytes()
    merged = harness("merge", *folders, "--report-dir", folders[1], cwd=tmp_path)
    assert merged.returncode == 2
    assert "at2' holds a part" in merged.stderr
    assert (folders[1] / "results.jsonl").read_bytes() == before


def parts_of(plan, count):
    """The file and the name of each case of each part."""
    held = [Shard(number, count).part_of(plan) for number in range(1, count + 1)]
    return [[(each.file.name, each.name) for each in part] for part in held]


@pytest.mark.parametrize("count", [1, 2, 3, 10])
def test_every_case_is_in_one_part_and_a_new_file_moves_none_of_many(tmp_path, monkeypatch, count):
    monkeypatch.chdir(tmp_path)
    for name, text in {"a": GRID, "b": GRID, "c": SAMPLED.replace("EARLY", "true")}.items():
        Path(f"{name}.scenario.yaml").write_text(text)

    def parts(*names):
        files = [Path(f"{name}.scenario.yaml") for name in names]
        plan = planned_cases(files, SuiteRequest(samples=1000))
        held = parts_of(plan, count)
        together = sorted(each for part in held for each in part)
        assert together == sorted((each.file.name, each.name) for each in plan)
        return held

    for few, all_ in zip(parts("a", "c"), parts("a", "b", "c"), strict=True):
        assert few == [each for each in all_ if each[0] != "b.scenario.yaml"]


def test_many_cases_are_spread_evenly(tmp_path, monkeypatch):
    """Within four standard deviations of 250 of 1000 cases."""
    monkeypatch.chdir(tmp_path)
    Path("c.scenario.yaml").write_text(SAMPLED.replace("EARLY", "true"))
    plan = planned_cases([Path("c.scenario.yaml")], SuiteRequest(samples=1000))
    counts = [len(part) for part in parts_of(plan, 4)]
    assert sum(counts) == len(plan)
    assert max(abs(each - len(plan) / 4) for each in counts) < 4 * (len(plan) * 3 / 16) ** 0.5


@pytest.mark.parametrize(("files", "count"), [(2, 2), (3, 3), (5, 4), (7, 2), (2, 3), (15, 4)])
@pytest.mark.parametrize("name", ["a", "pick", "lesson"])
def test_a_few_files_are_spread_by_count(tmp_path, monkeypatch, files, count, name):
    monkeypatch.chdir(tmp_path)
    paths = [Path(f"{name}_{number}.scenario.yaml") for number in range(files)]
    for path in paths:
        path.write_text(GRID.partition("parametrize:")[0])
    counts = [len(part) for part in parts_of(planned_cases(paths, SuiteRequest()), count)]
    assert sum(counts) == files
    assert max(counts) - min(counts) <= 1


@pytest.mark.parametrize(
    ("environment", "part"),
    [
        ({"HARNESS_SHARD": "3/10"}, Shard(3, 10)),
        ({"SLURM_ARRAY_TASK_ID": "0", "SLURM_ARRAY_TASK_COUNT": "4"}, Shard(1, 4)),
        (
            {
                "SLURM_ARRAY_TASK_ID": "7",
                "SLURM_ARRAY_TASK_MIN": "1",
                "SLURM_ARRAY_TASK_STEP": "2",
                "SLURM_ARRAY_TASK_COUNT": "4",
            },
            Shard(4, 4),
        ),
        ({"CI_NODE_INDEX": "2", "CI_NODE_TOTAL": "5"}, Shard(2, 5)),
        ({"JOB_COMPLETION_INDEX": "0", "HARNESS_SHARDS": "5"}, Shard(1, 5)),
    ],
)
def test_schedulers_name_the_part(environment, part):
    assert shard_of("auto", environment) == part


@pytest.mark.parametrize(
    ("environment", "says"),
    [
        ({}, "needs one of these environment variables: HARNESS_SHARD"),
        ({"JOB_COMPLETION_INDEX": "0"}, "HARNESS_SHARDS is not set"),
        ({"CI_NODE_INDEX": "6", "CI_NODE_TOTAL": "5"}, "names part 6 of 5"),
        ({"SLURM_ARRAY_TASK_ID": "x", "SLURM_ARRAY_TASK_COUNT": "4"}, "is 'x'"),
        ({"HARNESS_SHARD": "auto"}, "needs one of these"),
    ],
)
def test_what_schedulers_leave_out_is_named(environment, says):
    with pytest.raises(UsageError, match=says):
        shard_of("auto", environment)


@pytest.mark.parametrize("text", ["0/3", "4/3", "3", "a/b", "1/0", "-1/3", "1/3/5", "1.0/3"])
def test_a_part_that_is_none_is_refused(text):
    with pytest.raises(UsageError, match="write NUMBER/COUNT"):
        shard_of(text)


@pytest.mark.nightly
def test_a_part_without_cases_passes_and_can_be_merged(tmp_path):
    (tmp_path / "grid.scenario.yaml").write_text(GRID)
    parts = [f"at{number}" for number in range(1, 5)]
    for number, part in enumerate(parts, start=1):
        ran = harness(
            "run", ".", "--report-dir", part, "--no-page", "--shard", "auto",
            cwd=tmp_path, CI_NODE_INDEX=str(number), CI_NODE_TOTAL="4",
        )  # fmt: skip
        assert ran.returncode in (0, 1), ran.stderr
    merged = harness("merge", *parts, "--report-dir", "out", "--json", cwd=tmp_path)
    assert [case["outcome"] for case in json.loads(merged.stdout)["cases"]] == [
        "passed", "passed", "failed",
    ]  # fmt: skip


def test_the_recipes_are_valid_and_use_the_same_number_of_parts_throughout():
    gitlab, github, kubernetes = (
        yaml.safe_load(text) for text in re.findall(r"(?s)```yaml\n(.*?)```", GUIDE)
    )
    assert gitlab["arm"]["parallel"] == 4
    shards = github["jobs"]["arm"]["strategy"]["matrix"]["shard"]
    arm, merge = (github["jobs"][name]["steps"] for name in ("arm", "merge"))
    [command] = [each["run"] for each in arm if "harness run" in each.get("run", "")]
    assert f"--shard ${{{{ matrix.shard }}}}/{len(shards)} " in command
    for steps in (arm, merge):
        words = [each.get("uses", "") + each.get("run", "") for each in steps]
        [install] = [i for i, each in enumerate(words) if "pip install ./armharness" in each]
        assert steps[install - 2]["with"]["path"] == "armharness"
        assert all(i > install for i, each in enumerate(words) if each.startswith("harness "))
        [upload] = [each for each in steps if "upload-artifact" in each.get("uses", "")]
        assert upload["if"] == "always()"
    assert merge[-1]["with"]["path"].split() == ["merged", "parts"]
    job = kubernetes["spec"]
    [container] = job["template"]["spec"]["containers"]
    assert container["env"] == [{"name": "HARNESS_SHARDS", "value": str(job["completions"])}]
    assert job["completionMode"] == "Indexed"
    slurm = re.search(r"(?s)```sh\n(#!/bin/bash.*?)```", GUIDE)[1]
    assert subprocess.run(["bash", "-n"], input=slurm, text=True, check=False).returncode == 0


def test_every_command_of_the_guide_is_accepted():
    from harness.cli.main import parser_of

    guide = GUIDE.replace("${{ matrix.shard }}", "1").replace('"$SLURM_CPUS_PER_TASK"', "4")
    lines = re.findall(r"harness ((?:run|merge) [^\n`\"]*)", guide)
    assert len(lines) >= 10
    for line in lines:
        words = line.split()
        words += ["x"] if words[-1] == "--report-dir" else []
        parser_of(words).parse_args(words)


@pytest.mark.nightly
def test_a_merged_suite_can_be_queried(parts, tmp_path):
    merged = tmp_path / "merged"
    harness("merge", "at1", "at2", "at3", "--report-dir", merged, cwd=parts)
    found = json.loads(harness("results", merged, "--json", cwd=parts).stdout)
    counted = len(document(merged)["cases"])
    assert (found["selected"], found["left_out"]) == (counted, 13 - counted)
    assert counted < 13  # a part runs samples that an early stop leaves out
    grid = json.loads(harness("results", merged, "--tag", "grid", "--json", cwd=parts).stdout)
    assert {run["time"] for run in grid["runs"]} == {"0.05 s", "0.1 s", "0.2 s"}


@pytest.mark.nightly
def test_commands_to_run_again_have_the_options_of_the_parts(tmp_path):
    (tmp_path / "grid.scenario.yaml").write_text(GRID)
    harness("run", ".", "--shard", "1/1", "--strict", "--reporter", "rosbag", cwd=tmp_path)
    merged = harness("merge", "reports", "--report-dir", "all", cwd=tmp_path)
    [again] = re.findall(r"again:  (.*)", merged.stdout)
    assert "--strict" in again
    assert "--reporter rosbag" in again
