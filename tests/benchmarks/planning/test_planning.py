"""Planning on meshed arms, in seven families, against OMPL as people use it from Python."""

import statistics
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from tests.benchmarks.planning.contenders import Outcome, is_free, naive, ours
from tests.benchmarks.planning.layouts import FAMILIES
from tests.benchmarks.planning.problems import SCALE, Problem, make_problem
from tests.installed import is_installed

EACH = 5
"""Problems of each family for each arm: 70."""

NAIVE_EACH = 2
"""Those of them that the naive planner gets, 28: it takes minutes where the others take seconds."""

CONTENDERS: dict[str, Callable[[Problem], Outcome]] = {
    "naive": naive,
    "plain": lambda problem: ours(problem, "never"),
    "compiled": lambda problem: ours(problem, "always"),
}
if is_installed("roboplan"):
    from tests.benchmarks.planning.roboplan_contender import roboplan, roboplan_verified

    CONTENDERS |= {"roboplan": roboplan, "roboplan, verified": roboplan_verified}
HEADS = (
    *("who", "solved", "free", "checks/s", "scene ms", "plan ms", "95 %", "total ms", "95 %"),
    *("rad", "ratio"),
)
"""Ratios are the naive planner's median plan, its 95 %, and its median total over those of a
contender on the same problems."""


@pytest.fixture(scope="module")
def outcomes() -> dict[str, list[tuple[Problem, Outcome]]]:
    """The result of every contender on every problem, in turns; warm-up left out."""
    for model in SCALE:
        for name in ("plain", "compiled"):
            CONTENDERS[name](make_problem(model, "box", 0))
    found: dict[str, list[tuple[Problem, Outcome]]] = {name: [] for name in CONTENDERS}
    for model in SCALE:
        for family in FAMILIES:
            for number in range(EACH):
                problem = make_problem(model, family, number)
                for name, contender in CONTENDERS.items():
                    if name == "naive" and number >= NAIVE_EACH:
                        continue
                    found[name].append((problem, contender(problem)))
    return found


@pytest.mark.benchmark
def test_planning_on_meshes_against_naive_ompl(outcomes, print_row):
    heading = f"{len(outcomes['plain'])} problems on meshes, ms of CPU time"
    print_row(heading, *HEADS)
    for name, results in outcomes.items():
        print_row(heading, name, *_cells(results, outcomes["naive"]))
    for family in FAMILIES:
        heading = f"{family}, ms of CPU time"
        print_row(heading, *HEADS)
        base = [pair for pair in outcomes["naive"] if pair[0].family == family]
        for name, results in outcomes.items():
            print_row(heading, name, *_cells([r for r in results if r[0].family == family], base))
    plain, compiled = outcomes["plain"], outcomes["compiled"]
    for (problem, first), (_, second) in zip(plain, compiled, strict=True):
        assert (first.waypoints is None) == (second.waypoints is None), problem.name
        if first.waypoints is not None:
            assert np.array_equal(first.waypoints, second.waypoints), problem.name
            assert first.checks == second.checks, problem.name


@pytest.mark.benchmark
@pytest.mark.skipif(not is_installed("roboplan"), reason="roboplan is in the extra `benchmarks`")
def test_verified_plans_come_before_those_of_roboplan(outcomes):
    """With both held to paths that are free; as it comes, roboplan does not check them so."""
    ours_total, theirs = (
        statistics.median(outcome.total for _, outcome in outcomes[name])
        for name in ("compiled", "roboplan, verified")
    )
    assert ours_total <= theirs


def _cells(
    results: Sequence[tuple[Problem, Outcome]], base: Sequence[tuple[Problem, Outcome]]
) -> list[str]:
    solved = [(problem, outcome) for problem, outcome in results if outcome.waypoints is not None]
    free = sum(is_free(problem, outcome.waypoints) for problem, outcome in solved)
    plans = [outcome.plan for _, outcome in results]
    totals = [outcome.total for _, outcome in results]
    names = {problem.name for problem, _ in base}
    same = [outcome for problem, outcome in results if problem.name in names]
    base_plans = [outcome.plan for _, outcome in base]
    same_plans = [outcome.plan for outcome in same]
    ratios = (
        statistics.median(base_plans) / statistics.median(same_plans),
        _most(base_plans) / _most(same_plans),
        statistics.median(outcome.total for _, outcome in base)
        / statistics.median(outcome.total for outcome in same),
    )
    return [
        f"{len(solved)}/{len(results)}",
        f"{free}/{len(solved)}",
        f"{sum(outcome.checks for _, outcome in results) / sum(plans):.0f}",
        f"{1000 * statistics.median(outcome.scene for _, outcome in results):.1f}",
        f"{1000 * statistics.median(plans):.1f}",
        f"{1000 * _most(plans):.1f}",
        f"{1000 * statistics.median(totals):.1f}",
        f"{1000 * _most(totals):.1f}",
        f"{statistics.median(outcome.length for _, outcome in solved):.2f}" if solved else "-",
        " ".join(f"{ratio:.1f}x" for ratio in ratios),
    ]


def _most(seconds: Sequence[float]) -> float:
    """The time that 95 % of the problems keep within."""
    return float(np.percentile(seconds, 95))
