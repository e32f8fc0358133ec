"""Planning as users have it, in seven families of scenes, against OMPL as written in Python."""

import statistics
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from tests.benchmarks.planning.contenders import Outcome, is_free, naive, ours
from tests.benchmarks.planning.layouts import FAMILIES
from tests.benchmarks.planning.problems import (
    DEFAULT,
    EXACT,
    HELD_OUT,
    Problem,
    Route,
    make_problem,
    make_problems,
)
from tests.installed import is_installed

EACH = 5
"""Problems of each family on which the planner may be tuned, and as many that are held out."""

NAIVE_EACH = 2
"""Those of the held-out ones that the naive planner gets: it takes minutes, the others seconds."""

ROUTES = (DEFAULT, EXACT)
GOALS = {
    DEFAULT.name: "100 % solved and free, total 15 / 150 ms, 20x naive, 5x roboplan",
    EXACT.name: "100 % solved and free, total 60x naive",
}
HEADS = (
    *("who", "solved", "free", "checks/s", "scene ms", "plan ms", "95 %", "total ms", "95 %"),
    *("rad", "ratio"),
)
"""Ratios are the naive planner's median plan, its 95 %, and its median total over those of a
contender on the same problems."""

Results = list[tuple[Problem, Outcome]]


def contenders(route: Route) -> dict[str, Callable[[Problem], Outcome]]:
    """Everyone who plans: roboplan only where its shapes are those of the others."""
    found: dict[str, Callable[[Problem], Outcome]] = {
        "naive": naive,
        "armharness": lambda problem: ours(problem, "always"),
    }
    if route.exact and is_installed("roboplan"):
        from tests.benchmarks.planning.roboplan_contender import roboplan, roboplan_verified

        found |= {"roboplan": roboplan, "roboplan, verified": roboplan_verified}
    return found


@pytest.fixture(scope="module", params=ROUTES, ids=lambda route: route.name)
def measured(request) -> tuple[Route, dict[str, Results]]:
    """The result of every contender on every held-out problem, in turns; warm-up left out."""
    route, found = request.param, {}
    ours(make_problem(route, "box", 0), "always")
    for problem in make_problems(route, EACH, HELD_OUT):
        for name, contender in contenders(route).items():
            if name != "naive" or int(problem.name.split()[-1]) < HELD_OUT + NAIVE_EACH:
                found.setdefault(name, []).append((problem, contender(problem)))
    return route, found


@pytest.mark.benchmark
def test_planning_on_problems_that_are_held_out(measured, print_row):
    route, found = measured
    heading = f"{route.name}: {len(found['armharness'])} held-out problems, ms of CPU time"
    print_row(heading, *HEADS)
    print_row(heading, "goal", GOALS[route.name])
    for name, results in found.items():
        print_row(heading, name, *_cells(results, found["naive"]))
    tuned = [(problem, ours(problem, "always")) for problem in make_problems(route, EACH)]
    print_row(heading, "not held out", *_cells(tuned, found["naive"]))
    for family in FAMILIES:
        heading = f"{route.name}, {family}, ms of CPU time"
        print_row(heading, *HEADS)
        base = [pair for pair in found["naive"] if pair[0].family == family]
        for name, results in found.items():
            print_row(heading, name, *_cells([r for r in results if r[0].family == family], base))
    own = found["armharness"] + tuned
    assert all(outcome.waypoints is not None for _, outcome in own)
    assert all(is_free(problem, outcome.waypoints) for problem, outcome in own)


@pytest.mark.benchmark
@pytest.mark.skipif(not is_installed("roboplan"), reason="roboplan is in the extra `benchmarks`")
def test_verified_plans_come_before_those_of_roboplan(measured):
    """With both held to paths that are free; as it comes, roboplan does not check them so."""
    route, found = measured
    if route.exact:
        ours_total, theirs = (
            statistics.median(outcome.total for _, outcome in found[name])
            for name in ("armharness", "roboplan, verified")
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
        ()
        if not same
        else (
            statistics.median(base_plans) / statistics.median(same_plans),
            _most(base_plans) / _most(same_plans),
            statistics.median(outcome.total for _, outcome in base)
            / statistics.median(outcome.total for outcome in same),
        )
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
