"""A failed step's explanation as lines of text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.recording.explanation import stages_of

INDENT = "    "


def explanation_lines(explanation: Mapping[str, Any], message: str = "") -> tuple[str, ...]:
    """The stages in order, what to do, and where the picture is; what there is of them.

    Args:
        explanation: The explanation of a step's record.
        message: What was said of the failure already; a stage does not repeat it.
    """
    lines: list[str] = []
    for stage in stages_of(explanation):
        text = "" if stage.text == message else stage.text
        if stage.status == "not reached":
            text = f"not reached, {text}" if text else "not reached"
        lines.append(": ".join(part for part in (stage.name, stage.code, text) if part))
        lines += [f"{INDENT}{detail}" for detail in stage.details]
    if explanation.get("advice"):
        lines.append(f"what to do: {explanation['advice']}")
    if explanation.get("picture"):
        lines.append(f"picture: {explanation['picture']} ({explanation['nearest']['shows']})")
    return tuple(lines)
