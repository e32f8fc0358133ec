"""Saved runs that were written over, and environments in which a run must go on as ever."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path

import numpy as np

from harness.cli.main import main
from harness.recording.read_run import read_run
from tests.running import run_case

SHORT = """scenario: an arm that stays where it is
robot: {model: %s}
steps: [{wait: 50 ms}]
expect:
  - joints: {positions: {%s: 1.2}}
"""
ROBOTS = {"open_manipulator_x": "joint1", "ur3e": "shoulder_pan_joint"}


def saved_run(folder: Path, robot: str = "open_manipulator_x") -> Path:
    """The folder of a run whose one expectation fails."""
    path = folder / f"{robot}.scenario.yaml"
    path.write_text(SHORT % (robot, ROBOTS[robot]))
    report = folder / f"{robot}_report"
    result = run_case(path, report_dir=report, stills=False, page=False)
    assert result.outcome == "failed", (result.problems, result.message)
    return report


def document(report: Path) -> dict:
    """What run.json holds."""
    return json.loads((report / "run.json").read_text(encoding="utf-8"))


def with_passed_verdict(report: Path) -> None:
    """The outcome and the verdict of run.json are another one."""
    content = document(report)
    content["outcome"] = content["verdicts"][0]["status"] = "passed"
    (report / "run.json").write_text(json.dumps(content), encoding="utf-8")


def with_other_positions(report: Path) -> None:
    """The joint is recorded where it should be, and run.json says that it is."""
    with np.load(report / "signals.npz") as file:
        signals = dict(file)
    signals["joint_positions"][:, 0] = 1.2
    np.savez(report / "signals.npz", **signals)
    with_passed_verdict(report)


def with_other_digest(report: Path) -> None:
    """And the digest in run.json is that of what the folder holds now."""
    with_other_positions(report)
    content = document(report)
    content["digest"] = read_run(report).content_digest
    (report / "run.json").write_text(json.dumps(content), encoding="utf-8")


@dataclass(frozen=True)
class FolderScene:
    """A run's folder, and what `harness judge` or `harness compare` says of it.

    Attributes:
        title: What it is.
        change: What is done to a copy of the folder.
        naive: A check of the folder's own words, in words.
        is_fooled: That check.
        said: Part of what is said; empty where nothing may be said of changes.
        other: The robot of a run that it is compared with; empty for `harness judge`.
    """

    title: str
    change: Callable[[Path], None]
    naive: str
    is_fooled: Callable[[Path], bool]
    said: str
    other: str = ""


def says_passed(report: Path) -> bool:
    """The outcome as run.json states it."""
    return document(report)["outcome"] == "passed"


CHANGED = "were changed after the run was written"
EDITED = "was changed after the run was written: the checksum differs"
FOLDERS = (
    FolderScene("verdict turned round", with_passed_verdict, "run.json says `passed`",
                says_passed, CHANGED),
    FolderScene("recorded positions written over", with_other_positions,
                "run.json says `passed`, and the signals show the joint at its goal",
                says_passed, CHANGED),
    FolderScene("digest written over as well", with_other_digest,
                "run.json says `passed`, and its digest is that of the folder",
                says_passed, EDITED),
    FolderScene("folder that was moved", lambda _: None, "its time stamps are new: too strict",
                lambda report: not says_passed(report), ""),
    FolderScene("run of another robot", lambda _: None, "both are runs of one scenario",
                lambda report: not says_passed(report), "open_manipulator_x -> ur3e",
                other="ur3e"),
)  # fmt: skip


def report_on(scene: FolderScene, runs: Mapping[str, Path], folder: Path) -> tuple[Path, str]:
    """The changed copy of a run, and what the command says of it."""
    report = folder / scene.title.replace(" ", "_")
    shutil.copytree(runs["open_manipulator_x"], report)
    scene.change(report)
    second = [str(runs[scene.other])] if scene.other else []
    text = StringIO()
    with redirect_stdout(text):
        main(["compare" if second else "judge", str(report), *second])
    return report, text.getvalue()


@dataclass(frozen=True)
class EnvironmentScene:
    """Variables of an environment in which `harness run` goes on as in any other."""

    title: str
    variables: Mapping[str, str] = field(default_factory=dict)

    def exit_code(self, folder: Path) -> int:
        """Of `harness run` of a scenario that fails: 1, and nothing on standard error."""
        path = folder / "short.scenario.yaml"
        path.write_text(SHORT % ("ur3e", ROBOTS["ur3e"]))
        done = subprocess.run(
            [sys.executable, "-m", "harness.cli", "run", path.name, "--no-report"],
            cwd=folder, capture_output=True, check=False, env={**os.environ, **self.variables},
        )  # fmt: skip
        assert not done.stderr, done.stderr
        return done.returncode


ENVIRONMENTS = (
    EnvironmentScene("ASCII alone", {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}),
    EnvironmentScene("locale that is not installed", {"LC_ALL": "de_DE.ISO-8859-1"}),
    EnvironmentScene("graphics library that is missing", {"MUJOCO_GL": "osmesa"}),
    EnvironmentScene("environment as it is"),
)
