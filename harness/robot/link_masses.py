"""Checks whether a robot's masses and inertias are physically possible."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from harness.core.solids import TRIANGLE_SLACK
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Inertial, Link
from harness.robot.urdf.links import corrected_note

LONGEST_GYRATION = 2.0  # Radius of gyration that no link of an arm exceeds [m]

MANY = 3

FEATHER = 1e-3  # Lighter links are frames that have a mass because a library requires one [kg]


def mass_problems(description: RobotDescription) -> list[str]:
    """Physically impossible mass properties, one line per link."""
    corrected = [
        corrected_note(link.name, inertial.stated_moments, np.array(principal_moments(inertial)))
        for link in description.links
        if (inertial := link.inertial) is not None
        and inertial.stated_moments is not None
        and inertial.mass > FEATHER
    ]
    return corrected + [
        f"link '{link.name}': {problem}"
        for link in description.links
        if link.inertial is not None
        for problem in _impossible(link.inertial)
    ]


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


def _impossible(inertial: Inertial) -> list[str]:
    if not np.isfinite(inertial.mass) or inertial.mass < 0:
        return [f"a mass of {inertial.mass:g} kg"]
    if inertial.mass == 0:
        return [] if not inertial.inertia.any() else ["inertia without mass"]
    least, middle, most = principal_moments(inertial)
    if least < 0:
        return [f"a principal moment of inertia below 0: {least:.3g} kg m^2"]
    if most > (least + middle) * (1 + TRIANGLE_SLACK):
        return [
            f"principal moments {least:.3g}, {middle:.3g}, {most:.3g} kg m^2: none may be more"
            " than the sum of the others"
        ]
    return []


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
    counts = Counter(
        (link.inertial.mass, tuple(link.inertial.inertia.ravel()))
        for link in links
        if link.inertial is not None
    )
    notes: list[str] = []
    for (mass, tensor), count in counts.items():
        same = [
            link.name
            for link in links
            if link.inertial is not None
            and (link.inertial.mass, tuple(link.inertial.inertia.ravel())) == (mass, tensor)
        ]
        if count >= MANY:
            notes.append(
                f"{count} links have the same {mass:g} kg and the same inertia, a placeholder:"
                f" {', '.join(same)}"
            )
    return notes
