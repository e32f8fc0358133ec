"""Cases of a scenario: values that take others in turn, or are drawn at random."""

from __future__ import annotations

import math
import random
from statistics import NormalDist
from typing import Annotated, Any, cast

from pydantic import AfterValidator, Field, model_validator

from harness.core.quantity import common_unit, split_quantity
from harness.core.variation import MOST_CASES, MOST_SAMPLES, count_of
from harness.language.base import Count, Flag, Fraction, Share, SpecModel
from harness.language.plugin_field import KeyModel, PluginModel

VARIATION_KEYS = (
    *("parametrize", "randomize", "samples", "redraw_overlaps", "expect_rate"),
    "search",
)
"""Keys that say which cases there are; a case itself has none of them."""

SMALLEST_SHARE = 1e-12  # tail of a normal distribution whose quantile is still finite
DEFAULT_SAMPLES = 20  # of a file that draws random values and does not say how many


def _is_finite_quantity(value: object) -> object:
    if not math.isfinite(split_quantity(value)[0]):
        raise ValueError("a finite number is expected")
    return value


FiniteQuantity = Annotated[Any, AfterValidator(_is_finite_quantity)]


class Normal(SpecModel):
    """A normal distribution, cut at its bounds where there are some."""

    mean: FiniteQuantity = Field(description="The mean: a number, with or without a unit.")
    std: FiniteQuantity = Field(description="The standard deviation, in the unit of the mean.")
    low: FiniteQuantity | None = Field(
        default=None, description="The value is drawn again when it is below this."
    )
    high: FiniteQuantity | None = Field(
        default=None, description="The value is drawn again when it is above this."
    )

    @model_validator(mode="after")
    def _reachable(self) -> Normal:
        mean, std = split_quantity(self.mean), split_quantity(self.std)
        ends = (each for each in (self.low, self.high) if each is not None)
        common_unit(self.mean, self.std, *ends)
        if std[0] <= 0:
            raise ValueError("`std` must be more than 0")
        low = -math.inf if self.low is None else split_quantity(self.low)[0]
        high = math.inf if self.high is None else split_quantity(self.high)[0]
        if high - low < 0.1 * std[0] or low > mean[0] + 3 * std[0] or high < mean[0] - 3 * std[0]:
            raise ValueError("`low` and `high` leave too little of the distribution")
        return self


class Distribution(SpecModel):
    """The distribution of a random value: exactly one of these keys."""

    one_of = ("uniform", "normal", "choice")

    uniform: tuple[FiniteQuantity, FiniteQuantity] | None = Field(
        default=None,
        description="The value is uniform between two numbers, with or without a unit.",
    )
    normal: Normal | None = Field(default=None, description="The value has a normal distribution.")
    choice: Annotated[tuple[Any, ...], Field(min_length=1, max_length=1000)] | None = Field(
        default=None, description="The value is one of these, each with equal probability."
    )

    @model_validator(mode="after")
    def _one(self) -> Distribution:
        if self.uniform is not None:
            common_unit(*self.uniform)
            low, high = (split_quantity(each)[0] for each in self.uniform)
            if low >= high:
                raise ValueError("the first end must be below the second")
        return self

    @property
    def unit(self) -> str:
        """The unit of its numbers, which may be empty."""
        normal = self.normal
        return common_unit(*((normal.mean, normal.std) if normal else self.uniform or ()))

    def number_at(self, share: float) -> float:
        """The number that a share of the distribution is below, in its unit; of no `choice`."""
        if self.uniform is not None:
            low, high = (split_quantity(each)[0] for each in self.uniform)
            return low + (high - low) * share
        assert self.normal is not None
        mean, std = (split_quantity(each)[0] for each in (self.normal.mean, self.normal.std))
        curve = NormalDist(mean, std)
        ends = zip((self.normal.low, self.normal.high), (0.0, 1.0), strict=True)
        least, most = (
            beyond if end is None else curve.cdf(split_quantity(end)[0]) for end, beyond in ends
        )
        below = least + (most - least) * share
        return curve.inv_cdf(min(max(below, SMALLEST_SHARE), 1 - SMALLEST_SHARE))

    def at(self, share: float) -> Any:
        """The value at a share in [0, 1), as a file writes it; choices have equal parts."""
        if self.choice is not None:
            return self.choice[min(int(share * len(self.choice)), len(self.choice) - 1)]
        return self.written(self.number_at(share))

    def draw(self, rng: random.Random) -> Any:
        return self.at(rng.random()) if self.choice is None else rng.choice(self.choice)

    def written(self, number: float) -> float | str:
        """A number in the distribution's unit as a file writes it."""
        unit = self.unit
        return f"{number!r} {unit}" if unit else number


