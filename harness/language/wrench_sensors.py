"""Sensors of force and torque in files, whose model a plug-in has."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.language.plugin_field import KeyModel

if TYPE_CHECKING:
    from harness.core.wrench_sensor import WrenchSensor


class WrenchSensorKey(KeyModel):
    """A sensor of force and torque between a link and the link before it."""

    def sensor(self, name: str) -> WrenchSensor:
        """The sensor under a name."""
        raise NotImplementedError
