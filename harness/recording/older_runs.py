"""Runs of an older version of run.json, in the words of the present one."""

from __future__ import annotations

from typing import Any, cast

FORMAT = "armharness-run/2"
KNOWN_FORMATS = ("armharness-run/1", FORMAT)

STEP_STATUS = {"not_reached": "not reached", "expected_error": "expected error"}
"""Status of a step in the first format, and since."""

STAGE_STATUS = {"not reached": "skipped"}
"""Status of a stage of planning in the first format, and since."""


def in_present_words(document: dict[str, Any]) -> dict[str, Any]:
    """A run or a result, as plain data, with the status words of the present format.

    What fits neither format is left unchanged: reading it reports that.
    """
    steps = document.get("steps")
    if not isinstance(steps, list):
        return document
    return {**document, "steps": [_step(each) for each in cast("list[Any]", steps)]}


def _step(step: Any) -> Any:
    if not isinstance(step, dict):
        return step
    present = _with_status(cast("dict[str, Any]", step), STEP_STATUS)
    explanation: Any = present.get("explanation")
    if not isinstance(explanation, dict) or not isinstance(explanation.get("stages"), list):  # pyright: ignore[reportUnknownMemberType]
        return present
    known = cast("dict[str, Any]", explanation)
    stages = [
        _with_status(cast("dict[str, Any]", each), STAGE_STATUS) if isinstance(each, dict) else each
        for each in cast("list[Any]", known["stages"])
    ]
    return {**present, "explanation": {**known, "stages": stages}}


def _with_status(content: dict[str, Any], words: dict[str, str]) -> dict[str, Any]:
    status = content.get("status")
    if not isinstance(status, str) or status not in words:
        return content
    return {**content, "status": words[status]}
