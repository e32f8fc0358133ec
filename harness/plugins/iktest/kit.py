"""The whole test of a function: every property tried, every kind of flaw shrunk."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.contract import UnusableSolver, call_text, task_of_parameters
from harness.plugins.iktest.convention import (
    KEPT,
    Convention,
    answer_units,
    target_units,
    with_fitted_zeros,
)
from harness.plugins.iktest.learned import Learned
from harness.plugins.iktest.properties import BRANCHES, PROPERTIES, Property, within_reach
from harness.plugins.iktest.region import separate_regions
from harness.plugins.iktest.report import (
    IkFinding,
    IkReport,
    PropertyResult,
    Speed,
    write_ik_report,
)
from harness.plugins.iktest.search import draw, shrink_case
from harness.plugins.iktest.solver import InProcess, Isolated, Solver
from harness.plugins.iktest.strategies.poses import Target
from harness.plugins.iktest.strategies.tasks import ROWS
from harness.plugins.iktest.text import report_lines
from harness.plugins.iktest.trial import COSTS, Flaw, SolverTrial
from harness.robot.robot_source import RobotSource, load_source

MOSTLY = 0.5  # share of right answers from which a function counts as its contract says
LEAST_TARGETS = 5  # number of answered targets from which answers show how a function counts
MOST_FINDINGS = 4  # kinds of flaws that are shrunk for one property, the most frequent first


@dataclass(frozen=True)
class IkTest:
    """How a function is tested.

    Attributes:
        solver: `module:function`, `file.py:function`, the name of a solver or `own`, called in a
            process of its own that is ended when it hangs; or a function, called in this process.
        robot: A bundled name, a folder, a file; or with more words about it.
        link: The link that is placed; by default the TCP.
        branches: The function claims to answer every way to reach a target.
        examples: Cases of each property.
        seed: The seed of the cases; the same seed draws the same ones.
        position_tolerance: The largest position error of an answer [m].
        orientation_tolerance: The largest orientation or pitch error of an answer [rad].
        patience: Processor time after which a call counts as hanging [s].
        report_dir: Where pictures and `ik_test.json` go; None writes nothing.
        on_case: Called with the name of a property, its cases that were tried, and all of them.
    """

    solver: str | Callable[..., Any]
    robot: str | RobotSource
    link: str = ""
    branches: bool = False
    examples: int = 100
    seed: int = 0
    position_tolerance: float = 1e-4
    orientation_tolerance: float = 1e-3
    patience: float = 5.0
    report_dir: Path | None = None
    on_case: Callable[[str, int, int], None] = lambda *_: None

    @property
    def source(self) -> RobotSource:
        """The arm, with all its words."""
        return RobotSource(self.robot) if isinstance(self.robot, str) else self.robot


def run_ik_test(test: IkTest) -> IkReport:
    """Test a function.

    Raises:
        UnusableSolver: The function is not there, cannot be called, or answers in another form
            than joint positions.
        RobotError: There is no such robot, group or link.
    """
    started = perf_counter()
    chain = Chain.of(load_source(test.source), link=test.link)
    solver = _solver(test, chain)
    try:
        task = task_of_parameters(solver.words)
        trial = SolverTrial(
            chain, task, solver, test.position_tolerance, test.orientation_tolerance
        )
        if test.branches and ROWS[trial.task] != chain.dof:
            raise UnusableSolver(
                f"a {trial.task} is {ROWS[trial.task]} numbers and the arm has {chain.dof} joints: "
                "the ways to reach it cannot be counted, so --branches does not apply"
            )
        _probe(trial)
        properties = (*PROPERTIES, BRANCHES) if test.branches else PROPERTIES
        results, findings, speed = _Search(trial, test).run(properties)
    finally:
        solver.close()
    name = test.solver if isinstance(test.solver, str) else solver.name
    report = IkReport(
        solver=name,
        robot=chain.description.name,
        task=trial.task,
        link=chain.link,
        joint_names=chain.joint_names,
        home=chain.home,
        properties=results,
        findings=findings,
        speed=speed,
        seed=test.seed,
        seconds=perf_counter() - started,
    )
    if test.report_dir is None:
        return report
    return write_ik_report(report, chain, test.report_dir)


def check_ik(
    solver: str | Callable[..., Any], robot: str | RobotSource, **options: Any
) -> IkReport:
    """Test a function, for tests: raise AssertionError with everything that was found.

    Args:
        **options: Other attributes of `IkTest`.
    """
    __tracebackhide__ = True
    report = run_ik_test(IkTest(solver, robot, **options))
    if not report.has_passed:
        raise AssertionError("\n".join(report_lines(report)))
    return report


def _solver(test: IkTest, chain: Chain) -> Solver:
    if not isinstance(test.solver, str):
        return InProcess(test.solver, chain.dof)
    return Isolated(test.solver, test.source, test.link, chain.dof, test.patience)


def _probe(trial: SolverTrial) -> None:
    """Query a few poses within reach, and refuse a function whose answers cannot be read.

    Raises:
        UnusableSolver: None of its answers has the shape of joint positions.
    """
    chain = trial.chain
    rng = np.random.default_rng(0)
    states = [chain.home, *rng.uniform(chain.lower, chain.upper, (4, chain.dof))]
    for state in states:
        outcome = trial.query(Target(chain.link_pose(state), state))
        if outcome.kind == "unreadable":
            raise UnusableSolver(
                f"{trial.solver.name} {outcome.text}; the joints are {', '.join(chain.joint_names)}"
            )
        if outcome.kind in ("answered", "hung"):
            return


class _Search:
    """One pass over the properties; a kind of flaw is shrunk where it first shows."""

    def __init__(self, trial: SolverTrial, test: IkTest) -> None:
        self._trial, self._test = trial, test
        self._findings: list[IkFinding] = []
        self._known: dict[str, int] = {}

    def run(
        self, properties: tuple[Property, ...]
    ) -> tuple[tuple[PropertyResult, ...], tuple[IkFinding, ...], Speed | None]:
        """Results, findings and speed."""
        targets = self._targets()
        speed = self._time(targets)
        self._learn(targets)
        results: list[PropertyResult] = []
        for each in properties:
            if self._trial.lost in self._known:
                note = f"not tried: it {self._trial.lost}"
                results.append(PropertyResult(each.name, each.says, note=note))
            else:
                results.append(self._try(each))
        return tuple(results), tuple(self._findings), speed

    def _time(self, targets: Sequence[Target]) -> Speed | None:
        """Times of calls for targets within reach."""
        times: list[float] = []
        for target in targets:
            outcome = self._trial.query(target)
            if outcome.kind in ("answered", "refused"):
                times.append(outcome.seconds)
            if self._trial.lost:
                break
        if not times:
            return None
        median, slow = np.quantile(times, [0.5, 0.95])
        return Speed(float(median), float(slow), max(times), len(times))

    def _learn(self, targets: Sequence[Target]) -> None:
        """How the function counts, the error that answers share, and the regions of mistakes."""
        trial = self._trial
        if trial.lost:
            return
        plain, pairs = trial.convention, self._answers(targets)
        learned = self._learned(plain, pairs)
        if learned.share < MOSTLY:
            found = next(self._conventions(targets), None)
            if found is not None:
                learned, trial.other_convention = found, found.text(trial.chain)
        trial.count_by(learned.convention)
        trial.offset = learned.offset
        pairs = self._answers(targets)
        flaws = [trial.misses(*pair) for pair in pairs]
        is_other = np.array([flaw and flaw.kind != trial.common_flaw for flaw in flaws], bool)
        trial.regions = separate_regions(trial.chain, pairs, is_other)

    def _learned(
        self, convention: Convention, pairs: Sequence[tuple[Target, FloatArray]]
    ) -> Learned:
        trial = self._trial
        tolerances = trial.position_tolerance, trial.orientation_tolerance
        return Learned.of(trial.chain, trial.task, tolerances, pairs, convention)

    def _targets(self) -> list[Target]:
        """Targets that the arm reaches, as every property draws them."""
        found: list[Target] = []

        def visit(target: Target) -> bool:
            found.append(target)
            return True

        draw(within_reach(self._trial), visit, self._test.examples, self._test.seed)
        return found

    def _answers(self, targets: Sequence[Target]) -> list[tuple[Target, FloatArray]]:
        """Targets and finite answers to them, by the convention of the trial."""
        pairs: list[tuple[Target, FloatArray]] = []
        for target in targets:
            answers = () if self._trial.lost else self._trial.query(target).answers
            pairs += [(target, each) for each in answers if np.all(np.isfinite(each))]
        return pairs

    def _conventions(self, targets: Sequence[Target]) -> Iterator[Learned]:
        """Conventions by which most answers are right, the simplest first."""
        trial = self._trial
        chain = trial.chain
        answered: list[tuple[Convention, list[tuple[Target, FloatArray]]]] = []
        for units in target_units(chain, trial.solver.words):
            trial.count_by(units)
            answered.append((units, self._answers(targets)))
            for convention in answer_units(chain, units):
                yield from self._if_right(convention, answered[-1][1])
        most = max(len(pairs) for _, pairs in answered)
        likely = [(units, pairs) for units, pairs in answered if len(pairs) >= KEPT * most]
        for is_shifted, (target, pairs) in product((False, True), likely):
            zeros = (
                found
                for units in answer_units(chain, target)
                for fitted in with_fitted_zeros(
                    chain, trial.task, units, pairs, is_shifted=is_shifted
                )
                for found in self._if_right(fitted, pairs)
            )
            yield from sorted(zeros, key=lambda found: found.convention.changes())

    def _if_right(
        self, convention: Convention, pairs: Sequence[tuple[Target, FloatArray]]
    ) -> Iterator[Learned]:
        """What is known by a convention, if it makes most answers right."""
        by_convention = [(target, convention.positions(answer)) for target, answer in pairs]
        learned = self._learned(convention, by_convention)
        if learned.share >= KEPT and learned.targets >= LEAST_TARGETS:
            yield learned

    def _try(self, each: Property) -> PropertyResult:
        """Draw cases, count what they show, shrink what is new."""
        trial = self._trial
        kinds: Counter[str] = Counter()
        smallest: dict[str, tuple[tuple[float, ...], Flaw]] = {}
        tried = flawed = observed = 0

        def visit(case: Any) -> bool:
            nonlocal tried, flawed, observed
            trial.outcomes.clear()
            flaws = each.flaws(trial, case)
            tried += 1
            self._test.on_case(each.name, tried, max(tried, self._test.examples))
            observed += bool(flaws) or each.is_observed(trial.outcomes)
            flawed += bool(flaws)
            kinds.update(sorted({flaw.kind for flaw in flaws}))
            size = each.size(trial, case)
            for flaw in flaws:
                if flaw.kind not in smallest or size < smallest[flaw.kind][0]:
                    smallest[flaw.kind] = size, flaw
            return not (trial.lost and any(each.kind in COSTS for each in trial.outcomes))

        count = max(10, round(each.share * self._test.examples))
        draw(each.cases(trial), visit, count, self._test.seed)
        common = [trial.other_convention, trial.common_flaw]
        frequent = sorted(kinds, key=lambda kind: (kind not in common, -kinds[kind], kind))
        new = [kind for kind in frequent if kind not in self._known][:MOST_FINDINGS]
        for kind in new:
            flaw = self._shrunk(each, kind, tried) or smallest[kind][1]
            self._known[kind] = len(self._findings) + 1
            self._findings.append(self._finding(each, flaw, kinds[kind], tried))
        found = sorted(self._known[kind] for kind in kinds if kind in self._known)
        return PropertyResult(each.name, each.says, tried, flawed, observed, tuple(found))

    def _shrunk(self, each: Property, kind: str, tried: int) -> Flaw | None:
        """The smallest flaw of a kind; None when it does not show again."""
        trial = self._trial

        def shows(case: Any) -> Flaw | None:
            return next((flaw for flaw in each.flaws(trial, case) if flaw.kind == kind), None)

        trial.take_cost()
        return shrink_case(each.cases(trial), shows, lambda case: each.size(trial, case),
                      tried, self._test.seed, trial.take_cost)  # fmt: skip

    def _finding(self, each: Property, flaw: Flaw, shown: int, tried: int) -> IkFinding:
        trial = self._trial
        arguments = trial.arguments(flaw.target, flaw.seed)
        return IkFinding(
            number=len(self._findings) + 1,
            property=each.name,
            kind=flaw.kind,
            detail=flaw.detail,
            shown=shown,
            tried=tried,
            call=call_text(trial.solver.name, arguments),
            target=flaw.target,
            answer=flaw.answer,
            reached=_reached(trial.chain, flaw.answer),
        )


def _reached(chain: Chain, answer: FloatArray | None) -> FloatArray | None:
    if answer is None or not np.all(np.isfinite(answer)):
        return None
    return chain.link_pose(answer).as_vector()
