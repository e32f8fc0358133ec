"""Planning as users have it, on new problems in each run, next to its goals and to others."""

import os
import secrets
import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from tests.benchmarks.planning import motion_bench_maker
from tests.benchmarks.planning.arms import ARMS
from tests.benchmarks.planning.contenders import (
    PATIENCE,
    Outcome,
    broad_phase,
    naive,
    ours,
)
from tests.benchmarks.planning.judge import JUDGED, Judge
from tests.benchmarks.planning.layouts import FAMILIES
from tests.benchmarks.planning.problems import DEFAULT, EXACT, Problem, Route, make_problems
from tests.benchmarks.planning.scene_setup import scene_times
from tests.installed import is_installed

pytestmark = pytest.mark.benchmark

SEED = int(os.environ.get("SEED") or secrets.randbelow(1_000_000))
"""The source of all problems: new ones in every run, or those of the run that had this seed."""

EACH = {DEFAULT: 10, EXACT: 6}
"""Problems of each arm and family."""

NAIVE_EACH = {DEFAULT: 2, EXACT: 1}
"""Those of them that the naive planner gets, which takes seconds for each."""

OBJECTS = (10, 50, 500)
OURS, NAIVE, ROBOPLAN = "armharness", "OMPL in Python, all pairs", "roboplan"
HEAD = (
    *("who", "problems", "solved", "free", "stopped", "scene ms", "plan ms", "95 %"),
    *("total ms", "95 %", "rad", "total to ours"),
)
LIMITS = (
    f"SEED={SEED} draws the same problems again; {len(ARMS)} arms, {len(FAMILIES)} families",
    f"limited: {NAIVE} gets {NAIVE_EACH[DEFAULT]} of {EACH[DEFAULT]} problems of each arm and "
    f"family, {NAIVE_EACH[EXACT]} of {EACH[EXACT]} with exact meshes",
    f"limited: the others are stopped after {PATIENCE:g} s, which then count as their time: "
    "their ratios are lower bounds",
    "ms of processor time, medians and 95 %; total: planned and shortened, ours also verified",
    "ratios compare medians on the same problems",
    f"free: judged by Coal every 1/{1 / JUDGED:g} rad on the shapes of the route; roboplan takes "
    "meshes as they are, without padding, so that it is not judged on convex parts",
)


@dataclass(frozen=True)
class Goal:
    """A figure of this run and what it is held to."""

    name: str
    figure: float
    bound: float
    is_upper: bool
    unit: str

    def cells(self) -> tuple[str, ...]:
        """Name, figure, goal, and by what factor it is missed."""
        met = self.figure <= self.bound if self.is_upper else self.figure >= self.bound
        ratio = self.figure / self.bound if self.is_upper else self.bound / self.figure
        figures = (f"{self.figure:.3g} {self.unit}", f"{self.bound:g} {self.unit}")
        return self.name, *figures, "met" if met else f"missed by a factor of {ratio:.2f}"


class Results:
    """The outcomes of one contender, by problem."""

    def __init__(self, pairs: Iterable[tuple[Problem, Outcome]]) -> None:
        self.outcomes = dict(pairs)

    def of(self, problems: Iterable[Problem]) -> "Results":
        """Those of some problems."""
        return Results((each, self.outcomes[each]) for each in problems if each in self.outcomes)

    def median(self, name: str) -> float:
        """The median of a time [s]."""
        return statistics.median(getattr(each, name) for each in self.outcomes.values())

    def most(self, name: str) -> float:
        """The time that 95 % of the problems keep within [s]."""
        return float(np.percentile([getattr(each, name) for each in self.outcomes.values()], 95))

    def solved(self) -> dict[Problem, Outcome]:
        """The problems with a path."""
        return {p: each for p, each in self.outcomes.items() if each.waypoints is not None}

    def free(self) -> list[Problem]:
        """The problems whose path is free when Coal judges it."""
        solved = self.solved().items()
        return [
            p
            for p, each in solved
            if each.waypoints is not None and Judge(p).is_free(each.waypoints)
        ]

    def ratio_to(self, other: "Results") -> float:
        """The median total over another contender's, on the problems of both."""
        problems = [each for each in self.outcomes if each in other.outcomes]
        return self.of(problems).median("total") / other.of(problems).median("total")

    def cells(self, other: "Results", free: str) -> tuple[str, ...]:
        """The row of a table, without the name."""
        solved = self.solved().values()
        stopped = sum(each.total >= PATIENCE for each in self.outcomes.values())
        return (
            *(f"{len(self.outcomes)}", f"{len(solved)}", free, f"{stopped or '-'}"),
            f"{1000 * self.median('scene'):.1f}",
            *(f"{1000 * self.median('plan'):.1f}", f"{1000 * self.most('plan'):.0f}"),
            *(f"{1000 * self.median('total'):.1f}", f"{1000 * self.most('total'):.0f}"),
            f"{statistics.median(each.length for each in solved):.1f}" if solved else "-",
            f"{self.ratio_to(other):.1f}x",
        )


