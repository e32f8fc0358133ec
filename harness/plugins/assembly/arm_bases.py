"""Refuses arms whose bases stand inside each other: nothing that moves could show it."""

from __future__ import annotations

from itertools import combinations, product

from harness.core.errors import RobotOptionError
from harness.core.kinematics import LinkPoses
from harness.robot.description import RobotDescription
from harness.session.observation.body_tracks import MovingBody, link_track, links_with_shapes
from harness.session.observation.nearest import pairs_between

LEAST_DEPTH = 0.001  # convex hulls are off by as much; less is no overlap [m]


def refuse_overlapping_bases(robot: RobotDescription) -> None:
    """Refuse arms of `robots` whose links that never move overlap.

    Raises:
        RobotOptionError: Two do; at the second one's `base`.
    """
    shapes = links_with_shapes({link.name: link.collisions for link in robot.links})
    poses = LinkPoses(robot.joints, robot.start_positions()[None])
    fixed = {arm.name: _fixed_links(robot, arm.base_link) & shapes.keys() for arm in robot.arms}
    for first, second in combinations(fixed, 2):
        for one, other in product(sorted(fixed[first]), sorted(fixed[second])):
            bodies = [MovingBody(shapes[name], link_track(poses, name)) for name in (one, other)]
            near = pairs_between([bodies[0]], bodies[1], 0.0)  # none where the boxes are apart
            depth = -min((pair.distance(0) for pair in near), default=0.0)
            if depth > LEAST_DEPTH:
                message = (
                    f"'{first}' and '{second}' stand inside each other: {one} and {other} overlap"
                    f" by {1e3 * depth:.0f} mm"
                )
                hint = "give one of them another `base`"
                raise RobotOptionError(f"{second}.base", f"{message}; {hint}", "robots")


def _fixed_links(robot: RobotDescription, base: str) -> set[str]:
    """The links of an arm that never move, from its base on."""
    found = {base}
    for joint in robot.joints:  # parents before children
        if joint.parent in found and not joint.is_movable:
            found.add(joint.child)
    return found
