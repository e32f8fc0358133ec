"""Forces by which grippers hold without closing, as plug-ins of the physics."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import mujoco

from harness.core.registry import Plugin, registry
from harness.core.types import FloatArray
from harness.robot.end_effector import Gripper
from harness.simulation.model import PhysicsModel


class Adhesion(Plugin, ABC):
    """The forces of all grippers that hold without closing, at each sample of a run."""

    plugin_kind: ClassVar[str] = "adhesion"

    @abstractmethod
    def __init__(self, physics: PhysicsModel, data: mujoco.MjData) -> None:
        """Find the grippers in the physics."""

    @abstractmethod
    def apply(self, row: int, *, anew: bool = False) -> None:
        """Set the forces at a sample from the poses of the one before, whose forces are known.

        Args:
            row: The sample, at which no forces are computed yet.
            anew: Whether contacts are looked at again, and not those of a sample before.
        """

    @abstractmethod
    def rewind(self, count: int) -> None:
        """Forget all samples after the first `count`."""

    @abstractmethod
    def held(self, row: int, gripper: Gripper) -> set[str]:
        """Names of the bodies that a gripper holds at a sample."""

    @abstractmethod
    def unsealed(self, row: int, gripper: Gripper) -> dict[str, str]:
        """Why each part of a gripper that holds nothing at a sample does not, by its name."""

    @abstractmethod
    def recorded(self, count: int) -> dict[tuple[str, str], FloatArray]:
        """Force of each link on each body and its touching quarters, shape (count, 4) each."""


def adhesion_of(physics: PhysicsModel, data: mujoco.MjData) -> Adhesion | None:
    """The forces of the suction cups of a robot; None where it has none."""
    if not any(gripper.cups for gripper in physics.description.grippers):
        return None
    return registry(Adhesion.plugin_kind).find("suction")(physics, data)
