"""Commands of external programs, in the order of arrival."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

CommandKind = Literal["trajectory", "gripper", "cancel", "scene", "plan", "end"]


@dataclass(frozen=True)
class CommandRecord:
    """One command and the moment of simulated time at which it took effect.

    Attributes:
        sample: Index of the physics sample after which it took effect; this orders a replay.
        time: Simulated time of that sample [s].
        kind: What it is; `scene` changes the planning scene, `plan` is a request to plan and has no
            effect, `end` is the end of a launched program or of the session.
        controller: The controller that it addresses, such as `arm_controller`.
        goal: The goal's identifier in hex; empty for what came on a topic.
        answer: The immediate result: `accepted`, or why not; of a plan, what became of it.
        summary: What the program requests, for people.
        result: What became of a goal, and when; empty where nothing ended, or it has no result.
        has_failed: Whether it was refused, or did not do what it requests.
    """

    sample: int
    time: float
    kind: CommandKind
    controller: str = ""
    goal: str = ""
    content: Mapping[str, Any] = field(default_factory=dict[str, Any])
    answer: str = ""
    summary: str = ""
    result: str = ""
    has_failed: bool = False
