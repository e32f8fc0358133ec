"""parallel: the gripper moves while the arm does."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.language.files.source import Loc
from harness.language.step import STEPS, AnyStep, Block, Step
from harness.steps.gripper import Gripper


class Parallel(Step):
    """Run one motion of the arm and one `gripper` step at once, until both have ended."""

    short = "steps"
    short_is_list = True

    verb: ClassVar[str] = "parallel"

    steps: Annotated[tuple[AnyStep, ...], Field(min_length=2)] = Field(
        description="One motion of the arm and one `gripper` step."
    )

    def summary(self) -> str:
        return " and ".join(child.verb for child in self.steps)

    def blocks(self, loc: Loc, path: str) -> Iterator[Block]:
        yield Block(self.steps, (*loc, "steps"), f"{path}.parallel")

    def check(self, at: At) -> None:
        grippers = sum(isinstance(child, Gripper) for child in self.steps)
        if len(self.steps) != 2 or grippers != 1 or not any(c.moves_arm for c in self.steps):
            motions = sorted(verb for verb, step in STEPS.items() if step.moves_arm)
            at.scope.problems.add(
                at.key("steps"),
                "`parallel` is one motion of the arm and one `gripper` step",
                "arm motions: " + ", ".join(motions),
            )
        for index, child in enumerate(self.steps):
            if child.expect_error is not None:
                at.scope.problems.add(
                    at.key("steps", index, "expect_error"),
                    "a step of `parallel` cannot be expected to fail",
                    "say `expect_error` of the `parallel` step",
                )

    def execute(self, cell: Cell) -> None:
        """Start the gripper with the arm; then wait until it has arrived or stalled as well."""
        gripper = next(child for child in self.steps if isinstance(child, Gripper))
        target, effort = gripper.command(cell)
        cell.simulator.start_gripper(target, effort, cell.gripper.joint)
        children = cell.current.children
        motion_first = sorted(children, key=lambda child: isinstance(child.spec, Gripper))
        cell.run_children(motion_first)
