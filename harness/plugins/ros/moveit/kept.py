"""Whether joint positions keep path constraints, constraint by constraint."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from harness.cell.cell import Cell
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.ports.goals import PathConstraints

ROUNDING = 1e-6
"""What a value may exceed its bound [rad or m]."""


@dataclass(frozen=True)
class Kept:
    """A constraint at joint positions.

    Attributes:
        what: What is constrained, for people.
        excess: The most by which a value exceeds its bound [rad or m]; negative inside.
    """

    what: str
    excess: float

    @property
    def holds(self) -> bool:
        """Whether the constraint is kept."""
        return self.excess <= ROUNDING


def kept(cell: Cell, constraints: PathConstraints | None, positions: FloatArray) -> list[Kept]:
    """Each constraint at joint positions in description order."""
    return [] if constraints is None else [*_each(cell, constraints, positions)]


def _each(cell: Cell, constraints: PathConstraints, positions: FloatArray) -> Iterator[Kept]:
    index = cell.description.joint_index
    for band in constraints.joints:
        at = positions[index[band.joint]]
        yield Kept(f"joint '{band.joint}'", float(max(band.lower - at, at - band.upper)))
    if box := constraints.position:
        here = _pose(cell, box.link, positions).translation
        off = np.abs(box.pose.inverse().apply(here)) - np.array(box.size) / 2
        yield Kept(f"position of '{box.link}'", float(off.max()))
    if turn := constraints.orientation:
        back = turn.rotation.T @ _pose(cell, turn.link, positions).rotation
        angles = np.abs(Rotation.from_matrix(back).as_rotvec())
        off = np.where(np.array(turn.tolerance) >= np.pi, -np.pi, angles - turn.tolerance)
        yield Kept(f"orientation of '{turn.link}'", float(off.max()))


def _pose(cell: Cell, name: str, positions: FloatArray) -> SE3:
    """T_world_link of a link or of an attached object."""
    if name in cell.scene.attached():
        return cell.scene.object_pose(name, positions)
    return cell.kinematics.link_pose(positions, name)
