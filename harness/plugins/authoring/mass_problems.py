"""Masses and inertias of a robot that are physically impossible."""

from __future__ import annotations

import numpy as np

from harness.core.solids import TRIANGLE_SLACK
from harness.plugins.authoring.doubtful_masses import principal_moments
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Inertial
from harness.robot.urdf.links import corrected_note

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
