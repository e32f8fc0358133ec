"""An SRDF for a robot: its groups and states, and the pairs that samples show need no checking."""

from __future__ import annotations

from dataclasses import replace

from harness.core.kinematics import LinkPoses
from harness.plugins.authoring.pair_statistics import SelfTouches
from harness.robot.description import RENAMED_ROOT, RobotDescription
from harness.robot.mechanism import WORLD
from harness.robot.srdf.srdf import link_pair, parse_srdf, write_srdf
from harness.robot.tree import is_rigid

SAME_AXES = 1e-6  # [rad] between axes that are the same


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
    stand_ins = _for_added_tcps(description)
    groups = tuple(
        group.with_links(lambda link: _own(stand_ins.get(link, link))) for group in srdf.groups
    )
    return write_srdf(name, replace(srdf, disabled=disabled, groups=groups))


def _for_added_tcps(description: RobotDescription) -> dict[str, str]:
    """Links of the robot's file for TCPs that importing added to it, which the file does not have.

    Each is rigidly connected with the TCP and has its axes, or else is the palm.
    """
    added = {f"{hand.group}_tcp": hand.palm_link for hand in description.grippers}
    added = {
        joint.child: added[joint.child]
        for joint in description.joints
        if joint.child in added and joint.name == f"{joint.child}_joint"
    }
    poses = LinkPoses(description.joints, description.start_positions()).at(0)
    found = dict(added)
    for tcp in added:
        aligned = [
            (poses[link].distance_to(poses[tcp])[0], link)
            for link in description.link_names
            if link not in added
            and is_rigid(description, link, tcp)
            and poses[link].distance_to(poses[tcp])[1] < SAME_AXES
        ]
        found[tcp] = min(aligned, default=(0.0, added[tcp]))[1]
    return found


def _own(link: str) -> str:
    """A link as the robot's file calls it: a root called as our world has another name here."""
    return WORLD if link == RENAMED_ROOT else link
