"""Verdicts against a slow and simple judge on random pick, push, drop and throw runs."""

from __future__ import annotations

import os
import sys
from collections import Counter

import pytest

from harness.recording.read_run import read_run
from tests.running import run_case
from tests.second_opinion.judge import Judge
from tests.second_opinion.runs import EXPECTATIONS, KINDS, SRDF, URDF, trial

SAMPLE = 8
MANY = int(os.environ.get("SECOND_OPINIONS", "1000"))


def compared(number, folder):
    """Verdict and opinion of each expectation of a run, where both say something."""
    (folder / "gantry.urdf").write_text(URDF)
    (folder / "gantry.srdf").write_text(SRDF)
    path = folder / "trial.scenario.yaml"
    one = trial(number)
    path.write_text(one.text)
    result = run_case(path, report_dir=folder / "report", stills=False, page=False)
    assert result.verdicts, (result.problems, result.message)
    opinions = Judge(one, read_run(folder / "report").run).opinions()
    for name, verdict in zip(EXPECTATIONS, result.verdicts, strict=True):
        if verdict.status in ("passed", "failed") and opinions[name] is not None:
            yield name, verdict.status == "passed", opinions[name], verdict.reason


def disagreements(number, folder, counts):
    """Every answer in which the verdict and the judge differ; counts what was compared."""
    for name, verdict, opinion, reason in compared(number, folder):
        counts[name, verdict] += 1
        if verdict != opinion:
            kind = KINDS[number % len(KINDS)]
            yield f"{number} ({kind}): {name}: {verdict}, not {opinion}: {reason}"


@pytest.mark.nightly(but=[2])
@pytest.mark.parametrize("number", range(SAMPLE))
def test_a_few_random_runs_are_judged_as_the_simple_judge_does(number, tmp_path):
    counts = Counter()
    assert list(disagreements(number, tmp_path, counts)) == []
    assert counts, "nothing was compared"


@pytest.mark.nightly
def test_many_random_runs_are_judged_as_the_simple_judge_does(tmp_path, capsys):
    counts, found = Counter(), []
    for number in range(MANY):
        folder = tmp_path / str(number % 2)
        folder.mkdir(exist_ok=True)
        found += disagreements(number, folder, counts)
    with capsys.disabled():
        for name in EXPECTATIONS:
            sys.stdout.write(f"{name}: {counts[name, True]} hold, {counts[name, False]} do not\n")
    assert found == []
