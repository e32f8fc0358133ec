"""Cases that share plans, physics and distances have the digests that they have alone."""

import json
import os
import subprocess
import sys

import pytest

SAMPLES = """\
scenario: Lift a box of any friction
robot: open_manipulator_x
seed: 3
params: {friction: 1.0}
objects:
  - name: table
    box: {size: [0.2, 0.2, 0.02]}
    pose: {xyz: [0.25, 0, 0.01]}
    static: true
    friction: 0.5
  - name: box
    box: {size: [0.03, 0.03, 0.06]}
    pose: {xyz: [0.2, 0, 0.05]}
    mass: 0.02
    friction: "${friction}"
steps:
  - pick: {object: box, lift: {distance: 3 cm}}
expect:
  - lifted: {object: box, above: 2 cm}
randomize:
  friction: {choice: [0.3, 0.7, 0.8, 0.9]}
samples: 5
"""


def harness(*words, cwd, **environment):
    return subprocess.run(
        [sys.executable, "-m", "harness.cli", *map(str, words)],
        cwd=cwd, capture_output=True, text=True, check=False, env={**os.environ, **environment},
    )  # fmt: skip


def run(folder, *words, **environment):
    """The results of the samples by their names."""
    words = ("run", "lift.scenario.yaml", "--no-report", "--json", *words)
    done = harness(*words, cwd=folder, **environment)
    return {each["case"]: each for each in json.loads(done.stdout)["cases"]}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sharing")
    (folder / "lift.scenario.yaml").write_text(SAMPLES)
    return folder


@pytest.fixture(scope="module")
def alone(folder):
    """The samples, each computed whole."""
    found = run(folder, "--no-sharing")
    assert [each["outcome"] for each in found.values()] == ["passed"] * 5
    return found


def digests(results):
    return {case: result["digest"] for case, result in results.items()}


def test_sharing_changes_no_digest_and_leaves_no_files(folder, alone, tmp_path):
    shared = run(folder, TMPDIR=str(tmp_path))
    assert list(tmp_path.iterdir()) == []
    assert digests(shared) == digests(alone)
    assert len(set(digests(alone).values())) > 1
    assert all(result["shared"] == {} for result in alone.values())
    taken = [result["shared"] for result in shared.values()]
    assert taken[0]["plans"][0] == 0
    assert all(each["plans"][0] >= each["plans"][1] - 1 for each in taken[1:])
    assert any(each["physics"][0] > 0.5 * each["physics"][1] for each in taken)
    assert any(each["distances"][0] > 0.5 * each["distances"][1] for each in taken)


@pytest.mark.parametrize(
    "words",
    [("-j", "2"), ("--shard", "2/2"), ("--case", "sample3"), ("--case", "*4", "--in-process")],
    ids=" ".join,
)
def test_a_sample_has_the_same_digest_in_any_company(folder, alone, words):
    found = digests(run(folder, *words))
    assert found
    assert found.items() <= digests(alone).items()


def test_repetitions_share_nothing(folder):
    done = harness("run", "lift.scenario.yaml", "--case", "sample1", "--repeat", "2", cwd=folder)
    assert done.returncode == 0, done.stdout


def test_page_journal_and_queries_say_what_was_shared(folder):
    done = harness("run", "lift.scenario.yaml", "--report-dir", "reports", cwd=folder)
    sentence = "4 of 5 cases took results from others that had the same inputs"
    assert sentence in done.stdout
    page = (folder / "reports" / "index.html").read_text()
    assert sentence in page
    assert page.count("from other cases: ") == 4
    lines = (folder / "reports" / "results.jsonl").read_text().splitlines()
    shared = [json.loads(line)["result"]["shared"] for line in lines]
    assert [each["plans"][0] > 0 for each in shared] == [False, True, True, True, True]
    listed = harness("results", "reports", cwd=folder).stdout
    assert listed.count(" plans") == 4
    harness("results", "reports", "--csv", "runs.csv", cwd=folder)
    assert "% of the physics" in (folder / "runs.csv").read_text()
