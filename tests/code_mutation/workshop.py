"""A copy of the project in which mutants are tried with the tests that execute their line."""

from __future__ import annotations

import os
import re
import resource
import shutil
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.code_mutation.mutants import Mutant

ROOT = Path(__file__).resolve().parents[2]
COPIED = (
    "harness",
    "tests",
    "docs",
    "robots",
    "worlds",
    "scenarios",
    "pyproject.toml",
    "README.md",
)
# The tests of the scope; the rest of the suite reaches it only through whole runs.
TESTS = (
    "tests/judging",
    "tests/judging/expectations",
    "tests/session/observation",
    "tests/session",
    "tests/steps",
    "tests/recording",
    "tests/adversarial",
    "tests/cli/test_commands.py",
    "tests/planning/test_efforts.py",
    "tests/planning/test_verification.py",
    "tests/planning/test_path_constraints.py",
    "tests/planning/test_held_constraints.py",
    "tests/planning/test_verified_numbers.py",
    "tests/planning/test_linear_motion.py",
    "tests/robot/test_mimic_couplings.py",
    "tests/system/test_findings.py",
)
# Its tests read the defaults and limits of modules, which only imports execute.
DECLARED = "tests/judging/expectations/test_declared.py"
# Tests that execute a line are run, shortest first, until they add up to this [s].
LONGEST = 150.0
# Any other return code of pytest says that the tests did not run.
OUTCOMES = {
    int(pytest.ExitCode.OK): "survived",
    int(pytest.ExitCode.TESTS_FAILED): "failed",
    -signal.SIGXCPU: "timed out",
}


class WorkshopError(Exception):
    """The tests did not run, so that nothing is known about the mutant."""


class Workshop:
    """A copy of the project with the record of which test executes which line."""

    def __init__(self, folder: Path, root: Path = ROOT, copied: tuple[str, ...] = COPIED) -> None:
        self.folder = folder
        for name in copied:
            source = root / name
            if source.is_dir():
                shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy(source, folder / name)
        (folder / "reports").mkdir(parents=True)
        self.durations: dict[str, float] = {}
        self.executed: dict[str, dict[int, list[str]]] = {}

    def record(self) -> None:
        """Run the tests once, unmutated, and record which test executes which line."""
        from coverage import CoverageData

        done = self._pytest(
            "--cov=harness", "--cov-context=test", "--cov-report=", "--junitxml=took.xml", *TESTS
        )
        if done.returncode:
            raise RuntimeError(f"the unmutated tests fail:\n{done.stdout[-4000:]}")
        for case in ElementTree.parse(self.folder / "took.xml").iter("testcase"):
            name = f"{case.get('classname', '').replace('.', '/')}.py::{case.get('name')}"
            self.durations[name] = float(case.get("time", 0))
        data = CoverageData(str(self.folder / ".coverage"))
        data.read()
        for path in data.measured_files():
            module = str(Path(path).relative_to(self.folder))
            self.executed[module] = data.contexts_by_lineno(path)

    def tests_of(self, module: str, line: int) -> list[str]:
        """The tests that execute a line, or its module where only imports do; shortest first.

        A fixture of a file runs with the first test that needs it, and serves others.
        """
        lines = self.executed.get(module, {})
        found = contexts(lines.get(line, []))
        if not found:
            found = {name for names in lines.values() for name in contexts(names)}
            found |= {name for name in self.durations if name.startswith(DECLARED)}
        files = {name.partition("::")[0] for name in lines.get(line, []) if name.endswith("|setup")}
        found |= {name for name in self.durations if name.partition("::")[0] in files}
        chosen, total = [], 0.0
        for name in sorted(found, key=lambda name: (self.durations.get(name, 1.0), name)):
            total += self.durations.get(name, 1.0)
            if chosen and total > LONGEST:
                break
            chosen.append(name)
        return chosen

    def outcome(self, mutant: Mutant, limit: float = 3 * LONGEST) -> str:
        """What the tests that execute the mutated line make of the mutant.

        Returns:
            `survived`, `failed`, `timed out` (beyond `limit` [s] of processor time), or
            `not importable` where the mutated module or a module of tests raises at its import.

        Raises:
            WorkshopError: The tests did not run to a result.
        """
        tests = self.tests_of(mutant.module, mutant.line)
        if not tests:
            return "survived"
        path = self.folder / mutant.module
        original = path.read_text(encoding="utf-8")
        (self.folder / "chosen.txt").write_text("\n".join(tests), encoding="utf-8")
        path.write_text(mutant.source, encoding="utf-8")
        try:
            done = self._pytest("-x", "@chosen.txt", limit=limit)
            if done.returncode in OUTCOMES:
                return OUTCOMES[done.returncode]
            if not self._imports(mutant.module, tests):
                return "not importable"
        finally:
            path.write_text(original, encoding="utf-8")
        raise WorkshopError(f"pytest returned {done.returncode}:\n{done.stdout}{done.stderr}")

    def _imports(self, module: str, tests: list[str]) -> bool:
        """Whether a module can be imported, and the modules of tests too."""
        name = module.removesuffix(".py").replace("/", ".").removesuffix(".__init__")
        if self._python("-c", f"import {name}").returncode:
            return False
        files = sorted({test.partition("::")[0] for test in tests})
        return self._pytest("--collect-only", *files).returncode != pytest.ExitCode.INTERRUPTED

    def _pytest(self, *options: str, limit: float | None = None) -> subprocess.CompletedProcess:
        """Run tests; beyond a limit of processor time [s], which no load prolongs, they fail."""
        return self._python("-m", "pytest", "-q", "-p", "no:cacheprovider", *options, limit=limit)

    def _python(self, *options: str, limit: float | None = None) -> subprocess.CompletedProcess:
        return subprocess.run(
            [sys.executable, "-B", *options],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": str(self.folder)},
            capture_output=True,
            text=True,
            preexec_fn=None if limit is None else partial(_limit_processor_time, round(limit)),
            check=False,
        )


def _limit_processor_time(seconds: int) -> None:
    # Beyond the first limit SIGXCPU ends the process, which no other end is mistaken for.
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 10))


def contexts(names: list[str]) -> set[str]:
    """The tests among coverage's contexts, which carry the phase of the test."""
    return {re.sub(r"\|(setup|run|teardown)$", "", name) for name in names if "|" in name}
