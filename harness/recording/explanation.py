"""Why a motion was not found: the stages of planning in order, and what became of each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, cast

StageName = Literal["reach", "inverse kinematics", "start state", "path", "time parameterisation"]
StageStatus = Literal["passed", "failed", "not reached"]

STAGES: tuple[StageName, ...] = (
    "reach",
    "inverse kinematics",
    "start state",
    "path",
    "time parameterisation",
)
"""In the order in which they are reported."""


@dataclass(frozen=True)
class Stage:
    """One stage of planning a motion.

    Attributes:
        name: The name of the stage.
        status: The outcome of the stage.
        text: The result in one sentence, with its numbers.
        code: Its failure's name in moveit_msgs/MoveItErrorCodes; empty unless it failed.
        details: A line each: an inverse kinematics' branch and what removed it, a pair too near.
    """

    name: StageName
    status: StageStatus
    text: str
    code: str = ""
    details: tuple[str, ...] = ()

    def plain(self) -> dict[str, Any]:
        """As plain data for a step's record."""
        return {
            "stage": self.name,
            "status": self.status,
            "code": self.code,
            "text": self.text,
            "details": list(self.details),
        }


def stages_of(explanation: Mapping[str, Any]) -> tuple[Stage, ...]:
    """The stages in a step's explanation; none where it has none."""
    entries = cast(Iterable[Mapping[str, Any]], explanation.get("stages", ()))
    return tuple(
        Stage(
            name=entry["stage"],
            status=entry["status"],
            text=str(entry["text"]),
            code=str(entry["code"]),
            details=tuple(map(str, entry["details"])),
        )
        for entry in entries
    )
