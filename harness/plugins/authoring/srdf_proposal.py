"""An SRDF for a robot: its groups and states, and the pairs that samples show need no checking."""

from __future__ import annotations

from dataclasses import replace

from harness.planning.collision.pair_statistics import SelfTouches
from harness.robot.import_robot import RENAMED_ROOT
from harness.robot.srdf.srdf import link_pair, parse_srdf, write_srdf

WORLD = "world"


def proposed_srdf(touches: SelfTouches, name: str) -> str:
    """The SRDF as text: what the robot has, with the proposed pairs in place of its own.

    Args:
        touches: The links that touched at random configurations.
        name: The name of the robot, as its URDF has it.
    """
    description = touches.description
    srdf = parse_srdf(description.srdf, description.name)
    disabled = {
        link_pair(_own(first), _own(second)): str(reason)
        for (first, second), reason in touches.proposed().items()
    }
    groups = tuple(group.with_links(_own) for group in srdf.groups)
    return write_srdf(name, replace(srdf, disabled=disabled, groups=groups))


def _own(link: str) -> str:
    """A link as the robot's file calls it: a root called as our world has another name here."""
    return WORLD if link == RENAMED_ROOT else link
