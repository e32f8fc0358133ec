"""Sentences about commands of external programs, for people."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.core.printable import counted
from harness.plugins.ros.control.controller import Outcome
from harness.recording.commands import CommandKind

MOST_CHANGES = 5  # changes of the planning scene that one sentence names


def summary_of(kind: CommandKind, content: Mapping[str, Any]) -> str:
    """What a command requests."""
    if kind == "trajectory":
        points = content["points"]
        duration = points[-1]["time"] if points else 0.0
        when = f"in {duration:.2f} s" if duration else "at once"
        return f"trajectory of {counted(len(points), 'point')} {when}"
    if kind == "gripper":
        effort = f", at most {content['max_effort']:.4g} N" if content["max_effort"] else ""
        return f"to {content['position']:.4g}{effort}"
    if kind == "scene":
        changes = [" ".join([each["change"], each.get("name", "")]) for each in content["changes"]]
        more = [f"{len(changes) - MOST_CHANGES} more"] if len(changes) > MOST_CHANGES else []
        return f"planning scene: {', '.join([*changes[:MOST_CHANGES], *more]).strip()}"
    if kind == "plan":
        return f"plan for {content['group']}{content.get('motion', '')}"
    if kind == "end":
        code = f", exit code {content['code']}" if "code" in content else ""
        return f"end: {content['reason']}{code}"
    return kind


def result_of(outcome: Outcome) -> str:
    """What became of a goal."""
    if getattr(outcome.result, "stalled", False):
        return "stalled on something"
    default = "succeeded" if outcome.has_succeeded else "did not succeed"
    return getattr(outcome.result, "error_string", "") or default
