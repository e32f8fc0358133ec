"""Suites as plain data, for the files that are written of them."""

import random

from harness.core.errors import Problem
from harness.recording.verdict import Measure, Verdict
from harness.reporting.result import CaseResult, StepLine
from harness.reporting.sampled import SampledRate
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from tests.suite.samples import rate_of

HOSTILE = "</td><script>document.title = 'taken over'</script>'\"& \x07 ]]>"


def verdict(value, limit=0.05):
    status = "passed" if value >= limit else "failed"
    measure = Measure("height", value, limit, ">=", "m", 2.0)
    why = "" if status == "passed" else f"{value * 1000:.0f} mm"
    return Verdict(
        "lifted cube", status, value - limit, "m", 2.0, line=9, reason=why, measures=(measure,)
    )


def passed(number, value=0.06):
    return CaseResult("a/pick.scenario.yaml", f"c{number}", "Pick", "passed", "d" * 64, number, 9.0,
                      verdicts=(verdict(value),), wall_times={"plan": 0.25})  # fmt: skip


def failed(number, value=0.03):
    return CaseResult("a/pick.scenario.yaml", f"c{number}", "Pick", "failed", "e" * 64, number, 9.0,
                      "a/pick/c1", "a/pick/c1/report.html",
                      verdicts=(verdict(0.07), verdict(value)))  # fmt: skip


STUCK = CaseResult(
    "b/place.scenario.yaml", "", "Place", "failed", "f" * 64, 3, 4.0,
    steps=(StepLine("go", "move_to", "move_to far", "failed", "NO_IK_SOLUTION", "out, by 9 mm",
                    line=7),),
)  # fmt: skip
INVALID = CaseResult(
    "c/typo.scenario.yaml", "", "typo.scenario.yaml", "invalid",
    problems=(Problem("c/typo.scenario.yaml", 3, 5, "no verb is called `pikc`", "did you mean"),),
)  # fmt: skip
BROKEN = CaseResult(f"d/{HOSTILE}.scenario.yaml", HOSTILE, HOSTILE, "error", message=HOSTILE)


def small_suite():
    """One of every outcome."""
    rate = rate_of([True] * 8 + [False] * 2, 0.9, 0.95, stop_early=False)
    cases = [
        SuiteCase(passed(0), {"height": "5 cm"}, ("ur", "lesson"), ("REQ-7",)),
        SuiteCase(failed(1), {"height": "9 cm"}, ("ur",)),
        SuiteCase(STUCK),
        SuiteCase(INVALID),
        SuiteCase(BROKEN, {}, (HOSTILE,)),
    ]
    return SuiteRecord("error", cases, [SampledRate("a/pick.scenario.yaml", "", rate, "failed")])


def large_suite(count):
    rng = random.Random(4)
    values = [rng.uniform(0.04, 0.12) for _ in range(count)]
    made = [passed(i, v) if v >= 0.05 else failed(i, v) for i, v in enumerate(values)]
    return SuiteRecord("failed", [SuiteCase(each, {}, ("ur",)) for each in made])
