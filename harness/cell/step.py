"""What a step is made of: what a file says of it, how it is checked, and what it does."""

from __future__ import annotations

from collections.abc import Generator
from typing import TYPE_CHECKING, Any

from harness.core.registry import HAS_DOCSTRINGS
from harness.language.step import TAG, StepFields

if TYPE_CHECKING:  # what steps work with knows the steps of a program
    from harness.cell.cell import Cell
    from harness.cell.program import ProgramStep
    from harness.cell.scope import At


class Step(StepFields):
    """A step of a scenario: a subclass for each verb says, checks and does all of it.

    The docstring of a subclass is the step's text in the reference and in editors.
    """

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Refuse a class that lacks something a step must have, when it is defined."""
        verb = cls.plugin_name()
        if not verb:
            return
        reserved = {*StepFields.model_fields, TAG}
        if not verb.isidentifier() or verb in reserved:
            raise TypeError(f"`{verb}` cannot be a step's verb: it is no word, or a key of steps")
        if not cls.__doc__ and HAS_DOCSTRINGS:
            raise TypeError(f"the step `{verb}` has no docstring, which is its reference text")
        if TAG in cls.model_fields or cls.execute is Step.execute:
            raise TypeError(f"the step `{verb}` needs an `execute` method, and no field `{TAG}`")

    def check(self, at: At) -> None:
        """Report what is wrong with the step, then change the scope as the step will.

        Args:
            at: What exists at this point of the file, and the step's place in it.
        """

    def execute(self, cell: Cell) -> None:
        """Do what the step says; `harness check` calls this with a cell that moves nothing.

        Args:
            cell: The robot, the planning scene, the planner and the simulator.

        Raises:
            StepFailed: The step cannot be carried out.
        """
        raise NotImplementedError(self.verb)

    def parts(self, cell: Cell) -> Generator[ProgramStep]:
        """The steps that the step is made of.

        What has to be planned is planned before the first one; each of the others may be requested
        before those in front of it are carried out.

        Raises:
            StepFailed: The step cannot be carried out.
        """
        raise NotImplementedError(self.verb)


def as_step(spec: StepFields) -> Step:
    """A file's step as what can be checked and carried out.

    Raises:
        TypeError: The class of its verb is no step.
    """
    if not isinstance(spec, Step):
        raise TypeError(f"{type(spec).__name__} is no subclass of Step")
    return spec
