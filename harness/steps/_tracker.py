"""How an arm moves to what a surface carries, picks from it and places onto it, as plug-ins."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import ClassVar

from harness.cell.cell import Cell
from harness.cell.grasp_choice import ChosenApproach
from harness.cell.program import ProgramStep
from harness.cell.scope import At
from harness.cell.step import Step
from harness.cell.watched_goals import Predicted, watched_goals
from harness.core.registry import Plugin, absent_plugins, registry
from harness.core.spatial import SE3
from harness.steps.grasp import Grasp
from harness.steps.move_relative import MoveRelative


class Tracker(Plugin, ABC):
    """Moves to objects in motion; picks and places in motion, for `track: true`."""

    plugin_kind: ClassVar[str] = "tracker"

    @staticmethod
    @abstractmethod
    def execute(spec: Step, cell: Cell) -> dict[str, Predicted]:
        """Carry out a step; a motion to where an object is carried ends when the object is there.

        Returns:
            Where the objects that are carried will be after a duration [s], by their names.

        Raises:
            StepFailed: The step cannot be carried out, or the arm cannot be there in time.
        """

    @staticmethod
    @abstractmethod
    def pick(
        grasp: Grasp, lift: MoveRelative, choose: Callable[[], ChosenApproach], cell: Cell
    ) -> None:
        """Meet an object, move with it while the fingers close, lift it, verify the grasp.

        Args:
            lift: The straight move after it.
            choose: Chooses the approach to the object where the cell expects it.
            cell: The cell with the object.

        Raises:
            PlanningFailed: The arm cannot meet the object.
            StepFailed: INVALID_OBJECT_NAME, when nothing carries it.
        """

    @staticmethod
    @abstractmethod
    def place(name: str, targets: Sequence[SE3], retreat: float, group: str, cell: Cell) -> None:
        """Lower an object at the speed of what is under it, open, go back, verify.

        Args:
            targets: T_world_object of each pose at which it may be let go.
            retreat: The length of the retreat along the gripper [m].
            cell: The cell with the surface under the places.

        Raises:
            PlanningFailed: The arm can follow the surface at none of the poses.
            StepFailed: INVALID_OBJECT_NAME, when no surface moves under them.
        """


def tracker() -> Tracker:
    """The plug-in that follows belts and turntables."""
    return registry(Tracker.plugin_kind).find("belt")()


def execute(step: ProgramStep, cell: Cell) -> None:
    """Carry out a step, with a plug-in where it moves an arm; may fail as `watched_goals` says."""
    with watched_goals([step], cell) as known:
        if step.spec.moves_arm and "belt" in registry(Tracker.plugin_kind):
            known |= tracker().execute(step.spec, cell)
        else:
            step.spec.execute(cell)


def check_track(track: bool, at: At) -> None:
    """Report `track: true` where no plug-in follows belts."""
    if track and "belt" not in registry(Tracker.plugin_kind):
        hint = "; ".join(absent_plugins())
        at.scope.problems.add(at.key("track"), "no plug-in tracks belts here", hint)
