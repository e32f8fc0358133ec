"""Grippers: two finger sides closed by one joint, or suction cups with one valve."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray


@dataclass(frozen=True)
class Cup:
    """A suction cup: a rigid rim with a lip that closes gaps.

    Attributes:
        name: Its name in the robot.yaml.
        link: Its link, whose z axis leaves the gripper; z = 0 is the plane of the rim.
        radius: The radius of the rim [m].
        lip: The largest gap between rim and surface that it closes [m].
        depth: How far a surface may bulge into it [m].
    """

    name: str
    link: str
    radius: float
    lip: float
    depth: float

    @property
    def area(self) -> float:
        """The area inside the rim [m^2]."""
        return math.pi * self.radius**2


def seal_words(quarters: int | None) -> str:
    """Why a cup holds nothing: the quarters of its rim that touch a body; None: it is near none."""
    if not quarters:
        return "its rim touches nothing"
    if quarters < 4:
        return f"{quarters} of 4 quarters of the rim touch"
    return "the whole rim touches, and air enters inside it, as over a hole"


@dataclass(frozen=True, eq=False)
class Gripper:
    """Two finger sides closed by one joint, or suction cups with one valve.

    Of cups each one is a side; the joint is that of the valve, closed position: suction is on.

    Attributes:
        group: The name of its SRDF group.
        joint: The actuated joint; others mimic it.
        sides: Links of each of the two finger sides, by side name.
        pads: The link of each side that touches a grasped object, by side name.
        palm_link: The link that carries the fingers.
        open_position: Joint position with the fingers widest apart.
        closed_position: Joint position with the fingers closest.
        grip_effort: Effort of the joint when no `max_effort` is given.
        max_effort: Largest effort of the joint.
        widths: Rows (joint position, pad gap [m]) with rising position, shape (N, 2); for `width`.
        friction: Sliding friction coefficient of the pads.
        approach_axis: Unit approach axis in the TCP frame, shape (3,); None for the one that
            `harness.cell.approach` derives.
        cups: The suction cups; none of a gripper with fingers.
        vacuum: The pressure below the atmosphere's in sealed cups with the valve open [Pa].
    """

    group: str
    joint: str
    sides: Mapping[str, tuple[str, ...]]
    pads: Mapping[str, str]
    palm_link: str
    open_position: float
    closed_position: float
    grip_effort: float
    max_effort: float
    widths: FloatArray
    friction: float = 1.0
    approach_axis: FloatArray | None = None
    cups: tuple[Cup, ...] = ()
    vacuum: float = 0.0

    @property
    def holding_force(self) -> float:
        """The force with which all cups together hold a flat face [N]."""
        return self.vacuum * sum(cup.area for cup in self.cups)

    @property
    def links(self) -> tuple[str, ...]:
        """Finger links of both sides: the default touch_links of attached objects."""
        return tuple(link for side in self.sides.values() for link in side)

    def gap_at(self, positions: FloatArray | float) -> FloatArray:
        """The gap between the pads at positions of the joint [m]."""
        rows = self.widths[np.argsort(self.widths[:, 0])]
        return np.asarray(np.interp(positions, rows[:, 0], rows[:, 1]))

    @property
    def has_single_jaw(self) -> bool:
        """Whether a jaw closes on the palm, which is then one of the pads."""
        return self.palm_link in self.pads.values()
