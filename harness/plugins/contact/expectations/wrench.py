"""wrench: what a sensor of force and torque reads stays within bounds."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field, model_validator

from harness.cell.scope import At
from harness.core.amounts import amounts
from harness.core.pose_arrays import rotate
from harness.core.types import FloatArray
from harness.judging.contacts import FORCE_WINDOW
from harness.judging.expectation import Predicate
from harness.judging.margins import Comparison, MarginSignal, Part, all_of
from harness.judging.observations import Observations
from harness.judging.poses import frame_poses
from harness.judging.window import Window
from harness.judging.wrenches import averaged_wrench
from harness.language.base import Duration, Force, Name, Torque
from harness.language.expectation import Judged, Quantity
from harness.language.poses import Direction
from harness.plugins.contact.sensors import check_sensor, sensor_of
from harness.recording.link_poses import replayed_link_poses
from harness.recording.verdict import Measure

FORCE = Quantity("wrist force", "N", "at most `below`, at least `above`", "wrench_force")
TORQUE = Quantity(
    "wrist torque", "N*m", "at most `torque_below`, at least `torque_above`", "wrench_torque"
)


class Wrench(Predicate):
    """What a sensor of force and torque reads stays within bounds.

    The magnitudes of force and torque are judged, or with `direction` their components along it,
    which have a sign. Readings have the sensor's noise, rate and tare, and are averaged over
    `force_window`. Force and torque are those with which what the sensor carries acts on the link
    before it: a table on which the tool presses pushes up.
    """

    short = "below"
    some_of = ("below", "above", "torque_below", "torque_above")
    judged: ClassVar[Judged] = "always"
    sentence = (
        "force at the wrist is[ at most {below}][ at least {above}]"
        "[, torque at most {torque_below}][, torque at least {torque_above}]"
    )
    quantities = (FORCE, TORQUE)
    is_upper_bound = True
    synonyms = ("force_torque", "ft_sensor", "wrist_force")

    sensor: Name | None = Field(
        default=None, description="The name of the sensor; the default is the only one."
    )
    below: Force | None = Field(default=None, description="The largest force [N].")
    above: Force | None = Field(default=None, description="The smallest force [N].")
    torque_below: Torque | None = Field(default=None, description="The largest torque [N m].")
    torque_above: Torque | None = Field(default=None, description="The smallest torque [N m].")
    direction: Direction | None = Field(
        default=None,
        description="The components along this direction are judged instead of the magnitudes; its"
        " `frame` may also be the name of the sensor, for the sensor's own axes.",
    )
    force_window: Duration = Field(
        default=FORCE_WINDOW,
        description="A reading is the mean over this time before each sample; with 0 each reading"
        " counts as it is [s].",
    )

    @model_validator(mode="after")
    def _possible(self) -> Wrench:
        for low, high in (("above", "below"), ("torque_above", "torque_below")):
            least, most = getattr(self, low), getattr(self, high)
            if least is not None and most is not None and least > most:
                raise ValueError(f"`{low}` must not be more than `{high}`")
            for key, bound in ((low, least), (high, most)):
                if self.direction is None and bound is not None and bound <= 0:
                    raise ValueError(
                        f"`{key}` bounds a magnitude, which is never below 0; a component along a"
                        " `direction` may be"
                    )
        return self

    def check(self, at: At) -> None:
        check_sensor(self.sensor, at)
        if self.direction is None:
            return
        if self.direction.frame not in at.scope.description.wrench_sensors:
            at.scope.check_frame(self.direction.frame, at.key("direction", "frame"))

    def names(self) -> frozenset[str]:
        return (
            frozenset() if self.direction is None else frozenset({self.direction.frame} - {"world"})
        )

    def observations(self) -> Observations:
        frames = frozenset[str]() if self.direction is None else {self.direction.frame}
        return Observations(frames=frozenset(frames))

    def looks_back(self) -> float:
        return self.force_window

    def signal(self, window: Window) -> MarginSignal:
        """The force [N] and the torque [N m] at each sample, averaged.

        Raises:
            NotObservable: The sensor was not recorded.
        """
        parts = [
            Part(quantity, values, limit, comparison, scale=max(abs(limit), 1e-9))
            for quantity, values, low, high in (
                (FORCE, self._values(window, 0), self.above, self.below),
                (TORQUE, self._values(window, 3), self.torque_above, self.torque_below),
            )
            for limit, comparison in _bounds(low, high)
        ]

        def text(_: int, measure: Measure) -> str:
            bound = "at most" if measure.comparison == "<=" else "at least"
            read, limit = amounts(measure.value, measure.limit, measure.unit)
            along = "" if self.direction is None else " along the direction"
            return f"the {measure.name} is {read}{along}, {bound} {limit} required"

        return all_of(window, parts, text)

    def _values(self, window: Window, first: int) -> FloatArray:
        """Magnitudes of the three components from a column on, or components along a direction."""
        run = window.run
        sensor = sensor_of(run.robot, self.sensor)
        vectors = averaged_wrench(run, sensor.name, self.force_window)[:, first : first + 3]
        if self.direction is None:
            return window.cut(np.linalg.norm(vectors, axis=1))
        axis = np.array(self.direction.xyz) / np.linalg.norm(self.direction.xyz)
        if self.direction.frame == sensor.name:
            return window.cut(vectors @ axis)
        quats = replayed_link_poses(run.robot, run.signals.joint_positions, [sensor.link])
        in_world = rotate(quats[sensor.link][:, 3:], vectors @ sensor.pose.rotation.T)
        along = rotate(frame_poses(run, self.direction.frame)[:, 3:], axis)
        return window.cut(np.sum(in_world * along, axis=1))


def _bounds(low: float | None, high: float | None) -> list[tuple[float, Comparison]]:
    bounds: list[tuple[float, Comparison]] = []
    if low is not None:
        bounds.append((low, ">="))
    if high is not None:
        bounds.append((high, "<="))
    return bounds
