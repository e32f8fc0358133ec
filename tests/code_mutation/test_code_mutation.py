"""Mutants of the code that decides a verdict are noticed by the package's own tests."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
import yaml

from tests.code_mutation.mutants import Mutant, draw
from tests.code_mutation.workshop import ROOT, Workshop, WorkshopError

pytestmark = pytest.mark.needs_mutation

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


def test_only_tests_that_ran_can_notice_a_mutant(tmp_path):
    """A mutant is noticed by a failed test, a timeout or an import; other ends are errors."""
    root = tmp_path / "project"
    (root / "halves").mkdir(parents=True)
    (root / "tests").mkdir()
    (root / "halves/half.py").write_text("def half(x):\n    return x / 2\n", encoding="utf-8")
    (root / "tests/test_half.py").write_text(
        "from halves.half import half\nTWO = half(4)\n\n\ndef test_half():\n    assert TWO == 2\n",
        encoding="utf-8",
    )
    workshop = Workshop(tmp_path / "copy", root, ("halves", "tests"))

    def outcome(body, test="tests/test_half.py::test_half"):
        workshop.executed = {"halves/half.py": {2: [f"{test}|run"]}}
        mutant = Mutant("halves/half.py", 2, "", f"def half(x):\n    {body}\n")
        return workshop.outcome(mutant, limit=5)

    assert outcome("return x * 0.5") == "survived"
    assert outcome("return x / 3") == "failed"
    assert outcome("raise ValueError(x)") == "not importable"
    assert outcome("return half") == "failed"
    assert outcome("return unclosed(") == "not importable"
    assert outcome("while True: pass") == "timed out"
    with pytest.raises(WorkshopError, match="returned 4"):
        outcome("return x / 3", "tests/test_half.py::test_renamed")
    assert (tmp_path / "copy/halves/half.py").read_text(encoding="utf-8").endswith("x / 2\n")


def test_what_a_fixture_executes_is_tested_by_its_whole_file(tmp_path):
    workshop = Workshop(tmp_path / "copy", tmp_path, ())
    first, second, other = "tests/a.py::test_first", "tests/a.py::test_second", "tests/b.py::test"
    workshop.durations = {first: 2.0, second: 1.0, other: 0.5}
    workshop.executed = {"half.py": {2: [f"{first}|setup"], 3: [f"{first}|run"]}}
    assert workshop.tests_of("half.py", 2) == [second, first]
    assert workshop.tests_of("half.py", 3) == [first]
    assert workshop.tests_of("half.py", 4) == [first], "it is executed at its import"


def test_nearly_all_mutants_are_noticed(tmp_path, capsys):
    workshop = Workshop(tmp_path)
    workshop.record()
    equivalent, survivors, tried = equivalent_mutants(), [], 0
    for mutant in draw(tmp_path, COUNT, SEED):
        before, after = mutant.difference((tmp_path / mutant.module).read_text(encoding="utf-8"))
        if (mutant.module, before, after) in equivalent:
            continue
        tried += 1
        outcome = workshop.outcome(mutant)
        with capsys.disabled():
            place = f"{mutant.module}:{mutant.line}"
            sys.stdout.write(f"{outcome:14} {place} {before!r} -> {after!r}\n")
            sys.stdout.flush()
        if outcome == "survived":
            survivors.append(mutant)
    with capsys.disabled():
        sys.stdout.write(f"{tried - len(survivors)} of {tried} mutants noticed (seed {SEED})\n")
    assert len(survivors) <= (1 - REQUIRED) * tried
