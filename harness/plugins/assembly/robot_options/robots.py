"""The option `robots`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from harness.robot.description import RobotDescription
from harness.robot.robot_option import RobotOption


class SeveralArms(RobotOption):
    """Several robots as the arms of one."""

    name: ClassVar[str] = "robots"

    def joined(self, robots: Mapping[str, RobotDescription]) -> RobotDescription:
        """One robot of several."""
        from harness.plugins.assembly.arm_bases import refuse_overlapping_bases
        from harness.plugins.assembly.several_arms import joined_arms

        joined = joined_arms(robots)
        refuse_overlapping_bases(joined)
        return joined
