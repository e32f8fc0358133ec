"""Sensors of force and torque of an MJCF file: those at one site are one sensor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.core.wrench_sensor import WrenchSensor
from harness.plugins.formats.mjcf_robot.joints import mjcf_pose

FORCE, TORQUE = 4, 5  # mjSENS_FORCE, mjSENS_TORQUE of mjtSensor


def wrench_sensors(model: Any, links: Mapping[int, str]) -> dict[str, WrenchSensor]:
    """The sensors by the names of their sites.

    Args:
        model: The compiled model of the file.
        links: The name of the link of each body that is part of the robot.
    """
    found: dict[str, WrenchSensor] = {}
    noise: dict[tuple[int, int], float] = {}
    for number in range(model.nsensor):
        kind, site = int(model.sensor_type[number]), int(model.sensor_objid[number])
        if kind in (FORCE, TORQUE):
            noise[site, kind] = float(model.sensor_noise[number])
    for site in dict.fromkeys(site for site, _ in noise):
        body = int(model.site_bodyid[site])
        if not body or body not in links:
            continue
        name = model.site(site).name or f"wrench_{site}"
        found[name] = WrenchSensor(
            name,
            links[body],
            mjcf_pose(model.site_pos[site], model.site_quat[site]),
            force_noise=noise.get((site, FORCE), 0.0),
            torque_noise=noise.get((site, TORQUE), 0.0),
        )
    return found
