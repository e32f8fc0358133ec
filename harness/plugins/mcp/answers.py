"""What an assistant reads: the parts of long documents that help it to go on."""

from __future__ import annotations

import re
from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any

from harness.plugins.mcp.workspace import RefusedError

REFERENCE = "#/$defs/"
CASE_KEYS = ("file", "case", "title", "outcome", "message", "problems", "notes", "seed", "sim_time",
             "digest", "report_dir", "values")  # fmt: skip
STEP_KEYS = ("id", "summary", "line", "status", "error_code", "message", "explanation")
VERDICT_KEYS = ("expectation", "status", "margin", "unit", "time", "line", "reason")


def schema_of(schema: Mapping[str, Any], name: str) -> dict[str, Any]:
    """The part of the scenario's schema that has a name, with the definitions that it refers to.

    Raises:
        RefusedError: There is no such step, expectation or key.
    """
    properties, definitions = schema["properties"], schema["$defs"]
    if not name:
        return {key: value.get("description", "") for key, value in properties.items()}
    parts = {**_named(definitions), **definitions, **properties}
    if name not in parts:
        known = get_close_matches(name, parts, n=3, cutoff=0) or list(properties)
        raise RefusedError(f"nothing is called '{name}' in a scenario; near: {', '.join(known)}")
    part = parts[name]
    return {**part, "$defs": {key: definitions[key] for key in _reached(part, definitions)}}


def _named(definitions: Mapping[str, Any]) -> dict[str, Any]:
    """Steps and expectations by the words that a scenario has for them: `MoveTo` is `move_to`."""
    return {
        re.sub(r"(?<=[a-z])(?=[A-Z])", "_", key).lower(): value
        for key, value in definitions.items()
    }


def _reached(part: Any, definitions: Mapping[str, Any]) -> list[str]:
    """Names of the definitions that a part refers to, also through others, but for steps."""
    found: list[str] = []
    waiting = [part]
    while waiting:
        value = waiting.pop()
        if isinstance(value, dict):
            name = str(value.get("$ref", "")).removeprefix(REFERENCE)
            if name in definitions and name not in found and name not in ("Step", "Expectation"):
                found.append(name)
                waiting.append(definitions[name])
            waiting += value.values()
        elif isinstance(value, list):
            waiting += value
    return sorted(found)


def case_facts(case: Mapping[str, Any]) -> dict[str, Any]:
    """A case of `harness run --json` without what passed in detail: most of a model's window."""
    steps = [
        {key: step[key] for key in STEP_KEYS if step[key]}
        for step in case["steps"]
        if step["status"] != "passed"
    ]
    verdicts = [
        {key: verdict[key] for key in VERDICT_KEYS if verdict[key] not in ("", None)}
        for verdict in case["verdicts"]
    ]
    facts = {key: case[key] for key in CASE_KEYS if case[key] not in ("", [], {}, None)}
    ids = [step["id"] for step in case["steps"]]
    return {**facts, "step_ids": ids, "steps_not_passed": steps, "verdicts": verdicts}
