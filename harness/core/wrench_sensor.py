"""A sensor of force and torque between two links of a robot, with all parameters resolved."""

from __future__ import annotations

from dataclasses import dataclass, field

from harness.core.spatial import SE3


@dataclass(frozen=True, eq=False)
class WrenchSensor:
    """Measures the wrench with which a link, and all that it carries, acts on the link before it.

    Attributes:
        name: The name, unique in a run.
        link: The first link that it carries; the sensor is in the joint before this link.
        pose: T_link_sensor; force and torque are in its axes, the torque about its origin.
        rate: Readings in a second [Hz]; inf for one at every physics sample.
        force_noise: Standard deviation of each component of the force [N].
        torque_noise: Standard deviation of each component of the torque [N m].
    """

    name: str
    link: str
    pose: SE3 = field(default_factory=SE3.identity)
    rate: float = float("inf")
    force_noise: float = 0.0
    torque_noise: float = 0.0

    @property
    def frame_id(self) -> str:
        """The frame of its messages: its link, where it has the link's frame."""
        is_link = self.pose.distance_to(SE3.identity()) == (0.0, 0.0)
        return self.link if is_link else f"{self.name}_wrench_frame"
