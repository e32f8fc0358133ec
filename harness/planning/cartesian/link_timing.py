"""Times a line or an arc: the link's velocity a trapezoid, slower where a joint cannot follow."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.cartesian.linear_path import LinkPath
from harness.planning.cartesian.tracing import Trace
from harness.planning.timing.cubic_spline import CubicSpline
from harness.planning.timing.limits import Limits, sampled_within_limits
from harness.planning.timing.profiles import GRID, Curve, Trapezoid, smoothed
from harness.ports.motion_planning import PlanningOptions
from harness.ports.motions import CartesianLimits

MAX_TRANSLATION_VELOCITY = 1.0  # pilz_cartesian_limits of ur_moveit_config [m/s]
MAX_TRANSLATION_ACCELERATION = 2.25  # [m/s^2]
MAX_ROTATION_VELOCITY = 1.57  # [rad/s]; the acceleration is in proportion, as Pilz has it
CENTRIPETAL_SHARE = 0.7
"""Of the link's acceleration that the speed on an arc may take; the rest is for its change."""

CARTESIAN_TOLERANCE = 5e-3  # Share by which a final sample may exceed a Cartesian limit


Profile = tuple[FloatArray, ...]
"""A parameter, its rate and its acceleration, (N,) each."""


@dataclass(frozen=True)
class LinkRates:
    """Cartesian limits with every number known.

    Attributes:
        velocity: The largest speed of the link [m/s].
        acceleration: The largest acceleration of the link [m/s^2].
        turning: The largest turning speed of the link [rad/s].
        turning_acceleration: The largest turning acceleration of the link [rad/s^2].
    """

    velocity: float
    acceleration: float
    turning: float
    turning_acceleration: float

    @classmethod
    def of(cls, limits: CartesianLimits, options: PlanningOptions) -> LinkRates:
        """The stated limits unscaled; the others are Pilz's defaults times the scaling factors."""
        speed, push = options.velocity_scaling, options.acceleration_scaling
        velocity = limits.translation_velocity or speed * MAX_TRANSLATION_VELOCITY
        acceleration = limits.translation_acceleration or push * MAX_TRANSLATION_ACCELERATION
        turning = limits.rotation_velocity or speed * MAX_ROTATION_VELOCITY
        return cls(velocity, acceleration, turning, acceleration / velocity * turning)

    def on(self, path: LinkPath) -> tuple[float, float]:
        """Largest rate of a way's parameter and of that rate [1/s, 1/s^2].

        On an arc the acceleration towards its centre is kept within the limit together with the
        one along it, which Pilz leaves out.
        """
        speed = min(
            self.velocity, float(np.sqrt(CENTRIPETAL_SHARE * self.acceleration * path.radius))
        )
        along = float(np.sqrt(self.acceleration**2 - (speed**2 / path.radius) ** 2))
        rate = min(speed / max(path.length, 1e-9), self.turning / max(path.angle, 1e-9))
        change = min(
            along / max(path.length, 1e-9), self.turning_acceleration / max(path.angle, 1e-9)
        )
        return rate, change


def time_on_path(
    path: LinkPath,
    traced: Trace,
    joint_names: tuple[str, ...],
    limits: Limits,
    rates: LinkRates,
) -> JointTrajectory:
    """Time a whole trace.

    Raises:
        TimingError: The limits cannot be kept.
    """
    rate, change = rates.on(path)
    spline = CubicSpline.even(traced.positions).evaluate
    for _ in range(2):  # gentler ramps and a lower middle, before everything is slowed down
        profile = Trapezoid.fastest(1.0, rate, change)
        _, velocities, accelerations = _along(spline, profile)(
            np.arange(0.0, profile.duration, GRID)
        )
        rate /= max(1.0, float(np.max(np.abs(velocities) / limits.velocity)))
        change /= max(1.0, float(np.max(np.abs(accelerations) / limits.acceleration)))
    profile = Trapezoid.fastest(1.0, rate, change)

    def rows(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        s, rate, change = profile(times)
        return s[:, None], rate[:, None], change[:, None]

    def motion(window: float) -> Curve:
        """The profile is smoothed, not the joints' motion: that keeps the link on its path."""
        eased = smoothed(rows, profile.duration, window) if window else rows
        return _along(spline, lambda times: tuple(part[:, 0] for part in eased(times)))

    return sampled_within_limits(joint_names, motion, profile.duration, limits)


def _along(spline: Curve, profile: Callable[[FloatArray], Profile]) -> Curve:
    """A spline over its parameter, as a curve over time."""

    def curve(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        s, ds, dds = (column[:, None] for column in profile(times))
        value, slope, bend = spline(s[:, 0])
        return value, slope * ds, slope * dds + bend * ds**2

    return curve


@dataclass(frozen=True)
class LinkMotion:
    """The largest speeds and accelerations of a link between a trajectory's samples (SI)."""

    velocity: float
    acceleration: float
    turning: float

    def excess(self, rates: LinkRates, *, turns: bool) -> float:
        """How many times slower the motion must be; at most 1 when it keeps the limits.

        The turn counts with `turns` alone: that of an arm of fewer joints is not its own to choose.
        """
        return max(
            self.velocity / rates.velocity,
            float(np.sqrt(self.acceleration / rates.acceleration)),
            self.turning / rates.turning if turns else 0.0,
        )


def link_motion(trajectory: JointTrajectory, pose_of: Callable[[FloatArray], SE3]) -> LinkMotion:
    """What a link does on a trajectory, from the differences of its poses alone."""
    poses = [pose_of(positions) for positions in trajectory.positions]
    steps = np.diff(trajectory.times)
    places = np.array([pose.translation for pose in poses])
    velocities = np.diff(places, axis=0) / steps[:, None]
    turns = [first.distance_to(second)[1] for first, second in pairwise(poses)]
    between = 0.5 * (steps[1:] + steps[:-1])[:, None]
    changes = np.linalg.norm(np.diff(velocities, axis=0) / between, axis=1)
    return LinkMotion(
        float(np.linalg.norm(velocities, axis=1).max()),
        float(changes.max()) if len(changes) else 0.0,
        float((np.array(turns) / steps).max()),
    )
