"""Properties that every inverse kinematics must have."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st

from harness.core.types import BoolArray, FloatArray
from harness.plugins.iktest.calls import CallOutcome, OutcomeKind
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.strategies.paths import StraightLine, straight_lines
from harness.plugins.iktest.strategies.poses import (
    Target,
    poses_around,
    reachable_poses,
    unreachable_poses,
)
from harness.plugins.iktest.strategies.positions import (
    joint_positions,
    near_limit_positions,
    near_singular_positions,
)
from harness.plugins.iktest.strategies.round_poses import round_poses_around, round_reachable_poses
from harness.plugins.iktest.strategies.tasks import manipulability
from harness.plugins.iktest.trial import Flaw, SolverTrial

JUMP = 0.2  # [rad or m] of a joint between two targets 2 mm apart, looked into
HALVINGS = 8  # of a step with a jump in it: a jump is what does not become smaller
REGULAR = 0.02  # least singular value where the ways to a target are counted
SAME_WAY = 1e-3  # [rad or m]


@dataclass(frozen=True, eq=False)
class Property:
    """Something that must hold for every case.

    Attributes:
        size: The size of a case, for the smallest.
        share: The share of the examples that other properties get.
        needs: The outcomes that the property is about.
        calls: The number of such outcomes that a case needs to show anything.
    """

    name: str
    says: str
    cases: Callable[[SolverTrial], st.SearchStrategy[Any]]
    flaws: Callable[[SolverTrial, Any], Sequence[Flaw]]
    size: Callable[[SolverTrial, Any], tuple[float, ...]]
    share: float = 1.0
    needs: tuple[OutcomeKind, ...] = ("answered", "refused")
    calls: int = 1

    def is_observed(self, outcomes: Sequence[CallOutcome]) -> bool:
        """Whether a case in which calls had these outcomes shows that the property holds."""
        return sum(each.kind in self.needs for each in outcomes) >= self.calls


def within_reach(trial: SolverTrial) -> st.SearchStrategy[Target]:
    """Targets from forward kinematics: anywhere, near limits, near singularities."""
    chain = trial.chain
    positions = st.one_of(
        joint_positions(chain),
        near_limit_positions(chain),
        near_singular_positions(chain, trial.task),
    )
    return reachable_poses(chain, positions)


def _within_reach_or_round(trial: SolverTrial) -> st.SearchStrategy[Target]:
    return st.one_of(within_reach(trial), round_reachable_poses(trial.chain, trial.task))


def _beyond_reach(trial: SolverTrial) -> st.SearchStrategy[Target]:
    return unreachable_poses(trial.chain, any_orientation=trial.task != "pose")


def _around(trial: SolverTrial) -> st.SearchStrategy[Target]:
    return st.one_of(poses_around(trial.chain), round_poses_around(trial.chain, trial.task))


def _reaches(trial: SolverTrial, target: Target) -> list[Flaw]:
    answers = trial.query(target).answers
    first = answers[:1] if trial.other_convention else ()
    found = [trial.counted_otherwise(target, answer) for answer in first]
    return found + [flaw for answer in answers if (flaw := trial.misses(target, answer))]


def _answers(trial: SolverTrial, target: Target) -> list[Flaw]:
    outcome = trial.query(target)
    if outcome.kind == "refused":
        return [trial.flaw("refuses a target within reach", "", target)]
    flaw = trial.breakdown(target, outcome)
    return [] if flaw is None else [flaw]


def _limits(trial: SolverTrial, target: Target) -> list[Flaw]:
    answers = (each for each in trial.query(target).answers if np.all(np.isfinite(each)))
    found = (trial.outside(target, answer) for answer in answers)
    return [flaw for flaw in found if flaw is not None]


def _refuses(trial: SolverTrial, target: Target) -> list[Flaw]:
    outcome = trial.query(target)
    flaw = trial.breakdown(target, outcome)
    if flaw is not None:
        return [flaw]
    found = (trial.misses(target, answer) for answer in outcome.answers)
    wrong = next((each for each in found if each is not None), None)
    if wrong is None:
        return []
    if wrong.kind == trial.common_flaw:
        return [wrong]
    return [trial.flaw("answers a target out of reach", wrong.detail, target, wrong.answer)]


def _anywhere(trial: SolverTrial, target: Target) -> list[Flaw]:
    outcome = trial.query(target)
    flaw = trial.breakdown(target, outcome)
    wrong = (trial.misses(target, answer) for answer in outcome.answers)
    return [each for each in (flaw, *wrong) if each is not None]


def _repeats(trial: SolverTrial, targets: tuple[Target, Target]) -> list[Flaw]:
    target, other = targets
    first = trial.query(target, afresh=True)
    trial.query(other, afresh=True)
    second = trial.query(target, afresh=True)
    if [each.tobytes() for each in first.answers] == [each.tobytes() for each in second.answers]:
        return []
    if len(first.answers) != len(second.answers):
        detail = f"first {len(first.answers)} answers, then {len(second.answers)}"
    else:
        pairs = zip(first.answers, second.answers, strict=True)
        change = max(float(np.abs(one - two).max()) for one, two in pairs)
        detail = f"a joint differs by {change:.3g}"
    answer = first.answers[0] if first.answers else None
    return [trial.flaw("answers differently when called again", detail, target, answer)]


def _follows(trial: SolverTrial, line: StraightLine) -> list[Flaw]:
    last: FloatArray | None = None
    before = line.joint_positions[0]
    for positions in line.joint_positions:
        answer = _nearest(trial, positions, before if last is None else last)
        if (
            last is not None
            and answer is not None
            and _changes(trial.chain, last, answer).max() > JUMP
        ):
            flaw = _jump(trial, before, positions, last, answer)
            if flaw is not None:
                return [flaw]
        before = positions
        last = answer
    return []


def _jump(
    trial: SolverTrial, before: FloatArray, after: FloatArray, left: FloatArray, right: FloatArray
) -> Flaw | None:
    """Halve a step as long as one half holds the jump; what is left is one, or was steep."""
    for _ in range(HALVINGS):
        middle = 0.5 * (before + after)
        answer = _nearest(trial, middle, left)
        if answer is None:
            return None
        halves = (_changes(trial.chain, *each).max() for each in ((left, answer), (answer, right)))
        if next(halves) > next(halves):
            after, right = middle, answer
        else:
            before, left = middle, answer
    change = _changes(trial.chain, left, right)
    index = int(np.argmax(change))
    if change[index] < JUMP:
        return None
    apart = trial.chain.link_pose(before).distance_to(trial.chain.link_pose(after))[0]
    unit = "rad" if trial.chain.is_turning[index] else "m"
    detail = (
        f"{trial.chain.joint_names[index]} from {left[index]:.4g} to {right[index]:.4g} {unit} "
        f"while the target moves by {1e6 * apart:.2g} um"
    )
    target = Target(trial.chain.link_pose(after), after)
    return Flaw("jumps along a straight line", detail, target, left, right)


def _nearest(trial: SolverTrial, positions: FloatArray, near: FloatArray) -> FloatArray | None:
    """The answer nearest to positions, for the pose of others; None where there is none."""
    target = Target(trial.chain.link_pose(positions), positions)
    answers = [each for each in trial.query(target, near).answers if np.all(np.isfinite(each))]
    return min(answers, key=lambda each: _changes(trial.chain, near, each).max(), default=None)


def _changes(chain: Chain, before: FloatArray, after: FloatArray) -> FloatArray:
    """How far each joint moves [rad or m]; a joint without limits, up to whole turns."""
    lower, upper = chain.limits
    return _without_turns(after - before, np.isinf(lower) & np.isinf(upper) & chain.is_turning)


def _without_turns(changes: FloatArray, turns: BoolArray) -> FloatArray:
    """Sizes of changes, without the whole turns of the joints that turn."""
    whole = 2 * np.pi * np.round(changes / (2 * np.pi))
    return np.abs(np.where(turns, changes - whole, changes))


def _all_ways(trial: SolverTrial, target: Target) -> list[Flaw]:
    way = target.joint_positions
    if way is None or manipulability(trial.chain, trial.task, way[None])[0] < REGULAR:
        return []  # near a singularity solution branches merge
    outcome = trial.query(target)
    if outcome.kind not in ("answered", "refused"):
        return []
    if any(is_same_way(trial.chain, way, answer) for answer in outcome.answers):
        return []
    detail = f"{len(outcome.answers)} answers, none of them {np.round(way, 4).tolist()}"
    return [trial.flaw("leaves out a way to reach the target", detail, target)]


def is_same_way(chain: Chain, first: FloatArray, second: FloatArray) -> bool:
    """Whether positions are the same up to whole turns."""
    return bool(_without_turns(first - second, chain.is_turning).max() < SAME_WAY)


def _target_size(trial: SolverTrial, target: Target) -> tuple[float, ...]:
    """Joints that are not at home, then how far; or the way from home's pose."""
    home = trial.chain.home
    if target.joint_positions is not None:
        away = np.abs(target.joint_positions - home)
        return float(np.count_nonzero(away > 1e-12)), float(away.sum())
    shift, turn = trial.chain.link_pose(home).distance_to(target.pose)
    return 0.0, shift + turn


