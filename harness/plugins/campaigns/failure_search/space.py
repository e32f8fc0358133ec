"""The conditions that a search varies: every parameter of `randomize` with its nominal value."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.core.quantity import split_quantity
from harness.language.reading.load import load_scenario
from harness.language.reading.overrides import value_at
from harness.language.variation import Distribution
from harness.plugins.campaigns.conversion import conversion_factor
from harness.suite.variation import Variation

TAIL = 0.001  # share of a normal distribution beyond each end of its range
RESOLUTION = 0.005  # largest step in which a number is shrunk, as a share of its range

Point = tuple[Any, ...]  # one value for each parameter, as a scenario file writes it


@dataclass(frozen=True)
class Parameter:
    """A value of the scenario that varies.

    Attributes:
        path: Where it stands in the file, as `randomize` names it.
        nominal: The value that the file itself has; else the middle of the distribution.
    """

    path: str
    distribution: Distribution
    nominal: Any

    @property
    def is_number(self) -> bool:
        """Whether the value is a number, so that there are values in between."""
        return self.distribution.choice is None

    @property
    def range(self) -> str:
        """What it was varied over, in words."""
        if not self.is_number:
            return ", ".join(map(str, self.distribution.choice or ()))
        return "{:.3g} to {:.3g} {}".format(*self.bounds, self.distribution.unit).rstrip()

    @property
    def bounds(self) -> tuple[float, float]:
        """The ends of the distribution's range, in its own unit."""
        tail = 0.0 if self.distribution.normal is None else TAIL
        return self.distribution.number_at(tail), self.distribution.number_at(1 - tail)

    @property
    def step(self) -> float:
        """The step in which the number is shrunk: a power of ten."""
        low, high = self.bounds
        return 10.0 ** math.floor(math.log10((high - low) * RESOLUTION))

    def number(self, value: Any) -> float:
        """The number of a value, in the unit of the distribution."""
        return split_quantity(value)[0]

    def value(self, number: float) -> float | str:
        """The value of a number in the unit of the distribution, rounded to the step."""
        digits = max(0, -math.floor(math.log10(self.step)))
        return self.distribution.written(round(number, digits))

    def places(self, value: Any) -> tuple[float, float] | None:
        """Where the nominal value and another stand in the range, from 0 to 1; None of words."""
        if not self.is_number:
            return None
        low, high = self.bounds
        nominal, other = (
            (self.number(each) - low) / (high - low) for each in (self.nominal, value)
        )
        return nominal, other

    def change(self, value: Any) -> float:
        """How far a value is from the nominal one, as a share of the range; 1 for words."""
        if value == self.nominal:
            return 0.0
        if not self.is_number:
            return 1.0
        low, high = self.bounds
        return abs(self.number(value) - self.number(self.nominal)) / (high - low)


@dataclass(frozen=True)
class SearchSpace:
    """Every parameter that varies."""

    parameters: tuple[Parameter, ...]

    @property
    def nominal(self) -> Point:
        """The point of the scenario file itself."""
        return tuple(each.nominal for each in self.parameters)

    def point(self, shares: Sequence[float]) -> Point:
        """The point at shares of the distributions, each in [0, 1)."""
        return tuple(
            each.distribution.at(float(share))
            for each, share in zip(self.parameters, shares, strict=True)
        )

    def overrides(self, point: Point) -> dict[str, str]:
        """Path -> value as YAML, in which JSON is."""
        return {path: json.dumps(value) for path, value in self.values(point).items()}

    def values(self, point: Point) -> dict[str, Any]:
        """Path -> value."""
        return {each.path: value for each, value in zip(self.parameters, point, strict=True)}

    def changed(self, point: Point) -> tuple[int, ...]:
        """Indices of the parameters that do not have their nominal value."""
        return tuple(
            index
            for index, (each, value) in enumerate(zip(self.parameters, point, strict=True))
            if each.change(value) > 0
        )

    def size(self, point: Point) -> tuple[int, float]:
        """How large a change is: the number of changed parameters, then the distance."""
        return len(self.changed(point)), self.distance(point)

    def distance(self, point: Point) -> float:
        """Length of the change from the nominal point, in shares of the ranges."""
        pairs = zip(self.parameters, point, strict=True)
        return math.sqrt(sum(each.change(value) ** 2 for each, value in pairs))


def search_space(
    file: Path, variation: Variation, overrides: Mapping[str, str] | None = None
) -> SearchSpace:
    """What the `randomize` of a scenario file varies, with the nominal values from the file.

    Raises:
        SpecError: With every problem of the file.
    """
    written = load_scenario(file, overrides or {}).written
    return SearchSpace(
        tuple(
            Parameter(path, distribution, _nominal(value_at(written, path), distribution))
            for path, distribution in variation.randomize.items()
        )
    )


def _nominal(value: Any, distribution: Distribution) -> Any:
    """The file's value in the unit of the distribution; without one, the distribution's middle."""
    middle = distribution.at(0.5)
    if distribution.choice is not None:
        return middle if value is None else value
    try:
        number, unit = split_quantity(value)
    except ValueError:
        return middle
    factor = conversion_factor(unit, distribution.unit)
    return middle if factor is None else distribution.written(number * factor)
