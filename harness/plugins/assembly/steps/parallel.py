"""parallel: the gripper moves while the arm does, or several arms work at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.details import Detail
from harness.language.files.source import Loc
from harness.language.step import STEPS, AnyStep, Block
from harness.plugins.assembly.at_once import AtOnce
from harness.steps.gripper import Gripper


@dataclass(frozen=True)
class Delays(Detail):
    """When the motion of each arm begins, in the order of the steps [s]."""

    delays: tuple[float, ...]


class Parallel(Step):
    """Run one motion of the arm and one `gripper` step at once, or steps of several arms.

    It ends when all of them have. Motions of several arms are planned one after the other, each
    around the ends of those before it; then each begins as soon as the timed motion of all arms is
    free of collisions, in tenths of the motion before it, at the latest when that has ended. The
    step reports the `delays`.

    A `pick` or `place` goes on in rounds: in each one the arms do their next motion at once, and
    what closes or opens a gripper follows. A motion that another arm is in the way of waits for the
    next round; when no arm can go on, the step fails with the pair of links and the moment.
    """

    short = "steps"
    short_is_list = True

    verb: ClassVar[str] = "parallel"
    plans: ClassVar[bool] = False
    is_at_once: ClassVar[bool] = True
    results = (Delays,)

    steps: Annotated[tuple[AnyStep, ...], Field(min_length=2)] = Field(
        description="One motion of the arm and one `gripper` step, or one motion, `pick` or "
        "`place` of each of several arms."
    )

    def summary(self) -> str:
        return " and ".join(child.verb for child in self.steps)

    def blocks(self, loc: Loc, path: str) -> Iterator[Block]:
        yield Block(self.steps, (*loc, "steps"), f"{path}.parallel")

    def check(self, at: At) -> None:
        grippers = sum(isinstance(child, Gripper) for child in self.steps)
        motions = sum(child.moves_arm for child in self.steps)
        made_of_parts = sum(child.is_made_of_parts for child in self.steps)
        if motions + made_of_parts == len(self.steps) and at.scope.description.arms:
            self._check_arms(at)
        elif len(self.steps) != 2 or grippers != 1 or motions != 1:
            verbs = sorted(verb for verb, step in STEPS.items() if step.moves_arm)
            at.scope.problems.add(
                at.key("steps"),
                "`parallel` is one motion of the arm and one `gripper` step, or one motion, `pick`"
                " or `place` without `track` of each of several arms",
                "arm motions: " + ", ".join(verbs),
            )
        for index, child in enumerate(self.steps):
            if child.expect_error is not None:
                at.scope.problems.add(
                    at.key("steps", index, "expect_error"),
                    "a step of `parallel` cannot be expected to fail",
                    "say `expect_error` of the `parallel` step",
                )

    def _check_arms(self, at: At) -> None:
        """Report motions that are not of different arms."""
        seen: set[str] = set()
        for index, child in enumerate(self.steps):
            arm = at.scope.arm_of(child.robot, child.group, at.key("steps", index))
            if not arm or arm in seen:
                whose = f"two motions of '{arm}'" if arm else "a motion that is of no single arm"
                at.scope.problems.add(
                    at.key("steps", index),
                    f"{whose} cannot run at once with others",
                    "give each motion an arm of its own with `robot`, or put the steps one after"
                    " the other",
                )
            seen.add(arm)

    def execute(self, cell: Cell) -> None:
        """Start the gripper with the arm and wait for both; or follow the arms' motions at once."""
        children = cell.current.children
        for child in children:
            if isinstance(child.spec, Gripper):
                with cell.inside(child):
                    target, effort = child.spec.command(cell)
                    cell.simulator.start_gripper(target, effort, cell.gripper.joint)
                return cell.run_children(sorted(children, key=lambda each: each is child))
        cell.report(Delays(AtOnce(cell, children).run()))
        return None
