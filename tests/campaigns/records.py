"""The record of all campaigns, from which docs/explanation/reliability.md is made."""

from __future__ import annotations

import fcntl
import json
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from tests.campaigns.execution import Outcome

RECORDS = Path(__file__).with_name("records.json")


def read_records() -> dict[str, Any]:
    """Counts of each reader, and each run of the campaigns."""
    return json.loads(RECORDS.read_text(encoding="utf-8"))


def change(edit: Callable[[dict[str, Any]], None]) -> None:
    """Edit the record while no other process does."""
    with RECORDS.open("r+", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        known = json.loads(file.read())
        edit(known)
        file.seek(0)
        file.truncate()
        file.write(json.dumps(known, indent=1, sort_keys=True) + "\n")


def count(name: str, found: Outcome, seed: int, *, is_guided: bool) -> None:
    """Add the counts of one reader's campaign."""

    def edit(known: dict[str, Any]) -> None:
        total = known["readers"].setdefault(name, {})
        for key, value in _counts(found).items():
            total[key] = total.get(key, 0) + value
        total["guided"] = total.get("guided", 0) + found.executions * is_guided
        total["peak_megabytes"] = max(total.get("peak_megabytes", 0), found.peak_megabytes)
        day = datetime.now(UTC).date().isoformat()
        run = {"date": day, "seed": seed, "guided": is_guided}
        same = [each for each in known["campaigns"] if run.items() <= each.items()]
        if not same:
            same = [run]
            known["campaigns"].append(run)
        for key, value in {**_counts(found), "readers": 1}.items():
            same[0][key] = same[0].get(key, 0) + value

    change(edit)


def count_scenarios(ends: Mapping[str, int]) -> None:
    """Add how many drawn scenarios ended how."""

    def edit(known: dict[str, Any]) -> None:
        total = known.setdefault("scenarios", {})
        for end, number in ends.items():
            total[end] = total.get(end, 0) + number

    change(edit)


def count_attacks(name: str, tries: int, seconds: float, findings: int) -> None:
    """Add the counts of an attack on commands; a finding counts each time it is met."""

    def edit(known: dict[str, Any]) -> None:
        total = known.setdefault("attacks", {}).setdefault(name, {})
        for key, value in (("tries", tries), ("seconds", round(seconds)), ("findings", findings)):
            total[key] = total.get(key, 0) + value
        total["date"] = datetime.now(UTC).date().isoformat()

    change(edit)


def count_tests(path: str, ends: Mapping[str, int], *, is_exhaustive: bool) -> None:
    """Set how many tests of a promise's file or folder ended how."""
    day = datetime.now(UTC).date().isoformat()
    last: dict[str, Any] = {"date": day} | ({"exhaustive": True} if is_exhaustive else {})
    last |= {end: number for end, number in ends.items() if number}
    change(lambda known: known.setdefault("promises", {}).update({path: last}))


def _counts(found: Outcome) -> dict[str, int]:
    return {
        "executions": found.executions,
        "refused": found.refused,
        "seconds": round(found.seconds),
        "findings": len(found.findings),
    }
