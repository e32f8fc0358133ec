"""The share of its points that an expectation earns which holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.plugins.grading.assignment import PropertyName
from harness.recording.verdict import Verdict
from harness.reporting.result import CaseResult

REACHES = "reaches"
"""The property of `ik-test` that counts right answers."""


@dataclass(frozen=True)
class Credit:
    """How much of its points an expectation earns that holds.

    Attributes:
        reason: Why that is not all of them; empty where it is.
    """

    share: float = 1.0
    reason: str = ""

    @property
    def notes(self) -> tuple[str, ...]:
        """One sentence where points are missing of what holds; else none."""
        return (f"what holds {self.reason}",) if self.reason else ()


FULL = Credit()


@dataclass(frozen=True)
class GradedResult(CaseResult):
    """The result of a case, and what its verdicts earn."""

    credit: Credit = FULL


def credit_of_run(*, is_idle: bool, is_full: bool) -> Credit:
    """Nothing for what holds because nothing moved, such as `never: collision`.

    Args:
        is_idle: Whether the robot stood still.
        is_full: Whether every expectation holds and no step failed: then no motion was required.
    """
    if is_full or not is_idle:
        return FULL
    return Credit(0.0, "earns nothing, as the robot did not move")


def credit_of_function(document: Mapping[str, Any]) -> Credit:
    """The share of the targets within reach that a function of inverse kinematics answers rightly.

    Args:
        document: The content of `ik_test.json`.
    """
    found = [each for each in document["properties"] if each["name"] == REACHES]
    tried = sum(each["tried"] for each in found)
    right = sum(each["observed"] - each["flawed"] for each in found)
    if right == tried > 0:
        return FULL
    text = f"{right} of {tried} targets within reach are answered rightly"
    return Credit(right / tried if tried else 0.0, text)


def property_verdicts(
    document: Mapping[str, Any], weights: Mapping[PropertyName, float]
) -> tuple[Verdict, ...]:
    """The properties of `ik_test.json` as verdicts, with the points that each is worth.

    Args:
        document: The content of `ik_test.json`.
        weights: Points by the name of a property; 1 for one that is not there.
    """
    findings = {each["number"]: each for each in document["findings"]}
    return tuple(
        _verdict(each, findings, weights.get(each["name"], 1.0)) for each in document["properties"]
    )


def _verdict(each: Mapping[str, Any], findings: Mapping[int, Any], points: float) -> Verdict:
    shown = [findings[number] for number in each["findings"]]
    if each["observed"] and not each["flawed"]:
        return Verdict(each["says"], "passed", points=points)
    first = next((finding["kind"] for finding in findings.values()), "was not tried enough")
    reason = each["note"] or f"no case showed it: the function {first}"
    if shown:
        what = ": ".join(filter(None, (shown[0]["kind"], shown[0]["detail"])))
        reason = f"{what}; in {each['flawed']} of {each['tried']} cases, as {shown[0]['call']}"
    return Verdict(each["says"], "failed", reason=reason, points=points)
