"""Shrink a failure: the nearest point to the nominal scenario that still fails the same way."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from harness.plugins.campaigns.failure_search.space import Parameter, Point, SearchSpace

FRACTIONS = 256  # parts into which the way from the nominal point to the failure is divided
MOST_ROUNDS = 3  # rounds over all changed parameters; each can only bring the point nearer
Fails = Callable[[Sequence[Point]], list[bool]]  # whether each of some points fails in the same way


def shrink(space: SearchSpace, failing: Point, fails: Fails) -> Point:
    """Reduce a failing point: first the number of changed parameters, then the size of each change.

    The first part is delta debugging [1]: no changed parameter of the result can be given its
    nominal value. A single parameter may change more than in the failing point, up to the end of
    its range, if that is enough. In the second part every number moves to the nominal one, together
    and then each alone, by bisection: none can move nearer by one more step and still fail. The
    order of all trials is fixed, so that the result is the same every time.

    Args:
        fails: Runs points; called with several where none depends on another's result.

    References:
        [1] A. Zeller, R. Hildebrandt, "Simplifying and Isolating Failure-Inducing Input", IEEE
            Transactions on Software Engineering 28(2), 2002.
    """
    shrinking = _Shrinking(space, fails)
    alone = [shrinking.one_number(point, i) for i, point in shrinking.alone(failing)]
    if alone:
        return min(alone, key=space.distance)
    point = shrinking.with_fewest_changes(failing)
    point = shrinking.along_the_ray(point)
    for _ in range(MOST_ROUNDS):
        before = point
        for index in space.changed(point):
            point = shrinking.one_number(point, index)
        if point == before or len(space.changed(point)) == 1:
            break
    return point


@dataclass(frozen=True)
class _Shrinking:
    space: SearchSpace
    fails: Fails

    def alone(self, point: Point) -> list[tuple[int, Point]]:
        """The points with one changed parameter that fail, with its index.

        The parameter has the value of the failing point, else the end of its range beyond.
        """
        changed = self.space.changed(point)
        found: list[tuple[int, Point]] = []
        for values in (point, self._at_ends(point)):
            candidates = [self._only(values, (index,)) for index in changed]
            failed = self.fails(candidates)
            found = [
                (index, candidate)
                for index, candidate, is_failing in zip(changed, candidates, failed, strict=True)
                if is_failing
            ]
            if found:
                break
        return found

    def _at_ends(self, point: Point) -> Point:
        """The point with every changed number at the end of its range."""
        values = list(point)
        for index in self.space.changed(point):
            parameter = self.space.parameters[index]
            if parameter.is_number:
                is_above = parameter.number(point[index]) > parameter.number(parameter.nominal)
                values[index] = parameter.value(parameter.bounds[is_above])
        return tuple(values)

    def with_fewest_changes(self, point: Point) -> Point:
        """Give as many parameters as possible their nominal value."""
        changed = self.space.changed(point)
        parts = 2
        while len(changed) > 1:
            subsets = _split(changed, parts)
            rests = [tuple(i for i in changed if i not in part) for part in subsets]
            candidates = [*subsets, *(rest for rest in rests if parts > 2)]
            found = self._first_failing(point, candidates)
            if found is not None:
                parts = 2 if found in subsets else max(parts - 1, 2)
                changed = found
            elif parts < len(changed):
                parts = min(2 * parts, len(changed))
            else:
                break
        return self._only(point, changed)

    def _first_failing(
        self, point: Point, candidates: Sequence[tuple[int, ...]]
    ) -> tuple[int, ...] | None:
        """The first set of changes with which the scenario still fails."""
        if not candidates:
            return None
        failed = self.fails([self._only(point, each) for each in candidates])
        return next(
            (each for each, is_failing in zip(candidates, failed, strict=True) if is_failing), None
        )

    def _only(self, point: Point, changed: Sequence[int]) -> Point:
        """The point with only these changes."""
        nominal = self.space.nominal
        return tuple(value if i in changed else nominal[i] for i, value in enumerate(point))

    def along_the_ray(self, point: Point) -> Point:
        """Move all changed numbers to the nominal ones together."""
        numbers = [i for i in self.space.changed(point) if self.space.parameters[i].is_number]
        if len(numbers) < 2:
            return point

        def at(part: int) -> Point:
            values = list(point)
            for index in numbers:
                parameter = self.space.parameters[index]
                start = parameter.number(parameter.nominal)
                end = parameter.number(point[index])
                values[index] = parameter.value(start + (end - start) * part / FRACTIONS)
            return tuple(values)

        part = self._smallest_failing(FRACTIONS, lambda part: at(part))
        return point if part is None else at(part)

    def one_number(self, point: Point, index: int) -> Point:
        """Move one changed number to the nominal one, in steps of the parameter."""
        parameter = self.space.parameters[index]
        if not parameter.is_number:
            return point
        count = _steps(parameter, point[index])

        def at(steps: int) -> Point:
            start, end = parameter.number(parameter.nominal), parameter.number(point[index])
            value = parameter.value(start + math.copysign(steps * parameter.step, end - start))
            return (*point[:index], value, *point[index + 1 :])

        steps = self._smallest_failing(count, at)
        return point if steps is None else at(steps)

    def _smallest_failing(self, largest: int, at: Callable[[int], Point]) -> int | None:
        """The smallest number from 1 whose point fails, by bisection; None if none was found.

        `largest` is the point that is known to fail, perhaps rounded.
        """
        low, high = 0, largest
        found: int | None = None
        [is_failing] = self.fails([at(high)])
        if is_failing:
            found = high
        while high - low > 1:
            middle = (low + high) // 2
            [is_failing] = self.fails([at(middle)])
            if is_failing:
                high = found = middle
            else:
                low = middle
        return found


def _steps(parameter: Parameter, value: object) -> int:
    """How many steps a value is away from the nominal one, rounded up."""
    distance = abs(parameter.number(value) - parameter.number(parameter.nominal))
    return max(1, math.ceil(distance / parameter.step - 1e-9))


def _split(changed: Sequence[int], parts: int) -> list[tuple[int, ...]]:
    size = len(changed)
    ends = [round(size * part / parts) for part in range(parts + 1)]
    return [tuple(changed[a:b]) for a, b in itertools.pairwise(ends) if b > a]
