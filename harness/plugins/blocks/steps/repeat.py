"""repeat: the same steps several times."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.step import Step
from harness.core.details import Detail
from harness.language.base import Count
from harness.language.files.source import Loc
from harness.language.step import AnyStep, Block


@dataclass(frozen=True)
class Times(Detail):
    """How many times the steps run."""

    times: int


class Repeat(Step):
    """Run the same steps several times; an `id` inside gets `#1`, `#2` ... appended to it."""

    verb: ClassVar[str] = "repeat"
    plans: ClassVar[bool] = False
    synonyms = ("loop", "for")
    results = (Times,)

    times: Annotated[Count, Field(ge=1, le=1000)] = Field(
        description="The steps run this many times."
    )
    steps: Annotated[tuple[AnyStep, ...], Field(min_length=1)] = Field(
        description="The steps that are repeated."
    )

    def summary(self) -> str:
        return f"{self.times} times" if self.times > 1 else ""

    def blocks(self, loc: Loc, path: str) -> Iterator[Block]:
        for index in range(self.times):
            suffix = f"#{index + 1}" if self.times > 1 else ""
            yield Block(self.steps, (*loc, "steps"), f"{path}.repeat[{index}]", suffix)

    def execute(self, cell: Cell) -> None:
        """Run every time through; each step has a seed and a record of its own."""
        cell.report(Times(self.times))
        cell.run_children()
