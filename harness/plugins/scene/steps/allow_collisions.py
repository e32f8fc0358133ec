"""allow_collisions: pairs may touch while the nested steps run."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Annotated, ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.language.base import Name
from harness.language.files.source import Loc
from harness.language.step import AnyStep, Block
from harness.recording.step_results import AllowedCollisions

SPECIAL_BODIES = ("robot", "gripper")


class AllowCollisions(Step):
    """Allow collisions of pairs while the nested steps run."""

    verb: ClassVar[str] = "allow_collisions"
    plans: ClassVar[bool] = False
    results = (AllowedCollisions,)

    pairs: Annotated[tuple[tuple[Name, Name], ...], Field(min_length=1)] = Field(
        description="Pairs of names of links or objects that may touch; `gripper`: all its links;"
        " the name of one of several arms: its links and its gripper."
    )
    during: Annotated[tuple[AnyStep, ...], Field(min_length=1)] = Field(
        description="The steps during which the pairs may touch."
    )

    def summary(self) -> str:
        return ", ".join(f"{a}-{b}" for a, b in self.pairs)

    def blocks(self, loc: Loc, path: str) -> Iterator[Block]:
        yield Block(self.during, (*loc, "during"), f"{path}.during")

    def check(self, at: At) -> None:
        if any("gripper" in pair for pair in self.pairs):
            at.scope.check_gripper(at.key("pairs"), "`gripper`")
        for index, pair in enumerate(self.pairs):
            for side, name in enumerate(pair):
                at.scope.check_body(name, at.key("pairs", index, side), special=SPECIAL_BODIES)

    def execute(self, cell: Cell) -> None:
        """Allow the pairs, run the nested steps, and check the pairs again, whatever happened."""
        pairs = tuple(
            (first, second)
            for pair in self.pairs
            for first, second in product(*(_bodies(name, cell) for name in pair))
            if first != second
        )
        cell.report(AllowedCollisions(pairs))
        cell.scene.set_allowed(pairs, allowed=True)
        cell.allowed.append(pairs)
        try:
            cell.run_children()
        finally:
            cell.allowed.pop()
            cell.scene.set_allowed(pairs, allowed=False)
            for around in cell.allowed:  # may name the same pairs
                cell.scene.set_allowed(around, allowed=True)


def _bodies(name: str, cell: Cell) -> tuple[str, ...]:
    """The bodies that a name stands for in the planning scene; of an arm, its hand included."""
    if name in cell.robot.of_arm:
        return tuple(link for link, arm in cell.robot.arm_of_link.items() if arm == name)
    return (cell.gripper.palm_link, *cell.gripper.links) if name == "gripper" else (name,)