def contenders() -> dict[str, Callable[[Problem], Outcome]]:
    """Everyone who plans."""
    found = {OURS: ours, NAIVE: naive, "OMPL in Python, broad phase": broad_phase}
    if is_installed("roboplan"):
        from tests.benchmarks.planning.roboplan_contender import roboplan, roboplan_verified

        found |= {ROBOPLAN: roboplan, "roboplan, verified": roboplan_verified}
    return found


def test_the_limits_of_this_run_are_printed(print_row):
    for line in LIMITS:
        print_row("this run", line)


ROUTES = pytest.mark.parametrize("route", [DEFAULT, EXACT], ids=lambda route: route.name)


@ROUTES
def test_planning_on_unseen_problems(route, print_row):
    _race(route, make_problems(route, EACH[route], SEED), route.name, print_row)


@ROUTES
def test_planning_on_motion_bench_maker(route, print_row):
    """Problems of others: MOTION_BENCH_MAKER names a folder with the data set."""
    if not motion_bench_maker.FOLDER:
        print_row("this run", "limited: MOTION_BENCH_MAKER names no folder with that data set")
        return
    problems = [*motion_bench_maker.motion_bench_maker(route, EACH[route], SEED)]
    _race(route, problems, f"MotionBenchMaker, {route.name}", print_row)


def _race(
    route: Route, problems: Sequence[Problem], title: str, print_row: Callable[..., None]
) -> None:
    for contender in contenders().values():  # loads everything before it is timed
        _ = contender(problems[0]), contender(problems[-1])
    found = {
        name: Results(
            (each, contender(each))
            for each in problems
            if name != NAIVE or each.number < NAIVE_EACH[route]
        )
        for name, contender in contenders().items()
    }
    own, free = found[OURS], {name: len(found[name].free()) for name in _judged(route, found)}
    heading = f"planning with {title}"
    print_row(heading, *HEAD)
    for name, results in found.items():
        print_row(heading, name, *results.cells(own, str(free.get(name, "-"))))
    _print_families(print_row, title, own)
    for goal in _goals(route, title, found, free[OURS]):
        _print_goal(print_row, goal)
    assert len(own.solved()) == free[OURS]


def test_the_set_up_of_scenes(print_row):
    heading = "scene set-up with convex parts, ms of processor time"
    print_row(heading, "arm", "objects", "first motion checked", "after one object moved")
    for arm in ARMS:
        scene_times(arm, OBJECTS[0], SEED)
        times = {count: scene_times(arm, count, SEED) for count in OBJECTS}
        for count, each in times.items():
            figures = (f"{1000 * each.first:.1f}", f"{1000 * each.moved:.1f}")
            print_row(heading, arm.name, str(count), *figures)
        few, many = OBJECTS[1:]
        growth = times[many].first / times[few].first / (many / few)
        who = f"scenes, {arm.name}:"
        _print_goal(print_row, Goal(f"{who} 50 objects", 1000 * times[few].first, 5, True, "ms"))
        _print_goal(print_row, Goal(f"{who} 500 over linear from 50", growth, 1, True, "x"))


def _judged(route: Route, found: Iterable[str]) -> list[str]:
    return [name for name in found if route is EXACT or ROBOPLAN not in name]


def _print_families(print_row: Callable[..., None], title: str, own: Results) -> None:
    heading = f"armharness with {title}, ms of processor time"
    print_row(heading, "arm", "family", "plan", "95 %", "total", "95 %", "largest", "solved")
    for arm, family in dict.fromkeys((p.arm.name, p.family) for p in own.outcomes):
        some = own.of(p for p in own.outcomes if (p.arm.name, p.family) == (arm, family))
        largest = max(each.total for each in some.outcomes.values())
        times = [f(name) for name in ("plan", "total") for f in (some.median, some.most)]
        solved = f"{len(some.solved())} of {len(some.outcomes)}"
        cells = [f"{1000 * seconds:.1f}" for seconds in (*times, largest)]
        print_row(heading, arm, family, *cells, solved)


def _goals(route: Route, title: str, found: dict[str, Results], free: int) -> list[Goal]:
    own = found[OURS]
    count = len(own.outcomes)
    goals = [
        Goal("solved", 100 * len(own.solved()) / count, 100, False, "%"),
        Goal("free", 100 * free / count, 100, False, "%"),
    ]
    naive_bound = 20 if route is DEFAULT else 60
    if route is DEFAULT:
        goals += [
            Goal("total, median", 1000 * own.median("total"), 15, True, "ms"),
            Goal("total, 95 %", 1000 * own.most("total"), 150, True, "ms"),
        ]
    goals.append(Goal("total of naive OMPL", found[NAIVE].ratio_to(own), naive_bound, False, "x"))
    if ROBOPLAN in found:
        for name in (ROBOPLAN, f"{ROBOPLAN}, verified"):
            goals.append(Goal(f"total of {name}", found[name].ratio_to(own), 5, False, "x"))
    return [Goal(f"{title}: {g.name}", g.figure, g.bound, g.is_upper, g.unit) for g in goals]


def _print_goal(print_row: Callable[..., None], goal: Goal) -> None:
    print_row("planning against its goals", *goal.cells())
