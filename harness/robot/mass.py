"""Whether everything that moves has mass: physics has no motion without."""

from __future__ import annotations

from harness.core.errors import RobotError
from harness.robot.tree import carriers
from harness.robot.urdf import Urdf


def refuse_weightless(urdf: Urdf, source: str) -> None:
    """Refuse a robot with a rigid piece that a joint moves and that weighs nothing.

    Raises:
        SpecError: At the link's `<mass>`, or at the link where it has none.
    """
    carrier = carriers(urdf.joints, urdf.root)
    masses = {carrier[link.name]: 0.0 for link in urdf.links}
    for link in urdf.links:
        if link.inertial is not None:
            masses[carrier[link.name]] += link.inertial.mass
    for first, mass in masses.items():
        if mass > 0 or first == urdf.root:
            continue
        message = f"link '{first}' moves and weighs nothing"
        hint = "give it an <inertial> with its mass [kg] and inertia [kg m^2]"
        element = urdf.elements.get(("link", first))
        if element is None:
            raise RobotError(f"{source}: {message}; {hint}")
        inertial = element.find("inertial")
        written = None if inertial is None else inertial.find("mass")
        (written or element).refuse(message, hint, at="value" if written else "name")
