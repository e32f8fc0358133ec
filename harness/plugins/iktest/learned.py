"""What the answers of a function have in common: its convention, and an error at every target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from harness.core.types import FloatArray
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.convention import Convention
from harness.plugins.iktest.offset import Offset, common_offset
from harness.plugins.iktest.strategies.poses import Target
from harness.plugins.iktest.strategies.tasks import Task, miss


@dataclass(frozen=True, eq=False)
class Learned:
    """How right the answers to some targets are by a convention.

    Attributes:
        convention: How the function counts.
        offset: The error that many answers share; None without one.
        right: The number of answers that reach their targets.
        shifted: The number of answers that miss them by the offset.
        answers: The number of answers.
        targets: The number of targets that are answered.
    """

    convention: Convention
    offset: Offset | None
    right: int
    shifted: int
    answers: int
    targets: int

    @classmethod
    def of(
        cls,
        chain: Chain,
        task: Task,
        tolerances: tuple[float, float],
        pairs: Sequence[tuple[Target, FloatArray]],
        convention: Convention,
    ) -> Learned:
        """What answers show.

        Args:
            tolerances: The largest error of position [m] and orientation [rad].
            pairs: Targets and answers, converted by the convention.
        """
        poses = [(target.pose, chain.link_pose(answer)) for target, answer in pairs]
        errors = (miss(task, *each) for each in poses)
        is_wrong = [shift > tolerances[0] or turn > tolerances[1] for shift, turn in errors]
        misses = [each for each, wrong in zip(poses, is_wrong, strict=True) if wrong]
        offset = common_offset(task, misses)
        if offset and len(misses) < len(pairs):
            offset = replace(offset, is_everywhere=False)
        shifted = sum(offset.explains(task, *each) for each in misses) if offset else 0
        targets = len({id(target) for target, _ in pairs})
        return cls(convention, offset, len(pairs) - len(misses), shifted, len(pairs), targets)

    @property
    def share(self) -> float:
        """Share of the answers that are right, or would be without the common error."""
        return (self.right + self.shifted) / max(self.answers, 1)

    def text(self, chain: Chain) -> str:
        """The kind of flaw that another convention is."""
        count = self.right + self.shifted
        which = (
            "every answer is" if count == self.answers else f"{count} of {self.answers} answers are"
        )
        but = f", but {self.offset.text()}" if self.offset else ""
        return f"counts otherwise: {which} right when {self.convention.text(chain)}{but}"
