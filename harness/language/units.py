"""Numbers that may carry a unit as text: `5 cm` is 0.05 where metres are expected."""

from __future__ import annotations

import functools
import importlib
import re
from collections.abc import Callable
from typing import Any

from harness.core.quantity import constant_of
from harness.core.suggestion import nearest
from harness.language.files.mistakes import MistakeError, value_text

DEFINITIONS = (
    "nano- = 1e-9 = n-",
    "micro- = 1e-6 = µ- = u- = μ-",
    "milli- = 1e-3 = m-",
    "centi- = 1e-2 = c-",
    "deci- = 1e-1 = d-",
    "kilo- = 1e3 = k-",
    "mega- = 1e6 = M-",
    "meter = [length] = m = metre",
    "second = [time] = s = sec",
    "gram = [mass] = g",
    "radian = [angle] = rad",
    "minute = 60 * second = min",
    "hour = 3600 * second = h",
    "inch = 0.0254 * meter = in",
    "foot = 0.3048 * meter = ft = feet",
    "degree = 0.017453292519943295 * radian = deg = °",
    "turn = 6.283185307179586 * radian = _ = revolution = rev",
    "rpm = turn / minute",
    "newton = kilogram * meter / second ** 2 = N",
    "newton_meter = newton * meter = Nm",
    "hertz = 1 / second = Hz",
)
"""What a scenario may say, in pint's definition language; its own default file takes 0.1 s."""

MEANINGS = {
    "m": ("a length", "m, cm, mm"),
    "rad": ("an angle", "rad, deg"),
    "s": ("a time", "s, ms"),
    "kg": ("a mass", "kg, g"),
    "N": ("a force", "N"),
    "Hz": ("a rate", "Hz"),
    "N*m": ("a torque", "N*m"),
    "m/s": ("a speed", "m/s, cm/s"),
    "rad/s": ("a turning speed", "rad/s, deg/s"),
    "m/s**2": ("an acceleration", "m/s**2"),
    "rad/s**2": ("a turning acceleration", "rad/s**2, deg/s**2"),
    "m/s**3": ("a jerk", "m/s**3"),
    "rad/s**3": ("a turning jerk", "rad/s**3, deg/s**3"),
    "N/m": ("a stiffness", "N/m"),
    "N*m/rad": ("a stiffness of turns", "N*m/rad"),
    "N*s/m": ("a damping", "N*s/m"),
    "N*m*s/rad": ("a damping of turns", "N*m*s/rad"),
    "1": ("a share", "%"),
}
"""SI unit -> what it measures, and what a person would write."""

SHARE = ("1",)

COMMON = {
    "m": {"m": 1.0, "cm": 0.01, "mm": 0.001},
    "rad": {"rad": 1.0, "deg": 0.017453292519943295},
    "s": {"s": 1.0, "ms": 0.001},
    "kg": {"kg": 1.0, "g": 0.001},
    "N": {"N": 1.0},
    "Hz": {"Hz": 1.0},
    "m/s": {"m/s": 1.0, "cm/s": 0.01, "mm/s": 0.001},
    "rad/s": {"rad/s": 1.0, "deg/s": 0.017453292519943295},
}
"""SI unit -> factors that pint gives for what most files say, held by a test: importing pint takes
0.06 s, a tenth of `harness check`."""

NUMBER_AND_UNIT = re.compile(
    r"\s*(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>|[^\W\d].*?|°.*?|%)\s*",
    re.DOTALL,
)
FACTOR = r"[A-Za-zµμ°_]++(?:\s*+(?:\*\*|\^)?+\s*+-?[1-4])?+"
UNIT = re.compile(rf"{FACTOR}(?:\s*+[*/·]?+\s*+{FACTOR})*+")
"""A product of units; each has one power at most, because pint computes powers of powers."""

LONGEST = 60  # characters of a number with its unit


