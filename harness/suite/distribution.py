"""Distributions of random values, in the units in which a file writes them."""

from __future__ import annotations

import random
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

from harness.core.quantity import common_unit, split_quantity

SMALLEST_SHARE = 1e-12  # tail of a normal distribution whose quantile is still finite


@dataclass(frozen=True)
class Choice:
    """Values with equal probability.

    Attributes:
        plain: The distribution as the file writes it.
    """

    plain: Mapping[str, Any]
    values: tuple[Any, ...]

    def at(self, share: float) -> Any:
        """The value at a share in [0, 1); each value has an equal part."""
        return self.values[min(int(share * len(self.values)), len(self.values) - 1)]

    def draw(self, rng: random.Random) -> Any:
        """A random value."""
        return rng.choice(self.values)


@dataclass(frozen=True)
class NumberDistribution(ABC):
    """A distribution of numbers.

    Attributes:
        plain: The distribution as the file writes it.
        unit: The unit of its numbers, which may be empty.
    """

    plain: Mapping[str, Any]
    unit: str

    @abstractmethod
    def number_at(self, share: float) -> float:
        """The number that a share of the distribution is below."""

    def at(self, share: float) -> float | str:
        """The value that a share of the distribution is below, as a file writes it."""
        return self.written(self.number_at(share))

    def draw(self, rng: random.Random) -> float | str:
        """A random value."""
        return self.at(rng.random())

    def written(self, number: float) -> float | str:
        """A number in the distribution's unit as a file writes it."""
        return f"{number!r} {self.unit}" if self.unit else number


@dataclass(frozen=True)
class Uniform(NumberDistribution):
    """Numbers between two ends."""

    low: float
    high: float

    def number_at(self, share: float) -> float:
        return self.low + (self.high - self.low) * share


@dataclass(frozen=True)
class Normal(NumberDistribution):
    """A normal distribution, cut at its bounds where there are some."""

    mean: float
    std: float
    low: float | None = None
    high: float | None = None

    def number_at(self, share: float) -> float:
        curve = NormalDist(self.mean, self.std)
        least = 0.0 if self.low is None else curve.cdf(self.low)
        most = 1.0 if self.high is None else curve.cdf(self.high)
        below = least + (most - least) * share
        return curve.inv_cdf(min(max(below, SMALLEST_SHARE), 1 - SMALLEST_SHARE))


Distribution = Choice | Uniform | Normal


def read_distribution(plain: Mapping[str, Any]) -> Distribution:
    """The distribution that plain values of a file describe.

    Raises:
        LookupError, TypeError, ValueError: They describe none.
    """
    found = _read(plain)
    found.at(0.5)
    return found


def _read(plain: Mapping[str, Any]) -> Distribution:
    if "choice" in plain:
        return Choice(plain, tuple(plain["choice"]))
    if "uniform" in plain:
        low, high = (split_quantity(each)[0] for each in plain["uniform"])
        return Uniform(plain, common_unit(*plain["uniform"]), low, high)
    normal = plain["normal"]
    ends = (normal.get("low"), normal.get("high"))
    low, high = (None if end is None else split_quantity(end)[0] for end in ends)
    mean, std = split_quantity(normal["mean"])[0], split_quantity(normal["std"])[0]
    unit = common_unit(normal["mean"], normal["std"])
    return Normal(plain, unit, mean, std, low, high)
