"""Steps inside steps: where they stand, and what they are called each time they are run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from harness.spec.source import Loc
from harness.spec.steps import AllowCollisions, AnyStep, Parallel, Repeat


@dataclass(frozen=True)
class Block:
    """Steps that a step is made of, one time through.

    Attributes:
        steps: In order.
        loc: Of the list in the file.
        path: Of the list in the expanded file: `steps[2].repeat[0]`.
        suffix: Behind the ids of its steps where they run more than once: `#2`.
    """

    steps: Sequence[AnyStep]
    loc: Loc
    path: str
    suffix: str = ""


def blocks(step: AnyStep, loc: Loc, path: str) -> Iterator[Block]:
    """What a step is made of: nothing for most, a block for each time through for `repeat`."""
    match step:
        case AllowCollisions():
            yield Block(step.during, (*loc, "during"), f"{path}.during")
        case Parallel():
            yield Block(step.steps, (*loc, "steps"), f"{path}.parallel")
        case Repeat():
            for index in range(step.times):
                suffix = f"#{index + 1}" if step.times > 1 else ""
                yield Block(step.steps, (*loc, "steps"), f"{path}.repeat[{index}]", suffix)
        case _:
            pass
