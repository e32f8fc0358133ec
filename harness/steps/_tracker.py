"""How an arm picks from a surface that moves and places onto one, as plug-ins."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import ClassVar, Protocol

from harness.cell.cell import Cell
from harness.cell.grasp_choice import ChosenApproach
from harness.cell.scope import At
from harness.core.registry import Plugin, absent_plugins, registry
from harness.core.spatial import SE3
from harness.steps.grasp import Grasp
from harness.steps.move_relative import MoveRelative


class Carried(Protocol):
    """An object that the surface of a belt or turntable carries."""

    @property
    def belt(self) -> str:
        """The name of what carries it."""
        ...

    @property
    def speed(self) -> float:
        """The speed of the object now [m/s]."""
        ...

    def pose(self, duration: float) -> SE3:
        """T_world_object after a duration [s]."""
        ...

    def is_on(self, duration: float) -> bool:
        """Whether the surface still carries the object after a duration [s]."""
        ...


class Tracker(Plugin, ABC):
    """Picks and places in motion, for `track: true`."""

    plugin_kind: ClassVar[str] = "tracker"

    @abstractmethod
    def carried(self, name: str, cell: Cell) -> Carried | None:
        """What carries an object now; None where it stands."""

    @abstractmethod
    def pick(
        self, grasp: Grasp, lift: MoveRelative, choose: Callable[[], ChosenApproach], cell: Cell
    ) -> None:
        """Meet an object, move with it while the fingers close, lift it, verify the grasp.

        Args:
            grasp: The grasp, with the name of the object.
            lift: The straight move after it.
            choose: Chooses the approach to the object where the cell expects it.
            cell: The cell with the object.

        Raises:
            PlanningFailed: The arm cannot meet the object.
            StepFailed: INVALID_OBJECT_NAME, when nothing carries it.
        """

    @abstractmethod
    def place(
        self, name: str, targets: Sequence[SE3], retreat: float, group: str, cell: Cell
    ) -> None:
        """Lower an object at the speed of what is under it, open, go back, verify.

        Args:
            name: The object that is held.
            targets: T_world_object of each pose at which it may be let go.
            retreat: The length of the retreat along the gripper [m].
            group: The name of the planning group.
            cell: The cell with the surface under the places.

        Raises:
            PlanningFailed: The arm can follow the surface at none of the poses.
            StepFailed: INVALID_OBJECT_NAME, when no surface moves under them.
        """


def tracker() -> Tracker:
    """The plug-in that follows belts and turntables."""
    return registry(Tracker.plugin_kind).find("belt")()


def carried(name: str, cell: Cell) -> Carried | None:
    """What carries an object now; None where it stands, or where no plug-in follows belts."""
    presence = cell.presence[name]
    is_free = presence.is_there and presence.obj.in_simulation and not presence.obj.is_static
    moving = [each for each in cell.presence.values() if each.obj.surface_motion is not None]
    is_held = name in cell.scene.attached() or name not in cell.scene.object_names()
    if not (is_free and moving) or is_held or "belt" not in registry(Tracker.plugin_kind):
        return None
    return tracker().carried(name, cell)


def check_track(track: bool, at: At) -> None:
    """Report `track: true` where no plug-in follows belts."""
    if track and "belt" not in registry(Tracker.plugin_kind):
        hint = "; ".join(absent_plugins())
        at.scope.problems.add(at.key("track"), "no plug-in tracks belts here", hint)
