"""Mutants of the code that decides a verdict are noticed by the package's own tests."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
import yaml

from tests.code_mutation.mutants import draw
from tests.code_mutation.workshop import ROOT, Workshop

pytestmark = pytest.mark.code_mutation

COUNT = int(os.environ.get("CODE_MUTANTS", "200"))
SEED = int(os.environ.get("CODE_MUTANTS_SEED", "0"))
REQUIRED = 0.95
SURVIVORS = Path(__file__).with_name("survivors.yaml")


def equivalent_mutants():
    """The mutants of survivors.yaml that change nothing anybody could observe."""
    entries = yaml.safe_load(SURVIVORS.read_text(encoding="utf-8")) or []
    return {(entry["module"], entry["line"], entry["mutant"]): entry["reason"] for entry in entries}


def test_mutants_are_drawn_where_code_is_executed():
    first, again = draw(ROOT, 20, 7), draw(ROOT, 20, 7)
    assert first == again
    assert len({(mutant.module, mutant.source) for mutant in first}) == 20
    for mutant in first:
        before, after = mutant.difference((ROOT / mutant.module).read_text(encoding="utf-8"))
        assert before != after


def test_nearly_all_mutants_are_noticed(tmp_path, capsys):
    workshop = Workshop(tmp_path)
    workshop.record()
    equivalent, survivors, tried = equivalent_mutants(), [], 0
    for mutant in draw(tmp_path, COUNT, SEED):
        before, after = mutant.difference((tmp_path / mutant.module).read_text(encoding="utf-8"))
        if (mutant.module, before, after) in equivalent:
            continue
        tried += 1
        survived = workshop.survives(mutant)
        with capsys.disabled():
            word = "SURVIVED" if survived else "noticed "
            sys.stdout.write(f"{word} {mutant.module}:{mutant.line} {before!r} -> {after!r}\n")
            sys.stdout.flush()
        if survived:
            survivors.append(mutant)
    with capsys.disabled():
        sys.stdout.write(f"{tried - len(survivors)} of {tried} mutants noticed (seed {SEED})\n")
    assert len(survivors) <= (1 - REQUIRED) * tried
