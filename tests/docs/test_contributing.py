"""The worked examples of docs/guides/extending.md, carried out in a copy of the repository."""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from docs import ROOT
from tests.extras import PREFIX, extra_of

PAGE = (ROOT / "docs/guides/extending.md").read_text(encoding="utf-8")
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"(?ms)^## (.+?)\n(.*?)(?=^## |\Z)", f"{CONTRIBUTING}\n{PAGE}"))
NEW_FILE = re.compile(r"(?ms)^`([\w./-]+)`:\n\n```\w+\n(.*?)^```$")
ROW = re.compile(r"(?ms)^At the end of the table in `([\w./-]+)`:\n\n```text\n(.*?)^```$")
COMMANDS = re.compile(r"(?ms)^```sh\n(.*?)^```$")
FOLDERS = ("harness", "docs", "tests", "scenarios", "robots", "worlds")


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """A copy of the repository with the files and rows of every example."""
    copy = tmp_path_factory.mktemp("clone")
    for name in FOLDERS:
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, copy)
    for path, text in NEW_FILE.findall(PAGE):
        assert not (copy / path).exists(), path
        (copy / path).parent.mkdir(exist_ok=True)
        (copy / path).write_text(text, encoding="utf-8")
    for path, row in ROW.findall(PAGE):
        lines = (copy / path).read_text(encoding="utf-8").splitlines(keepends=True)
        last = max(place for place, line in enumerate(lines) if line.startswith("|"))
        lines.insert(last + 1, row)
        (copy / path).write_text("".join(lines), encoding="utf-8")
    return copy


def carry_out(tree, command):
    """Run a command of the page in the copy, with this environment's programs."""
    program, *arguments = shlex.split(command)
    assert program.startswith(".venv/bin/"), command
    start = {
        ".venv/bin/python": [sys.executable],
        ".venv/bin/harness": [sys.executable, "-m", "harness.cli"],
    }.get(program, [str(Path(sys.executable).with_name(Path(program).name))])
    done = subprocess.run(
        [*start, *arguments],
        cwd=tree,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tree), *sys.path])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout[-4000:]}{done.stderr[-2000:]}"
    return done.stdout


def commands(section):
    return [line for block in COMMANDS.findall(SECTIONS[section]) for line in block.splitlines()]


@pytest.mark.nightly
@pytest.mark.parametrize("section", ["Add a step", "Add an expectation", "Add a planner"])
def test_a_worked_example_runs(tree, section):
    printed = [carry_out(tree, command) for command in commands(section)]
    assert "passed" in printed[-1]


@pytest.mark.nightly
def test_what_was_added_reaches_every_output(tree):
    carry_out(tree, ".venv/bin/python -m docs.generate")
    assert "turn_joint  armharness  Turn one joint by an angle" in re.sub(
        r"(?<=\S)  +", "  ", carry_out(tree, ".venv/bin/harness list steps")
    )
    schema = (tree / "scenarios/scenario.schema.json").read_text(encoding="utf-8")
    assert '"turn_joint"' in schema
    assert '"tcp_height"' in schema
    assert '"detour"' in schema
    assert "detour armharness Two straight lines" in " ".join(
        carry_out(tree, ".venv/bin/harness list pipelines").split()
    )
    steps = (tree / "docs/reference/steps.md").read_text(encoding="utf-8")
    assert "| `by` | an angle [rad] | required | The joint turns by this angle [rad]. |" in steps
    expectations = (tree / "docs/reference/expectations.md").read_text(encoding="utf-8")
    assert "| tcp height | m | at least `at_least` |" in expectations
    explained = carry_out(tree, ".venv/bin/harness explain scenarios/motions")
    assert "turn_joint joint1 by 0.523599 rad" in explained


@pytest.mark.nightly
def test_what_was_added_satisfies_the_checks_of_the_page(tree):
    checks = [command for command in commands("Checks") if "pyright" not in command]
    assert len(checks) == 3
    for command in checks:
        carry_out(tree, command)


@pytest.mark.nightly
def test_an_expectation_without_evidence_is_named(tree):
    file = tree / "tests/judging/expectations/test_tcp_height.py"
    text = file.read_text(encoding="utf-8")
    try:
        file.write_text(text.replace("EVIDENCE = ", "PROOF = "), encoding="utf-8")
        command = ".venv/bin/python -m pytest tests/judging/test_three_runs.py -k every_predicate"
        with pytest.raises(AssertionError, match="TcpHeight"):
            carry_out(tree, command)
    finally:
        file.write_text(text, encoding="utf-8")


def test_the_set_up_is_that_of_ci():
    ci = (ROOT / ".ci/run").read_text(encoding="utf-8").splitlines()
    assert set(commands("Set-up") + commands("Checks")) <= set(ci)


def test_the_page_names_every_marker_and_every_extra_that_a_test_needs():
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    markers = {
        each.partition(":")[0] for each in declared["tool"]["pytest"]["ini_options"]["markers"]
    }
    extras = {extra_of(each) for each in markers if each.startswith(PREFIX)}
    assert markers == {
        "nightly",
        "benchmark",
        *(f"{PREFIX}{extra}".replace("-", "_") for extra in extras),
    }
    assert extras <= set(declared["project"]["optional-dependencies"])
    section = SECTIONS["What a change has to pass"]
    assert set(re.findall(r"-m (\w+)", section)) >= {"nightly", "benchmark"}
    assert extras <= set(re.findall(r"`([\w-]+)`", section))
