"""Signal temporal logic as text: `always (z(box) > 5 cm implies force(robot, box) > 0.1 N)`.

A formula is data: `harness.plugins.formulas.language.parser` reads it into the nodes of this
module, and nothing in it is executed. From the weakest binding to the strongest:

    implies (to the right) · or · and · until[a, b] · not, always[a, b], eventually[a, b] ·
    < <= > >= · + - · * / · - (sign)

`U`, `G`, `F`, `->`, `|`, `&`, `!` are other ways to write until, always, eventually, implies, or,
and, not. A number may carry a unit: `5 cm`, `90 deg`, `200 ms`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, TypeGuard

from harness.language.units import COMMON

Kind = Literal["frame", "body", "joint", "sensor", "belt"]

SENSED: dict[str, tuple[tuple[Kind, ...], str, str]] = {
    f"{what}_{axis}": (
        ("sensor",),
        unit,
        f"{what} that a sensor of force and torque reads along its {axis} axis, mean over "
        "`force_window`",
    )
    for what, unit in (("force", "N"), ("torque", "N m"))
    for axis in "xyz"
}
"""Signals of sensors of force and torque, in the form of `SIGNALS`."""

SIGNALS: dict[str, tuple[tuple[Kind, ...], str, str]] = {
    "time": ((), "s", "time since the window's start"),
    "x": (("frame",), "m", "position in the world of `tcp`, a link or an object"),
    "y": (("frame",), "m", "the same along y"),
    "z": (("frame",), "m", "the same along z: its height"),
    "tilt": (("frame",), "rad", "angle of its z axis to the vertical"),
    "speed": (("frame",), "m/s", "speed of its origin"),
    "position": (("joint",), "", "measured position of a joint"),
    "velocity": (("joint",), "", "measured velocity of a joint"),
    "effort": (("joint",), "", "effort of a joint's motor"),
    "command": (("joint",), "", "commanded position of a joint"),
    "force": (
        ("body", "body"),
        "N",
        "sum of the normal forces between two of: link, object, `robot`, ..., mean over "
        "`force_window`",
    ),
    "distance": (
        ("body", "body"),
        "m",
        "distance between `robot`, or what it holds, and an object",
    ),
    **SENSED,
    "surface_velocity": (("belt",), "m/s", "velocity of a belt's surface along its x axis"),
    "surface_rotation": (("belt",), "rad/s", "rate at which a turntable's surface turns"),
}
"""Name -> kinds of its arguments, unit (empty: the joint's), meaning."""

FUNCTIONS = {"abs": 1, "min": 2, "max": 2}
"""Arithmetic of one or two numbers."""

UNITS = {
    name: (unit, factor)
    for unit in ("m", "rad", "s", "N", "m/s", "rad/s")
    for name, factor in COMMON[unit].items()
} | {"N*m": ("N m", 1.0)}
"""Unit after a number -> its SI unit and factor."""


@dataclass(frozen=True)
class Interval:
    """Seconds after the moment a word is judged at; `last` is inf for the end of the window."""

    first: float = 0.0
    last: float = float("inf")


WHOLE = Interval()


@dataclass(frozen=True)
class Const:
    """A number in SI."""

    value: float
    unit: str
    start: int


@dataclass(frozen=True)
class Signal:
    """A recorded signal: `z(box)`."""

    name: str
    arguments: tuple[str, ...]
    starts: tuple[int, ...]
    start: int

    def __str__(self) -> str:
        return f"{self.name}({', '.join(self.arguments)})" if self.arguments else self.name


@dataclass(frozen=True)
class Arithmetic:
    """`+ - * /`, `neg`, or a function, of numbers."""

    operator: str
    operands: tuple[Number, ...]
    start: int


Number = Const | Signal | Arithmetic


@dataclass(frozen=True)
class Comparison:
    """Two numbers compared; its margin is how far the left side may move."""

    left: Number
    operator: Literal["<", "<=", ">", ">="]
    right: Number
    start: int
    text: str


@dataclass(frozen=True)
class Logic:
    """`not`, `and`, `or`, `implies` of formulas."""

    operator: Literal["not", "and", "or", "implies"]
    operands: tuple[Node, ...]
    start: int


@dataclass(frozen=True)
class Temporal:
    """`always`, `eventually` of one formula; `until` of two."""

    operator: Literal["always", "eventually", "until"]
    operands: tuple[Node, ...]
    interval: Interval
    start: int


Node = Comparison | Logic | Temporal


def operands_of(node: Node | Number) -> tuple[Node | Number, ...]:
    """What a part of a formula joins."""
    match node:
        case Const() | Signal():
            return ()
        case Comparison(left=left, right=right):
            return left, right
        case _:
            return node.operands


def parts_of(node: Node | Number) -> Iterator[Node | Number]:
    """A formula and all its parts, from the outermost to the innermost, from left to right."""
    yield node
    for operand in operands_of(node):
        yield from parts_of(operand)


def signals_of(node: Node | Number) -> list[Signal]:
    """Every signal that a formula reads, from left to right."""
    return [part for part in parts_of(node) if isinstance(part, Signal)]


def arguments_of(node: Node, *kinds: Kind) -> set[str]:
    """The names of some kinds that a formula's signals are of."""
    return {
        name
        for signal in signals_of(node)
        for name, kind in zip(signal.arguments, SIGNALS[signal.name][0], strict=True)
        if kind in kinds
    }


def premises_of(node: Node) -> list[Node]:
    """The premise P of every `P implies Q`, `not P or Q` and `Q or not P`, the outermost first."""
    found: list[Node] = []
    for part in parts_of(node):
        if isinstance(part, Logic) and part.operator == "implies":
            found.append(part.operands[0])
        if isinstance(part, Logic) and part.operator == "or":
            negated = [each.operands[0] for each in part.operands if _is_negation(each)]
            found += negated if len(negated) == 1 else []  # two are a choice, and no implication
    return found


def _is_negation(node: Node) -> TypeGuard[Logic]:
    return isinstance(node, Logic) and node.operator == "not"


def text_of(node: Node) -> str:
    """A formula as text, without its intervals."""
    match node:
        case Comparison(text=text):
            return text
        case Logic(operator=operator, operands=(inner,)):
            return f"{operator} {text_of(inner)}"
        case Temporal(operator=operator, operands=(inner,)):
            return f"{operator} {text_of(inner)}"
        case _:
            first, second = node.operands
            return f"({text_of(first)} {node.operator} {text_of(second)})"


def unit_of(node: Number, joint_units: Mapping[str, str] | None = None) -> str | None:
    """SI unit of a number: empty for a bare number, None where it is not known before a run.

    Args:
        node: The number or signal of a formula.
        joint_units: The unit of each joint's position, where the robot is known.
    """
    match node:
        case Const(unit=unit):
            return unit
        case Signal(name=name, arguments=arguments):
            return SIGNALS[name][1] or _unit_of_joint(name, arguments[0], joint_units or {})
        case Arithmetic(operator="*" | "/" as sign, operands=(left, right)):
            first, second = unit_of(left, joint_units), unit_of(right, joint_units)
            return first if second == "" else second if sign == "*" and first == "" else None
        case Arithmetic(operands=operands):
            units = (unit_of(each, joint_units) for each in operands)
            return next((unit for unit in units if unit != ""), "")


def _unit_of_joint(signal: str, joint: str, joint_units: Mapping[str, str]) -> str | None:
    unit = joint_units.get(joint)
    if unit is None:
        return None
    match signal:
        case "velocity":
            return f"{unit}/s"
        case "effort":
            return "N" if unit == "m" else "N m"
        case _:
            return unit


def mixed_units(node: Node, joint_units: Mapping[str, str]) -> Iterator[tuple[int, str, str]]:
    """Where a formula compares or adds numbers of two dimensions: start, and the two units."""
    for part in parts_of(node):
        match part:
            case Comparison(left=left, right=right):
                numbers = left, right
            case Arithmetic(operator=operator, operands=numbers) if operator not in "*/":
                pass
            case _:
                continue
        units = [unit for each in numbers if (unit := unit_of(each, joint_units))]
        if len(set(units)) > 1:
            yield part.start, units[0], units[1]
