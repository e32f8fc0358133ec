"""Numbers for people: millimetres, degrees, newtons; digits until two of them differ."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field

from harness.core.quantity import distinct

FINEST = 1e-3  # [mm, mm/s, N ...], what is smaller is written as 0
FINEST_ANGLE = 1e-4  # [deg]
SHOWN = {"rad": (180 / math.pi, "deg"), "m": (1e3, "mm")}  # what a joint position is shown in
JOINT_DECIMALS = 2  # of degrees and mm: a joint's encoder shows no more


@dataclass(frozen=True)
class JointUnits:
    """The units of joint positions, `rad` or `m`.

    Attributes:
        by_joint: The units of the robot's joints, by their names.
        gripper: The unit of the joint that moves the gripper; empty without one.
    """

    by_joint: Mapping[str, str] = field(default_factory=dict[str, str])
    gripper: str = ""

    def text(self, positions: Mapping[str, float]) -> str:
        """Positions without the joints' names: `(-4.81, 90) deg`, or `90 deg, 20 mm`."""
        units = {self.by_joint.get(name, "") for name in positions}
        if len(units) > 1 or len(positions) == 1:
            return ", ".join(
                joint_position(value, self.by_joint.get(name, ""))
                for name, value in positions.items()
            )
        factor, shown = SHOWN.get(units.pop(), (1.0, ""))
        values = ", ".join(_rounded(value * factor) for value in positions.values())
        return f"({values}) {shown}".rstrip()


def amount(value: float, unit: str, more_digits: int = 0) -> str:
    """A quantity for people: below a metre in mm, angles in degrees."""
    match unit:
        case "m" if abs(value) < 1:
            return f"{_short(value * 1e3, more_digits)} mm"
        case "rad":
            return f"{_short(math.degrees(value), more_digits, FINEST_ANGLE)} deg"
        case "rad/s":
            return f"{_short(math.degrees(value), more_digits)} deg/s"
        case "m/s" if abs(value) < 1:
            return f"{_short(value * 1e3, more_digits)} mm/s"
        case "1":
            return _short(value, more_digits)
        case _:
            return f"{_short(value, more_digits)} {unit}"


def joint_position(value: float, unit: str) -> str:
    """The position of a joint, of which 0.01 deg and 0.01 mm are shown; `unit` may be empty."""
    factor, shown = SHOWN.get(unit, (1.0, ""))
    return f"{_rounded(value * factor)} {shown}".rstrip()


def amount_in_units(value: float, units: Collection[str]) -> str:
    """A number that holds for joints of these units: `0.57 deg`, or `0.57 deg or 10.0 mm`."""
    return " or ".join(stated_amount(value, unit) for unit in sorted(units, reverse=True))


def stated_amount(value: float, unit: str) -> str:
    """A limit or a miss, which has digits however small it is: `0.0005 mm`, not `0 mm`."""
    text = amount(value, unit)
    return amount(value, unit, -1) if value and _is_zero(text) else text


def point_text(xyz: Iterable[float]) -> str:
    """A point for people: `(320, -170, 80) mm`."""
    return f"({', '.join(f'{round(1e3 * part, 3) + 0.0:.10g}' for part in xyz)}) mm"


def amounts(value: float, limit: float, unit: str) -> tuple[str, str]:
    """A quantity and what it is compared with, in digits that differ where the two do."""
    shown, stated = distinct(value, limit, lambda number, more: amount(number, unit, more))
    return shown, stated_amount(limit, unit) if _is_zero(stated) else stated


def is_visible(difference: float, unit: str) -> bool:
    """Whether people read a difference of two quantities as one: it is not written as 0."""
    return math.isfinite(difference) and not _is_zero(amount(difference, unit))


def is_exact(value: float, limit: float, unit: str) -> bool:
    """Whether an error is so small that people read it as none: it is written as 0."""
    return _is_zero(amounts(value, limit, unit)[0])


def _is_zero(text: str) -> bool:
    return text.partition(" ")[0] == "0"


def percentages(value: float, limit: float) -> tuple[str, str]:
    """Two shares in percent, in digits that differ where the two do."""
    return distinct(value, limit, lambda share, more: f"{100 * share:.{1 + more}f} %")


def _rounded(value: float) -> str:
    return f"{round(value, JOINT_DECIMALS) + 0.0:.10g}"


def _short(value: float, more_digits: int, finest: float = FINEST) -> str:
    if not math.isfinite(value):
        return str(value)
    if more_digits:
        return f"{value:#.{3 + more_digits}g}"
    if 1e-3 <= abs(value) < 0.995:
        return f"{value:.2g}"
    if finest <= abs(value) < 1e-3:
        return f"{value:.4f}"
    if abs(value) < finest:
        return "0"
    return f"{value:.1f}" if abs(value) < 100 else f"{value:.0f}"
