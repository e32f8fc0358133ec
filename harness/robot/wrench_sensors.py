"""Sensors of force and torque of a robot, checked against its links."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from harness.core.errors import RobotOptionError
from harness.core.suggestion import did_you_mean
from harness.core.wrench_sensor import WrenchSensor
from harness.language.scenario import WrenchSensorKey
from harness.robot.description import RobotDescription
from harness.robot.mechanism import WORLD, Joint, Link
from harness.robot.tree import carried_by


def with_wrench_sensors(
    description: RobotDescription, specs: Mapping[str, WrenchSensorKey]
) -> RobotDescription:
    """The robot with a scenario's sensors, which replace those of the same name.

    Raises:
        RobotOptionError: A sensor carries no link of the robot, or nothing that has a mass.
    """
    sensors = {name: spec.sensor(name) for name, spec in specs.items()}
    for name, sensor in sensors.items():
        if reason := flaw(sensor, description.links, description.joints):
            raise RobotOptionError(f"wrench_sensors.{name}.link", reason)
    return replace(description, wrench_sensors={**description.wrench_sensors, **sensors})


def flaw(sensor: WrenchSensor, links: Collection[Link], joints: Collection[Joint]) -> str:
    """Why a sensor cannot measure anything; empty where it can."""
    names = [link.name for link in links if link.name != WORLD]
    if sensor.link not in names:
        return f"there is no link '{sensor.link}'; {did_you_mean(sensor.link, names, 'links')}"
    if sensor.frame_id in names and sensor.frame_id != sensor.link:
        return (
            f"the robot has a link '{sensor.frame_id}', as the sensor's frame is called: rename it"
        )
    carried = carried_by([sensor.link], joints)
    if any(link.collisions or link.inertial is not None for link in links if link.name in carried):
        return ""
    return (
        f"'{sensor.link}' is a frame that carries nothing, so that nothing acts on the sensor;"
        " name the first link of what it carries, such as a gripper's"
    )
