"""A failed step's explanation as lines of text."""

from __future__ import annotations

from harness.core.details import Details
from harness.recording.explanation import recorded_explanation

INDENT = "    "


def explanation_lines(explanation: Details, message: str = "") -> tuple[str, ...]:
    """The stages in order, what to do, and where the picture is; what there is of them.

    Args:
        message: The message of the failure; a stage does not repeat it.
    """
    lines: list[str] = []
    found = recorded_explanation(explanation)
    for stage in found.stages or ():
        text = "" if stage.text == message else stage.text
        if stage.status == "skipped":
            text = f"skipped, {text}" if text else "skipped"
        lines.append(": ".join(part for part in (stage.stage, stage.code, text) if part))
        lines += [f"{INDENT}{detail}" for detail in stage.details]
    if found.advice:
        lines.append(f"what to do: {found.advice}")
    if found.picture and found.nearest is not None:
        lines.append(f"picture: {found.picture} ({found.nearest.shows})")
    return tuple(lines)
