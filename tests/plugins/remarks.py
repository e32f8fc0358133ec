"""Steps of another package: a remark about an object, and a joint that moves by an angle."""

from dataclasses import dataclass
from typing import ClassVar

from pydantic import Field

from harness.steps import (
    Angle,
    At,
    Cell,
    Detail,
    JointMotion,
    Name,
    PositiveDuration,
    Step,
    group_of,
)


@dataclass(frozen=True)
class Remarked(Detail):
    """The sentence, as it is in the step's `result`."""

    text: str


class Remark(Step):
    """Write a sentence about an object into the run's record."""

    short = "text"
    verb: ClassVar[str] = "remark"
    results = (Remarked,)

    text: str = Field(description="The sentence that is written.")
    about: Name | None = Field(default=None, description="The object that the sentence is about.")
    pause: PositiveDuration = Field(default=0.02, description="The step takes this long [s].")

    def summary(self) -> str:
        return self.text

    def check(self, at: At) -> None:
        if self.about is not None:
            at.scope.check_object(self.about, at.key("about"))
        at.scope.take_time(self.pause, at.key("pause"))

    def execute(self, cell: Cell) -> None:
        cell.simulator.hold(self.pause)
        cell.report(Remarked(self.text))


class Jog(Step):
    """Move one joint by an angle."""

    verb: ClassVar[str] = "jog"
    moves_arm: ClassVar[bool] = True

    joint: Name = Field(description="The joint that moves.")
    by: Angle = Field(description="The joint moves by this angle [rad].")

    def summary(self) -> str:
        return f"{self.joint} by {self.by:g} rad"

    def check(self, at: At) -> None:
        at.scope.check_joint(self.joint, at.key("joint"), is_key=False)

    def execute(self, cell: Cell) -> None:
        group, start = group_of(cell, self.group), cell.planning_start()
        indices = list(cell.description.group_indices(group))
        goal = start.copy()
        goal[cell.description.joint_index[self.joint]] += self.by
        cell.move(group, JointMotion(goal[indices]))
