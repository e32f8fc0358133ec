"""Contacts of fingers and objects: what is held does not creep in a moving hand."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from harness.core.world import WorldObject
from harness.robot.description import RobotDescription
from harness.simulation.geoms import CONTACT_DIMENSIONS, CONTACT_SOLIMP, CONTACT_SOLREF, Surfaces
from harness.simulation.robot_mjcf import link_friction

FRICTION_DAMPING_PER_STEP = 1.5
"""Part of a sliding velocity that friction takes back in one physics step.

MuJoCo's friction opposes the sliding velocity found at the start of a step, so what is held falls
behind a hand on a curve: with centripetal acceleration a, step h and damping b it creeps with about
a (1 - h b) / b + a h / 2. That vanishes towards h b = 2, where velocities would oscillate for ever;
at 1.5 an oscillation halves each step. MuJoCo gives contacts at most h b = 1, and lets only
explicit pairs have more, for friction alone. Creep [mm] measured in two swings of a UR3e:

    step 2 ms: contacts of 6 ms 4.6; pairs with 1.0, 1.5, 1.8: 2.5, 1.2, 0.8
    step 1 ms: contacts of 2 ms 1.25; pairs with 1.5: 0.6, whatever the contact's time constant
"""


def add_grasp_contacts(
    spec: mujoco.MjSpec,
    description: RobotDescription,
    objects: Sequence[WorldObject],
    surfaces: Surfaces,
) -> None:
    """Add an explicit contact pair for each geom of the fingers and of the free objects.

    Explicit pairs have a friction damping of their own; all else is as in other contacts.
    """
    gripper = description.gripper
    if gripper is None:
        return
    damping = FRICTION_DAMPING_PER_STEP / spec.option.timestep
    for link in gripper.links:
        for obj in (obj for obj in objects if not obj.is_static):
            own = link_friction(description, link)
            for finger_geom in spec.body(link).geoms:
                for shape, object_geom in zip(obj.shapes, spec.body(obj.name).geoms, strict=True):
                    friction = surfaces.smaller(own, obj.friction_of(shape))
                    sliding, torsional = friction.sliding, friction.torsional
                    rolling = friction.rolling
                    pair = spec.add_pair(geomname1=finger_geom.name, geomname2=object_geom.name)
                    pair.condim = CONTACT_DIMENSIONS
                    pair.friction = sliding, sliding, torsional, rolling, rolling
                    pair.solref, pair.solimp = CONTACT_SOLREF, CONTACT_SOLIMP
                    pair.solreffriction = -1.0, -damping
