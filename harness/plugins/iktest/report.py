"""What a test of inverse kinematics found, and the folder with its numbers and pictures."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.files import write_whole
from harness.core.types import FloatArray
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.strategies.poses import Target
from harness.plugins.iktest.strategies.tasks import Task
from harness.reporting.json_text import json_text
from harness.suite.discovery import UsageError


@dataclass(frozen=True, eq=False)
class IkFinding:
    """A way in which a function is wrong, with its smallest example.

    Attributes:
        property: Name of the property that it breaks.
        kind: What it does, in words.
        answer: Joint positions that came back, or None.
        reached: Pose of the link there, shape (7,), xyz and quat wxyz; None without an answer.
        picture: Name of its file in the report folder; empty without one.
    """

    number: int
    property: str
    kind: str
    detail: str
    shown: int
    tried: int
    call: str
    target: Target
    answer: FloatArray | None
    reached: FloatArray | None
    picture: str = ""

    def facts(self) -> dict[str, Any]:
        """The finding as JSON data."""
        way = self.target.joint_positions
        return {
            "number": self.number,
            "property": self.property,
            "kind": self.kind,
            "detail": self.detail,
            "shown": self.shown,
            "tried": self.tried,
            "call": self.call,
            "asked": self.target.pose.as_vector().tolist(),
            "asked_joint_positions": None if way is None else way.tolist(),
            "answer": None if self.answer is None else _plain(self.answer),
            "reached": None if self.reached is None else _plain(self.reached),
            "picture": self.picture,
        }


@dataclass(frozen=True)
class PropertyResult:
    """The result of a property.

    Attributes:
        observed: Cases in which the function did what the property is about.
        findings: Numbers of the findings that they show, those of earlier properties included.
        note: Why it was not tried; else empty.
    """

    name: str
    says: str
    tried: int = 0
    flawed: int = 0
    observed: int = 0
    findings: tuple[int, ...] = ()
    note: str = ""


@dataclass(frozen=True)
class Speed:
    """Wall time of calls for targets within reach, reported and never judged [s]."""

    median: float
    slow: float
    slowest: float
    calls: int


@dataclass(frozen=True, eq=False)
class IkReport:
    """A function, tested.

    Attributes:
        home: Where examples are shrunk to, shape (dof,).
        seconds: Wall time of all.
    """

    solver: str
    robot: str
    task: Task
    link: str
    joint_names: tuple[str, ...]
    home: FloatArray
    properties: tuple[PropertyResult, ...]
    findings: tuple[IkFinding, ...]
    speed: Speed | None
    seed: int
    seconds: float

    @property
    def has_passed(self) -> bool:
        """Whether nothing was found and every property was observed."""
        return all(each.observed for each in self.properties) and not self.findings

    def facts(self) -> dict[str, Any]:
        """The report as JSON data; times of the wall clock are separate."""
        return {
            "format": "armharness-ik-test/1",
            "solver": self.solver,
            "robot": self.robot,
            "task": self.task,
            "link": self.link,
            "joint_names": list(self.joint_names),
            "home": self.home.tolist(),
            "seed": self.seed,
            "outcome": "passed" if self.has_passed else "failed",
            "properties": [
                {"name": each.name, "says": each.says, "tried": each.tried, "flawed": each.flawed,
                 "observed": each.observed, "findings": list(each.findings), "note": each.note}
                for each in self.properties
            ],
            "findings": [finding.facts() for finding in self.findings],
            "wall_times": {
                "total": self.seconds,
                "call": None if self.speed is None else vars(self.speed),
            },
        }  # fmt: skip


def _plain(values: FloatArray) -> list[float | None]:
    """Numbers for JSON, which has no NaN."""
    return [float(value) if np.isfinite(value) else None for value in values]


FILE = "ik_test.json"


def write_ik_report(report: IkReport, chain: Chain, folder: Path) -> IkReport:
    """Write a report; findings of an earlier one in the folder are replaced.

    Returns:
        The report, its findings with the names of their pictures.

    Raises:
        UsageError: The folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for old in folder.glob("finding-*.jpg"):
            old.unlink()
    except OSError as error:
        raise UsageError(f"cannot write '{error.filename}': {error.strerror}") from error
    findings = tuple(_with_picture(finding, chain, folder) for finding in report.findings)
    report = replace(report, findings=findings)
    write_whole(folder / FILE, json_text(report.facts()))
    return report


def _with_picture(finding: IkFinding, chain: Chain, folder: Path) -> IkFinding:
    """Draw the arm where its answer puts it, translucent where the target is reached."""
    from harness.plugins.iktest.comparison_picture import draw_ik_comparison

    target, answer = finding.target, finding.answer
    reached = answer if answer is not None and np.all(np.isfinite(answer)) else None
    if target.joint_positions is None and reached is None:
        reached = chain.home
    name = f"finding-{finding.number}-{finding.property}.jpg"
    draw_ik_comparison(
        chain.description,
        chain.link,
        target.pose,
        None if target.joint_positions is None else chain.whole(target.joint_positions),
        None if reached is None else chain.whole(reached),
        folder / name,
        f"{finding.kind}: {finding.detail}" if finding.detail else finding.kind,
    )
    return replace(finding, picture=name)
