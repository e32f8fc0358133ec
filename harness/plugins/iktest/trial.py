"""A function under test on one arm: calling it, and measuring its answers."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from harness.core.quantity import distinct
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.plugins.iktest.calls import CallOutcome, OutcomeKind
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.contract import Value
from harness.plugins.iktest.convention import Convention
from harness.plugins.iktest.offset import Offset, numbers_text
from harness.plugins.iktest.region import Region, coordinates
from harness.plugins.iktest.solver import Solver
from harness.plugins.iktest.strategies.poses import Target
from harness.plugins.iktest.strategies.tasks import Task, miss

LIMIT_SLACK = 1e-9  # [rad or m] that rounding may put an answer beyond a limit
HANGS, DIES = "does not come back", "ends the process"
COSTS = {"hung": 75, "died": 6}  # cost of such a call in a search's budget; any other call costs 1
MOST_DEATHS = 5  # first calls that end the process, after which every call is taken to do so


@dataclass(frozen=True, eq=False)
class Flaw:
    """Something wrong with what a function does for one target.

    Attributes:
        kind: Flaws of one kind are reported as one finding.
        seed: The seed of the call, joint positions.
        answer: What came back, if joint positions did.
    """

    kind: str
    detail: str
    target: Target
    seed: FloatArray
    answer: FloatArray | None = None


@dataclass(eq=False)
class SolverTrial:
    """A function under test.

    Attributes:
        convention: How the function counts, as far as it is known; answers are converted from it.
        other_convention: The flaw that the convention is, in words; empty for the contract's.
        offset: Error that many answers share, once it is known.
        regions: Regions of different mistakes, once they are known.
        last_cost: Cost of the calls since it was last read.
        lost: `HANGS` once a call hung, `DIES` where each of the first `MOST_DEATHS` calls ended the
            process; else empty. Nothing more is learned of such a function, and calls are slow.
        outcomes: The outcomes of the queries since the list was cleared.
    """

    chain: Chain
    task: Task
    solver: Solver
    position_tolerance: float
    orientation_tolerance: float
    convention: Convention = field(init=False)
    other_convention: str = ""
    offset: Offset | None = None
    regions: tuple[Region, ...] = ()
    lost: str = ""
    outcomes: list[CallOutcome] = field(default_factory=list[CallOutcome])
    _cost: int = 0
    _calls: int = 0
    _deaths: int = 0
    _known: dict[bytes, CallOutcome] = field(default_factory=dict[bytes, CallOutcome])

    def __post_init__(self) -> None:
        self.convention = Convention.plain(self.chain.dof)

    @property
    def common_flaw(self) -> str:
        """The flaw that the offset is, in words: one with the convention, if at every target."""
        if self.offset is None:
            return ""
        is_one = self.other_convention and self.offset.is_everywhere
        return self.other_convention if is_one else f"is {self.offset.text()}"

    def query(
        self, target: Target, seed: FloatArray | None = None, *, afresh: bool = False
    ) -> CallOutcome:
        """Call the function for a target; the seed is home by default.

        Outcomes of earlier calls are remembered, unless `afresh` repeats the call.
        """
        start = self.chain.home if seed is None else seed
        key = target.pose.matrix().tobytes() + start.tobytes()
        if key not in self._known or afresh:
            outcome = self.solver(self.arguments(target, start))
            answers = tuple(self.convention.positions(each) for each in outcome.answers)
            outcome = replace(outcome, answers=answers)
            self._known.setdefault(key, outcome)
            self._count(outcome.kind)
        else:
            outcome = self._known[key]
        self.outcomes.append(outcome)
        return outcome

    def _count(self, kind: OutcomeKind) -> None:
        """Add to the cost of calls, and notice when no further call is worth its time."""
        self._calls += 1
        self._deaths += kind == "died"
        if kind == "hung":
            self.lost = HANGS
        elif self._calls == self._deaths == MOST_DEATHS:
            self.lost = DIES
        self._cost += COSTS.get("hung" if kind == "died" and self.lost else kind, 1)

    def arguments(self, target: Target, seed: FloatArray) -> dict[str, Value]:
        """What the function is called with."""
        return self.convention.arguments(self.solver.words, target.pose, seed)

    def count_by(self, convention: Convention) -> None:
        """Convert targets and answers by another convention from now on."""
        self.convention = convention
        self._known.clear()

    def take_cost(self) -> int:
        """What was spent since this was last called, at least 1."""
        spent, self._cost = max(self._cost, 1), 0
        return spent

    def misses(self, target: Target, answer: FloatArray) -> Flaw | None:
        """How an answer misses its target, if it does; None for what is not finite."""
        if not np.all(np.isfinite(answer)):
            return None
        reached = self.chain.link_pose(answer)
        shift, turn = miss(self.task, target.pose, reached)
        off, turned = shift > self.position_tolerance, turn > self.orientation_tolerance
        if not off and not turned:
            return None
        what = "orientation" if self.task == "pose" else "pitch"
        if self.offset is not None and self.offset.explains(self.task, target.pose, reached):
            kind = self.common_flaw
        else:
            here = coordinates(self.chain, target, answer)
            regions = (f" {each.text()}" for each in self.regions if each.contains(here))
            kind = f"misses the {'position' if off else what}{next(regions, '')}"
        parts = [shift_text(target.pose, reached)] if off else []
        parts += [f"{what} off by {np.degrees(turn):.3g} deg"] if turned else []
        return self.flaw(kind, "; ".join(parts), target, answer)

    def counted_otherwise(self, target: Target, answer: FloatArray) -> Flaw:
        """The flaw of an answer that is right by another convention."""
        returned = self.convention.answer(answer)
        wrong = self.misses(target, returned)
        return self.flaw(self.other_convention, wrong.detail if wrong else "", target, returned)

    def outside(self, target: Target, answer: FloatArray) -> Flaw | None:
        """Which limits an answer breaks, if any."""
        lower, upper = self.chain.limits
        excess = np.maximum(lower - answer, answer - upper)
        if not np.any(excess > LIMIT_SLACK):
            return None
        index = int(np.argmax(excess))
        value, limit = (float(each[index]) for each in (answer, np.clip(answer, lower, upper)))
        unit = "rad" if self.chain.is_turning[index] else "m"
        at, bound = distinct(value, limit, lambda number, more: f"{number:.{5 + more}g}")
        ends = [bound if each[index] == limit else f"{each[index]:.5g}" for each in (lower, upper)]
        return self.flaw(
            "leaves the joint limits",
            f"{self.chain.joint_names[index]} at {at} {unit}, limits {' to '.join(ends)}",
            target,
            answer,
        )

    def breakdown(self, target: Target, outcome: CallOutcome) -> Flaw | None:
        """What is neither an answer nor a refusal."""
        match outcome.kind:
            case "raised":
                at = f" at {outcome.place}" if outcome.place else ""
                name = outcome.text.partition(":")[0]
                return self.flaw(f"raises {name}{at}", outcome.text, target)
            case "unreadable":
                return self.flaw("answers with what is no joint positions", outcome.text, target)
            case "hung" | "died":
                return self.flaw(HANGS if outcome.kind == "hung" else DIES, outcome.text, target)
            case _:
                for answer in outcome.answers:
                    if not np.all(np.isfinite(answer)):
                        return self.flaw("answers with NaN or infinity", "", target, answer)
                return None

    def flaw(
        self, kind: str, detail: str, target: Target, answer: FloatArray | None = None
    ) -> Flaw:
        """A flaw of a call that had home for its seed."""
        return Flaw(kind, detail, target, self.chain.home, answer)


def shift_text(target: SE3, reached: SE3) -> str:
    """How far a pose is from where it should be, in words."""
    shift = reached.translation - target.translation
    parts = numbers_text(1000 * shift, 2)
    return f"position off by {1000 * float(np.linalg.norm(shift)):.3g} mm, ({parts})"
