"""Doubtful masses and inertias of a robot."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from harness.robot.description import RobotDescription
from harness.robot.mechanism import Inertial, Link

LONGEST_GYRATION = 2.0  # Radius of gyration that no link of an arm exceeds [m]

MANY = 3  # Links that share one mass and inertia from which these are a placeholder


def mass_notes(description: RobotDescription) -> list[str]:
    """Mass properties that are placeholders or implausible for a link of an arm."""
    moving = [link for link in description.links if link.name not in description.static_links]
    known = [link for link in moving if link.inertial is not None]
    notes = [
        f"link '{link.name}': {note}"
        for link in known
        if link.inertial is not None
        for note in _doubtful(link.inertial)
    ]
    return notes + _same_for_many(known)


def principal_moments(inertial: Inertial) -> tuple[float, float, float]:
    """Principal moments in ascending order [kg m^2]."""
    least, middle, most = (float(value) for value in np.linalg.eigvalsh(inertial.inertia))
    return least, middle, most


def _doubtful(inertial: Inertial) -> list[str]:
    if inertial.mass == 0:
        return []
    _, _, most = principal_moments(inertial)
    notes: list[str] = []
    if np.allclose(inertial.inertia, np.eye(3)):
        notes.append("the inertia is the unit tensor, a placeholder; write that of the link")
    elif most == 0:
        notes.append(f"{inertial.mass:g} kg without inertia: a point")
    elif np.sqrt(most / inertial.mass) > LONGEST_GYRATION:
        gyration = np.sqrt(most / inertial.mass)
        notes.append(
            f"its mass would be {gyration:.2g} m from its centre: the inertia is in kg m^2, and a"
            " CAD program writes kg mm^2 or g mm^2"
        )
    return notes


def _same_for_many(links: Sequence[Link]) -> list[str]:
    """Notes on links of different shapes with equal mass and inertia."""
    links_of = defaultdict[tuple[float, tuple[float, ...]], list[str]](list)
    for link in links:
        if link.inertial is not None:
            tensor = tuple(map(float, link.inertial.inertia.ravel()))
            links_of[link.inertial.mass, tensor].append(link.name)
    return [
        f"{len(names)} links have the same {mass:g} kg and the same inertia, a placeholder:"
        f" {', '.join(names)}"
        for (mass, _), names in links_of.items()
        if len(names) >= MANY
    ]
