"""What a file says of every step: the keys next to its verb."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

from pydantic import Field

from harness.core.amounts import JointUnits
from harness.core.details import Detail
from harness.core.errors import ErrorCode
from harness.core.registry import Registry, registry
from harness.language.base import Name, PositiveDuration, SpecModel
from harness.language.expectation import AnyExpectation, ExpectationFields
from harness.language.files.source import Loc
from harness.language.planning import Planning
from harness.language.plugin_field import PluginField
from harness.language.world import ObjectSpec

TAG = "do"  # in the shape of the models, the key of a step's verb


@dataclass(frozen=True)
class Block:
    """Steps inside a step, one time through.

    Attributes:
        path: The path of the list in the expanded file: `steps[2].repeat[0]`.
        suffix: Appended to the ids of the steps where they run more than once: `#2`.
    """

    steps: Sequence[StepFields]
    loc: Loc
    path: str
    suffix: str = ""


class StepFields(SpecModel):
    """The keys that any step may have; `harness.cell.step.Step` is what a step is made of.

    Attributes:
        verb: The key of the step in a file; empty in classes that several steps share.
        synonyms: What other programs call the step; an error suggests the verb for them.
        plans: Whether the step plans motions; `planning` has no effect on one that does not.
        moves_arm: Whether the step is one motion of the arm, which `parallel` can combine with a
            `gripper` step.
        has_corners: Whether that motion passes several points or goals.
        is_arc: Whether that motion is an arc, which three of its points determine.
        moves_gripper: Whether the step commands the gripper while the arm keeps its place.
        moves_objects: Whether the step lets objects appear, vanish or jump.
        is_at_once: Whether the steps inside it are carried out at once.
        simulated_only: Why no real robot can carry the step out, and what a user does instead; None
            where one can. `harness run --robot ros2` refuses it with both.
        keys_inside: Keys next to the verb that may stand inside its content as well.
        results: The types of the parts that the step reports with `cell.report`, besides those of
            the cell's own methods; a saved run is read back with them.
    """

    plugin_kind: ClassVar[str] = "step"
    verb: ClassVar[str] = ""
    synonyms: ClassVar[tuple[str, ...]] = ()
    plans: ClassVar[bool] = True
    moves_arm: ClassVar[bool] = False
    has_corners: ClassVar[bool] = False
    is_arc: ClassVar[bool] = False
    moves_gripper: ClassVar[bool] = False
    keeps_arm_still: ClassVar[bool] = False
    moves_objects: ClassVar[bool] = False
    is_at_once: ClassVar[bool] = False
    detaches_object: ClassVar[bool] = False
    simulated_only: ClassVar[tuple[str, str] | None] = None
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

    @property
    def is_made_of_parts(self) -> bool:
        """Whether the step carries out `parts`, which `parallel` combines with another arm's."""
        return False

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


STEPS: Registry[type[StepFields]] = registry(StepFields.plugin_kind)  # the class of every verb


def step_class(verb: str) -> type[StepFields]:
    """The class of a recorded step; one that states no facts where it is not installed."""
    return STEPS.get(verb, StepFields)


AnyStep = Annotated[StepFields, PluginField(StepFields.plugin_kind, TAG)]
