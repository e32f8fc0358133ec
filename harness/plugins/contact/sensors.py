"""The sensor of force and torque that a step or an expectation names, or the only one."""

from __future__ import annotations

from harness.cell.scope import At
from harness.core.errors import StepFailed
from harness.core.wrench_sensor import WrenchSensor
from harness.robot.description import RobotDescription


def check_sensor(name: str | None, at: At) -> None:
    """Report a sensor that does not exist, and a robot that has none, or several."""
    scope, sensors = at.scope, at.scope.description.wrench_sensors
    if name is not None and sensors and name not in sensors:
        scope.problems.unknown(
            at.key("sensor"), "wrench sensor", name, [*sensors], needs=("robot",)
        )
    elif not sensors:
        scope.problems.add(
            at.loc if name is None else at.key("sensor"),
            f"{scope.description.name} has no sensor of force and torque",
            "`wrench_sensors: {wrist: LINK}` under `robot` adds one; LINK is the first link that it"
            " carries, such as that on which the gripper is mounted",
            needs=("robot",),
        )
    elif name is None and len(sensors) > 1:
        scope.problems.add(
            at.loc,
            f"the robot has the sensors {', '.join(sensors)}",
            "say which one with `sensor`",
            needs=("robot",),
        )


def sensor_of(robot: RobotDescription, name: str | None) -> WrenchSensor:
    """The sensor with a name; the only one where none is given.

    Raises:
        StepFailed: There is no such sensor.
    """
    sensors = robot.wrench_sensors
    if (name or "") in sensors:
        return sensors[name or ""]
    if name is None and len(sensors) == 1:
        return next(iter(sensors.values()))
    raise StepFailed("INVALID_LINK_NAME", f"{robot.name} has no sensor '{name or ''}'")
