"""What every step is: the keys next to its verb, and what its class must provide."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from harness.core.amounts import JointUnits
from harness.core.details import Detail
from harness.core.errors import ErrorCode
from harness.core.registry import HAS_DOCSTRINGS, Registry, registry
from harness.language.base import Name, PositiveDuration, SpecModel
from harness.language.expectation import AnyExpectation, ExpectationFields
from harness.language.files.source import Loc
from harness.language.planning import Planning
from harness.language.plugin_field import PluginField
from harness.language.world import ObjectSpec

if TYPE_CHECKING:  # of what steps work with, which is built on the language
    from harness.cell.cell import Cell
    from harness.cell.program import ProgramStep
    from harness.cell.scope import At

TAG = "do"  # in the shape of the models, the key of a step's verb


@dataclass(frozen=True)
class Block:
    """Steps inside a step, one time through.

    Attributes:
        loc: The location of the list in the file.
        path: The path of the list in the expanded file: `steps[2].repeat[0]`.
        suffix: Appended to the ids of the steps where they run more than once: `#2`.
    """

    steps: Sequence[Step]
    loc: Loc
    path: str
    suffix: str = ""


class Step(SpecModel):
    """A step of a scenario: a subclass for each verb says, checks and does all of it.

    The docstring of a subclass is the step's text in the reference and in editors.

    Attributes:
        verb: The key of the step in a file; empty in classes that several steps share.
        synonyms: What other programs call the step; an error suggests the verb for them.
        moves_arm: Whether the step is one motion of the arm, which `parallel` can combine with a
            `gripper` step.
        has_corners: Whether that motion passes several points or goals.
        is_arc: Whether that motion is an arc, which three of its points determine.
        moves_gripper: Whether the step commands the gripper while the arm keeps its place.
        keeps_arm_still: Whether the arm keeps its place during the step.
        moves_objects: Whether the step lets objects appear, vanish or jump.
        detaches_object: Whether the step detaches what the gripper holds.
        keys_inside: Keys next to the verb that may stand inside its content as well.
        results: The types of the parts that the step reports with `cell.report`, besides those of
            the cell's own methods; a saved run is read back with them.
    """

    plugin_kind: ClassVar[str] = "step"
    verb: ClassVar[str] = ""
    synonyms: ClassVar[tuple[str, ...]] = ()
    moves_arm: ClassVar[bool] = False
    has_corners: ClassVar[bool] = False
    is_arc: ClassVar[bool] = False
    moves_gripper: ClassVar[bool] = False
    keeps_arm_still: ClassVar[bool] = False
    moves_objects: ClassVar[bool] = False
    detaches_object: ClassVar[bool] = False
    keys_inside: ClassVar[tuple[str, ...]] = ()
    results: ClassVar[tuple[type[Detail], ...]] = ()

    id: Name | None = Field(
        default=None,
        description="A unique name by which expectations (`during`) and reports refer to the step.",
    )
    name: str | None = Field(
        default=None, description="A title for people, in place of the generated summary."
    )
    group: Name | None = Field(
        default=None, description="The SRDF planning group that moves; the default is the arm's."
    )
    robot: Name | None = Field(
        default=None,
        description="The arm that carries out the step, of a robot with several; its name is that "
        "of its planning group. A `group` of one arm says so too.",
    )
    expect: tuple[AnyExpectation, ...] = Field(
        default=(), description="Expectations that are judged over this step."
    )
    expect_error: ErrorCode | None = Field(
        default=None,
        description="The step must fail with this name of moveit_msgs/MoveItErrorCodes.",
    )
    timeout: PositiveDuration | None = Field(
        default=None, description="The step fails when it takes longer, in simulated seconds."
    )
    planning: Planning | None = Field(
        default=None, description="Planning parameters that override the scenario's `planning`."
    )

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Refuse a class that lacks something a step must have, when it is defined."""
        verb = cls.plugin_name()
        if not verb:
            return
        reserved = {*Step.model_fields, TAG}
        if not verb.isidentifier() or verb in reserved:
            raise TypeError(f"`{verb}` cannot be a step's verb: it is no word, or a key of steps")
        if not cls.__doc__ and HAS_DOCSTRINGS:
            raise TypeError(f"the step `{verb}` has no docstring, which is its reference text")
        if TAG in cls.model_fields or cls.execute is Step.execute:
            raise TypeError(f"the step `{verb}` needs an `execute` method, and no field `{TAG}`")

    @classmethod
    def plugin_name(cls) -> str:
        """The verb that this class is registered under; empty for what several steps share."""
        return cls.__dict__.get("verb", "")

    def title(self, units: JointUnits) -> str:
        """One line for a person: `move_to mogi_home`."""
        return f"{self.verb} {self.name or self.summary_in(units)}".rstrip()

    def summary(self) -> str:
        """The step's content in a few words."""
        return ""

    def summary_in(self, units: JointUnits) -> str:  # noqa: ARG002 - subclasses read it
        """The step's content in a few words, where joint positions have units of the robot."""
        return self.summary()

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

    @property
    def is_made_of_parts(self) -> bool:
        """Whether the step carries out `parts`, which `parallel` combines with another arm's."""
        return False

    def parts(self, cell: Cell) -> Generator[ProgramStep]:
        """The steps that the step is made of.

        What has to be planned is planned before the first one; each of the others may be requested
        before those in front of it are carried out.

        Raises:
            StepFailed: The step cannot be carried out.
        """
        raise NotImplementedError(self.verb)

    def ends(self) -> Iterator[ExpectationFields]:
        """Expectations that the step evaluates itself, to end when one of them passes."""
        return iter(())

    def new_objects(self) -> Iterator[tuple[Loc, ObjectSpec]]:
        """Objects that the step adds to the scene, each with its place in the step."""
        return iter(())

    def blocks(self, loc: Loc, path: str) -> Iterator[Block]:
        """Steps inside the step: a block for each time through."""
        del loc, path
        return iter(())


STEPS: Registry[type[Step]] = registry(Step.plugin_kind)  # the class of every verb


def step_class(verb: str) -> type[Step]:
    """The class of a recorded step; `Step`, which states no facts, where it is not installed."""
    return STEPS.get(verb, Step)


AnyStep = Annotated[Step, PluginField(Step.plugin_kind, TAG)]