def _pair_size(trial: SolverTrial, targets: tuple[Target, Target]) -> tuple[float, ...]:
    return tuple(value for target in targets for value in _target_size(trial, target))


def _line_size(trial: SolverTrial, line: StraightLine) -> tuple[float, ...]:
    away = np.abs(line.joint_positions[0] - trial.chain.home)
    return float(np.count_nonzero(away > 1e-12)), float(away.sum()), len(line.joint_positions)


ROUND_TOO = 4 / 3  # share of the examples where a quarter more are round targets

PROPERTIES = (
    Property("reaches", "forward kinematics of every answer is the target",
             _within_reach_or_round, _reaches, _target_size, ROUND_TOO,
             needs=("answered",)),
    Property("answers", "a target within reach is answered, in finite numbers",
             _within_reach_or_round, _answers, _target_size, ROUND_TOO),
    Property("limits", "answers keep the joint limits",
             within_reach, _limits, _target_size, needs=("answered",)),
    Property("refuses", "a target out of reach is refused", _beyond_reach, _refuses, _target_size),
    Property("anywhere", "any target is answered rightly or refused",
             _around, _anywhere, _target_size),
    Property("continuity", "on a straight line no joint jumps",
             lambda trial: straight_lines(trial.chain, trial.task), _follows, _line_size, 0.2,
             needs=("answered",), calls=2),
    Property("determinism", "the same question has the same answer",
             lambda trial: st.tuples(within_reach(trial), within_reach(trial)),
             _repeats, _pair_size, 0.5, calls=2),
)  # fmt: skip

BRANCHES = Property("branches", "every way to reach the target is answered",
                    within_reach, _all_ways, _target_size)  # fmt: skip
