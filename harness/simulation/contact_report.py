"""What the robot touches, in words."""

from __future__ import annotations

from harness.robot.description import RobotDescription
from harness.simulation.recording import BodyPair, Recording

LOOK_BACK = 25
"""Samples before a failure in which contacts are looked for."""


def strongest_contacts(
    recording: Recording, row: int, description: RobotDescription
) -> dict[BodyPair, float]:
    """Largest force [N] of each pair with a robot link shortly before a sample, largest first."""
    links = set(description.link_names)
    peaks = {
        pair: float(force.max())
        for pair, force in recording.contacts(max(0, row - LOOK_BACK), row + 1).items()
        if pair[0] in links
    }
    return dict(sorted(peaks.items(), key=lambda item: -item[1]))


def contact_words(contacts: dict[BodyPair, float]) -> str:
    """A clause for a failure's message."""
    if not contacts:
        return "it touches nothing"
    parts = [f"{a} presses on {b} with {force:.3g} N" for (a, b), force in contacts.items()]
    return ", ".join(parts[:3])
