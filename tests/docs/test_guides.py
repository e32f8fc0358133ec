"""The `harness` commands of guides, carried out in a folder with the files that they name.

Pages whose outputs are printed into them have tests of their own (`test_examples.py`), and so have
the course, the README, [another arm](../packages) and the words of plug-ins.
"""

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from docs import ROOT
from docs.generate import GENERATED
from docs.generators.examples import comparable
from harness.recording.read_run import read_run
from tests.commands import harness
from tests.docs.test_examples import (
    EVERY_PAGE,
    PAGES,
    blocks,
    every_command,
    harness_commands,
    page_id,
)
from tests.plugins.grading.recordings import SCENARIO, students_recording

PICK = """\
scenario: A cylinder is near
robot: {model: open_manipulator_x}
tags: [pick]
params: {friction: 0.5, wait: 0.1 s}
objects: [{name: can, cylinder: {radius: 0.03, length: 0.1}, friction: "${friction}",
           pose: {xyz: [0.3, 0, 0.05]}, mass: 0.1}]
steps: [{wait: "${wait}"}]
expect: [{duration: {at_most: 0.15 s}, name: quick}]
"""
SAMPLED = PICK + "randomize: {friction: {uniform: [0.2, 1.2]}, wait: {uniform: [0.05 s, 0.2 s]}}\n"
WAITS = "scenario: Wait\nrobot: {model: open_manipulator_x}\nsteps: [{wait: 0.1 s}]\n"
EXPECT = "expect: [{always: within_limits}]\n"
ENVIRONMENT = {
    "CI_NODE_INDEX": "2",
    "CI_NODE_TOTAL": "2",
    "PYTHONPATH": str(ROOT),
    "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]),
}

ELSEWHERE = {
    "README.md": "tests/system/test_packaging.py and tests/plugins/iktest",
    "docs/guides/bring_your_own_arm.md": "tests/packages/test_bring_your_own_arm.py",
    "docs/guides/extending.md": "the tests that read its code blocks, with its plug-ins",
    "docs/guides/ik_test.md": "tests/system/test_ik_test.py, as it takes a minute",
}
"""Pages whose commands other tests run."""

CANNOT_RUN = {
    ("--object", "green_cylinder=/cylinder/pose"): "tests/plugins/grading/test_recorded_frames.py",
    ("--on", "ray"): "needs the extra `cluster`; tests/plugins/campaigns/cluster runs it",
    ("--on", "ray://10.0.0.5:10001"): "needs a cluster at that address",
    ("--robot", "ros2"): "needs a robot",
    ("bridge",): "serves until it is interrupted",
    ("studio",): "serves until it is interrupted",
    ("run", "open_manipulator_x_by_hand.scenario.yaml"): "the studio saves this file",
    ("--node", "python my_moveit_client.py"): "the reader's own file",
}
"""Words of commands that are not carried out, and why."""

BY_THE_SHELL = ("mkdir", "cp", "pytest")
"""Other programs of guides that are started too, and `python -m pytest` in the reader's folder."""

IN_PLACE = {"1000": "20", "100": "40", "student_bag": "student_bag.mcap"}
"""Numbers of samples and runs, which a test reduces, and a bag of one file."""


def files_of(page, folder, recorded_run):
    """Write what the commands of a page name; the reader has such files."""
    (folder / "history").mkdir()
    (folder / "scenarios").mkdir()
    for name, text in {"a": WAITS + EXPECT, "b": SAMPLED + "samples: 3\n"}.items():
        (folder / f"scenarios/{name}.scenario.yaml").write_text(text)
    (folder / "pick.scenario.yaml").write_text(SAMPLED)
    (folder / "typo.scenario.yaml").write_text(WAITS.replace("wait:", "weit:"))
    shutil.copy(ROOT / "tests/plugins/ros/lift_the_box.py", folder / "student.py")
    if page.name == "grading.md":
        recording = students_recording(read_run(recorded_run(SCENARIO) / "run").run)
        recording.write(folder / "student_bag.mcap")
    if page.name == "reports.md":
        for day in ("yesterday", "today"):
            words = ("run", "scenarios/a.scenario.yaml", "--report-dir", folder / "made" / day)
            assert harness(*words, cwd=folder).returncode == 0
            [run] = (folder / "made" / day).rglob("run.json")
            shutil.copytree(run.parent, folder / "reports" / day / "pick")


GUIDES = [
    page
    for page in EVERY_PAGE
    if page not in PAGES
    and page_id(page) not in ELSEWHERE
    and "docs/course" not in page_id(page)
    and any(True for _ in harness_commands(page))
]


def outputs(page):
    """The output that a page shows of a command, by its words; `...` stands for more lines."""
    for block in blocks(page):
        if block["text"].startswith("$ harness ") and page_id(page) not in GENERATED:
            command, _, printed = block["text"].partition("\n")
            yield tuple(shlex.split(command)[2:]), printed


@pytest.mark.nightly(but=["docs/reference/commands.md"])
@pytest.mark.parametrize("page", GUIDES, ids=page_id)
def test_the_commands_of_a_guide_run(page, tmp_path, recorded_run):
    files_of(page, tmp_path, recorded_run)
    shown = dict(outputs(page))
    for words in every_command(page):
        if words[0] != "harness":
            carried_out_by_the_shell(words, tmp_path)
            continue
        words = words[1:]
        if any(set(each) <= set(words) for each in CANNOT_RUN):
            continue
        parts = shown.get(tuple(words), "").split("...\n")
        words = [IN_PLACE.get(word, word) for word in words]
        done = harness(*words, cwd=tmp_path, **ENVIRONMENT)
        expected = (2,) if "typo.scenario.yaml" in words else (0, 1)
        assert done.returncode in expected, f"{shlex.join(words)}\n{done.stdout}\n{done.stderr}"
        assert "Traceback" not in done.stdout + done.stderr, words
        for part in parts:
            assert comparable(part) in comparable(f"{done.stdout}{done.stderr}"), words


def carried_out_by_the_shell(words, folder):
    """Run a command of another program; not one of the clone, or of a program of others."""
    is_pytest = words[1:3] == ["-m", "pytest"] and "tests/" not in " ".join(words)
    if not is_pytest and words[0] not in BY_THE_SHELL:
        return
    command, environment = " ".join(words), {**os.environ, **ENVIRONMENT}
    done = subprocess.run(
        ["bash", "-c", command], cwd=folder, env=environment, capture_output=True, check=False
    )
    assert done.returncode in ((0, 1) if is_pytest else (0,)), (command, done.stdout, done.stderr)


def test_every_reason_not_to_run_a_command_is_still_needed():
    known = [words for page in GUIDES for words in harness_commands(page)]
    for reason in CANNOT_RUN:
        assert any(set(reason) <= set(words) for words in known), reason
    assert ELSEWHERE.keys() <= {page_id(page) for page in EVERY_PAGE}
