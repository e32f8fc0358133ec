"""What a test of inverse kinematics found, as plain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.strategies.poses import Target
from harness.strategies.tasks import Task


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
        """As JSON has it."""
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
    """What became of a property.

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
        link: The link that the function placed.
        joint_names: The joint names in the order of its answers.
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
        """As JSON has it; times of the wall clock apart."""
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