class RequiredRate(SpecModel):
    """A success rate that random cases must show: `90 %` is short for `{at_least: 90 %}`."""

    short = "at_least"

    at_least: Annotated[Fraction, Field(lt=1, description="The share of samples that must pass.")]
    confidence: Annotated[Share, Field(gt=0.5, lt=1)] = Field(
        default=0.95, description="The confidence with which the rate must be shown."
    )
    stop_early: bool = Field(
        default=True, description="Whether sampling ends as soon as a sequential test has decided."
    )


def _grid_or_cases(value: object) -> object:
    if not value:
        raise ValueError("there is no case; `parametrize` is a grid, or a list of named cases")
    if isinstance(value, dict):
        grid = cast("dict[str, Any]", value)
        for path, values in grid.items():
            if not isinstance(values, list) or not values:
                raise ValueError(f"`{path}` takes a list of values in turn")
        if count_of(grid) > MOST_CASES:
            raise ValueError(f"the grid has more than {MOST_CASES} cases")
        return grid
    cases = cast("list[Any]", value)
    if len(cases) > MOST_CASES:
        raise ValueError(f"there are more than {MOST_CASES} cases")
    for case in cases:
        if not isinstance(case, dict):
            raise ValueError(  # noqa: TRY004 - what pydantic collects
                "a named case is a mapping: `{id: small, params.size: 2 cm}`"
            )
    names = [case["id"] for case in cases if "id" in case]
    if any(not isinstance(name, str) for name in names):
        raise ValueError("an `id` must be text")
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"two cases are called `{name}`")
    return value


Parametrize = Annotated[dict[str, Any] | list[Any], AfterValidator(_grid_or_cases)]


class CaseKeys(SpecModel):
    """The keys of a scenario file that its cases, their seeds and their rate follow from."""

    seed: Annotated[Count, Field(ge=0, le=2**31 - 1)] = Field(
        default=0, description="The seed of everything random; each step's seed follows from it."
    )
    parametrize: Parametrize | None = Field(
        default=None,
        description="The cases: a grid `{robot.model: [ur3e, ur5e]}`, or a list of named cases: "
        "`[{id: small, params.size: 2 cm}, {id: large, params.size: 4 cm}]`.",
    )
    randomize: dict[str, Distribution] | None = Field(
        default=None,
        description="Dotted path -> distribution of that value. Items of lists go by index or by"
        " name: `objects.cube.pose.xyz.0`.",
    )
    samples: Annotated[Count, Field(ge=1, le=MOST_SAMPLES)] | None = Field(
        default=None,
        description="The number of random cases; the default is 20 where something is random.",
    )
    redraw_overlaps: Flag | None = Field(
        default=None,
        description="Draws a sample again, up to 100 times, while objects overlap at the start.",
    )
    expect_rate: RequiredRate | None = Field(
        default=None,
        description="The required success rate of the samples; without it every sample must pass.",
    )
    search: Annotated[KeyModel, PluginModel("search")] | None = Field(
        default=None,
        description="Settings of `harness search`, which looks for failures in the ranges of "
        "`randomize`.",
    )

    @property
    def sample_count(self) -> int:
        """The number of samples of each parametrised case; 0 where nothing is sampled."""
        return self.samples or (DEFAULT_SAMPLES if self.randomize else 0)

    @model_validator(mode="after")
    def _random_values(self) -> CaseKeys:
        if self.expect_rate is not None and not self.sample_count:
            raise ValueError("`expect_rate` needs more than one run; add `samples` or `randomize`")
        if self.redraw_overlaps and not self.randomize:
            raise ValueError("`redraw_overlaps` redraws the values of `randomize`; add `randomize`")
        if self.search is not None and not self.randomize:
            raise ValueError("`search` looks within the ranges of `randomize`; add `randomize`")
        return self

    @model_validator(mode="after")
    def _bounded_cases(self) -> CaseKeys:
        count = count_of(self.parametrize) * self.sample_count
        if count > MOST_SAMPLES:
            raise ValueError(f"{count} samples of all cases; at most {MOST_SAMPLES} are run")
        return self
