"""Masses of links whose file gives none, as a plug-in estimates them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

from harness.core.registry import Plugin, registry
from harness.robot.urdf.urdf import Urdf


class MassEstimator(Plugin, ABC):
    """Gives every rigid group of links that moves a mass, where its file gives none."""

    plugin_kind: ClassVar[str] = "mass_estimator"

    @abstractmethod
    def with_masses(self, urdf: Urdf) -> Urdf:
        """The robot with masses, and notes on what was estimated.

        Raises:
            RobotError: A mesh cannot be read, or is flat.
        """


def with_estimated_masses(urdf: Urdf) -> Urdf:
    """The robot with a mass for each link that moves; without a plug-in as it is."""
    for estimator in registry(MassEstimator.plugin_kind).built_in():
        urdf = estimator().with_masses(urdf)
    return urdf
