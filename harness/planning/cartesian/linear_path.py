"""Ways of a link in space, and the straight one of LIN and MoveRelative."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
import pinocchio as pin

from harness.core.spatial import SE3
from harness.core.types import FloatArray

POINT = 1e-6  # A shorter line is a point [m, rad]: a pose that the arm reached is exact within 1e-8
_NOWHERE = 1e-9  # [m, rad] no division by less


class LinkPath(ABC):
    """A link's way through space, its parameter running evenly from 0 to 1; the link turns evenly.

    Attributes:
        start: T_world_link at parameter 0.
        turn: Rotation vector from 0 to 1, world axes [rad].
        angle: Angle of the rotation [rad].
        length: Length of the way [m].
        radius: The radius of its curvature: a line has none [m].
    """

    name: ClassVar[str]

    def __init__(
        self, link: str, start: SE3, turn: FloatArray, length: float, radius: float = np.inf
    ) -> None:
        self.link, self.start, self.length, self.radius = link, start, length, radius
        self.turn = np.asarray(turn, dtype=float)
        self.angle = float(np.linalg.norm(self.turn))

    @property
    def is_point(self) -> bool:
        """Whether the link neither moves nor turns."""
        return self.length < POINT and self.angle < POINT

    def pose(self, parameter: float) -> SE3:
        """T_world_link at a parameter from 0 to 1."""
        return SE3(pin.exp3(parameter * self.turn) @ self.start.rotation, self.place(parameter))

    @abstractmethod
    def place(self, parameter: float) -> FloatArray:
        """The position of the link at a parameter from 0 to 1 [m]."""

    @abstractmethod
    def nearest(self, pose: SE3) -> tuple[float, float]:
        """The parameter at which the way comes nearest to a pose's origin, and its distance [m]."""


class LinearPath(LinkPath):
    """A link's way from one pose along a constant twist.

    Attributes:
        shift: Translation from 0 to 1, world axes [m].
    """

    name: ClassVar[str] = "line"

    def __init__(self, link: str, start: SE3, shift: FloatArray, turn: FloatArray) -> None:
        self.shift = np.asarray(shift, dtype=float)
        super().__init__(link, start, turn, float(np.linalg.norm(self.shift)))

    @classmethod
    def between(cls, link: str, start: SE3, end: SE3) -> LinearPath:
        """The straight line between two poses, turning the shortest way."""
        turn = pin.log3(end.rotation @ start.rotation.T)
        return cls(link, start, end.translation - start.translation, turn)

    def place(self, parameter: float) -> FloatArray:
        return self.start.translation + parameter * self.shift

    def part(self, share: float) -> LinearPath:
        """The line's first part."""
        return LinearPath(self.link, self.start, share * self.shift, share * self.turn)

    def nearest(self, pose: SE3) -> tuple[float, float]:
        """On a line without length it is the parameter of the nearest turn."""
        offset = pose.translation - self.start.translation
        if self.length > _NOWHERE:
            share = float(offset @ self.shift) / self.length**2
            return share, float(np.linalg.norm(offset - share * self.shift))
        distance = float(np.linalg.norm(offset))
        if self.angle < _NOWHERE:
            return 0.0, distance
        turned = pin.log3(pose.rotation @ self.start.rotation.T)
        return float(turned @ self.turn) / self.angle**2, distance