def quantity(*units: str) -> Callable[[Any], float]:
    """A validator that turns `5 cm` into a number of the first unit that fits; numbers pass.

    Where an angle fits, so do expressions such as `pi/2`; where a share is expected, percentages.

    Args:
        units: SI units accepted here, distinguished by dimension (a joint is `rad` or `m`).
    """

    def parse(value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise MistakeError(_no_number(value, units), usage(units))
        return in_si(value, units) if isinstance(value, str) else value

    parse.units = units  # type: ignore[attr-defined]  # read by schema and reference
    return parse


def in_si(text: str, units: tuple[str, ...]) -> float:
    """The number of a text with a unit, in the first of the SI units that has its dimension.

    Raises:
        MistakeError: No number, no unit, an unknown one, or one that measures something else.
    """
    constant = constant_of(text) if "rad" in units else None
    if constant is not None:
        return constant
    match = NUMBER_AND_UNIT.fullmatch(text) if len(text) <= LONGEST else None
    if match is None:
        raise MistakeError(_no_number(text, units), usage(units))
    number, unit = float(match["number"]), match["unit"]
    if not unit:
        raise _without_unit(text, match["number"], units)
    if unit == "%":
        if units == SHARE:
            return number / 100
        raise MistakeError(f"`{text}` is a share; {expected(units)} is expected", usage(units))
    for target in units:
        if unit in COMMON.get(target, {}):
            return number * COMMON[target][unit]
    given = _parsed(unit.replace("^", "**").replace("·", "*"))
    if given is None:
        raise _unknown_unit(text, match["number"], unit, units)
    for target in units:
        target_unit = _parsed(target)
        if target_unit is not None and given.is_compatible_with(target_unit):
            return number * float(_registry().Quantity(1.0, given).to(target_unit).magnitude)
    raise MistakeError(
        f"`{text}` is {_measured(given)}; {expected(units)} is expected", usage(units)
    )


def _without_unit(text: str, number: str, units: tuple[str, ...]) -> MistakeError:
    if units == SHARE:
        hint = f"write {number} without quotes, or a percentage: `90 %`"
        return MistakeError(f"is the text {value_text(text)}, not a number", hint)
    hint = f"write {number} without quotes for {units[0]}, or give a unit"
    return MistakeError(f"`{text}` is text without a unit", f"{hint}: {written(units)}")


def _unknown_unit(text: str, number: str, unit: str, units: tuple[str, ...]) -> MistakeError:
    near = nearest(unit, written(units).split(", "))
    is_guess = near is None or (len(unit) <= 2 and near.lower() != unit.lower())
    start = "" if is_guess else f"did you mean `{number} {near}`? "
    message = f"`{text}`: no unit is called `{unit}`"
    return MistakeError(message, f"{start}units: {written(units)}")


def _no_number(value: Any, units: tuple[str, ...]) -> str:
    if units == SHARE:
        return f"is a number or a percentage, not {value_text(value)}"
    return f"{expected(units)} is a number, not {value_text(value)}"


def expected(units: tuple[str, ...]) -> str:
    """`an angle or a length`."""
    return " or ".join(MEANINGS[unit][0] for unit in units)


def written(units: tuple[str, ...]) -> str:
    """Units a person would write for these SI units: `rad, deg, m, cm, mm`."""
    return ", ".join(MEANINGS[unit][1] for unit in units)


def usage(units: tuple[str, ...]) -> str:
    """What may be written where these units are expected."""
    if units == SHARE:
        return "write a number, or a percentage: `90 %`"
    return f"write a number in {' or '.join(units)}, or one with a unit: {written(units)}"


def _measured(unit: Any) -> str:
    for target, (meaning, _) in MEANINGS.items():
        target_unit = _parsed(target)
        if target_unit is not None and unit.is_compatible_with(target_unit):
            return meaning
    return "something else"


@functools.cache
def _parsed(unit: str) -> Any | None:
    """Pint's unit, or None where it knows none; only plain products and powers are let through."""
    if UNIT.fullmatch(unit) is None:
        return None
    try:
        return _registry().parse_units(unit)
    except (ValueError, TypeError, AttributeError, ArithmeticError, SyntaxError):
        return None  # pint's own errors are AttributeError, SyntaxError or ValueError as well


@functools.cache
def _registry() -> Any:
    pint: Any = importlib.import_module("pint")  # 0.1 s: only files that carry units pay for it
    registry = pint.UnitRegistry(None)
    for definition in DEFINITIONS:
        registry.define(definition)
    return registry
