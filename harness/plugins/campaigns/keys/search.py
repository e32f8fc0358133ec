"""The key `search` of a scenario."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from harness.core.variation import MOST_SAMPLES
from harness.language.base import Count
from harness.language.plugin_field import KeyModel


class SearchSpec(KeyModel):
    """How `harness search` looks for failures in the ranges of `randomize`.

    Options of the command take precedence. `harness run` does not search: it runs the samples.
    """

    key: ClassVar[str] = "search"

    runs: Annotated[Count, Field(ge=1, le=MOST_SAMPLES)] = Field(
        default=100, description="The number of runs, without those that shrink a failure."
    )
    start: Annotated[Count, Field(ge=1, le=MOST_SAMPLES)] = Field(
        default=32,
        description="The number of runs that are low-discrepancy samples, which show the rate.",
    )
    seed: Annotated[Count, Field(ge=0, le=2**31 - 1)] | None = Field(
        default=None,
        description="The seed of the search and of every run; the default is the file's `seed`.",
    )
    batch: Annotated[Count, Field(ge=2, le=1000)] | None = Field(
        default=None,
        description="The number of runs that the optimiser proposes together; the result depends "
        "on it. The default is 4 + 3 ln(number of parameters), rounded down.",
    )
    minimise: str | None = Field(
        default=None,
        description="The `name` of the expectation whose margin the optimiser minimises; the "
        "default is the worst margin of all.",
    )

    def expectation(self) -> tuple[str, str] | None:
        return None if self.minimise is None else ("minimise", self.minimise)
