"""Random pick, push, drop and throw runs of a gantry with two fingers, as scenario files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

KINDS = ("pick", "push", "drop", "throw")
GRAVITY = 9.8
PALM = (0.06, 0.12, 0.02)
FINGER = (0.02, 0.01, 0.06)
FINGER_DROP = 0.04
"""From the palm's centre down to a finger's [m]."""
TIPS = 0.07
"""From the palm's centre down to the tips of the fingers [m]."""
WALL = {"size": (0.02, 0.4, 0.24), "at": (0.3, 0.0, 0.12)}
BIN = (-0.2, 0.0, 0.0)
BOARDS = (
    ((0.16, 0.16, 0.02), (0.0, 0.0, 0.01)),
    ((0.01, 0.16, 0.08), (0.075, 0.0, 0.04)),
    ((0.01, 0.16, 0.08), (-0.075, 0.0, 0.04)),
    ((0.14, 0.01, 0.08), (0.0, 0.075, 0.04)),
    ((0.14, 0.01, 0.08), (0.0, -0.075, 0.04)),
)
BIN_FLOOR = 0.02


def _inertial(mass: float) -> str:
    return (
        f'<inertial><mass value="{mass}"/>'
        '<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial>'
    )


def _box(size: tuple[float, float, float], z: float = 0.0) -> str:
    text = " ".join(map(str, size))
    return (
        f'<collision><origin xyz="0 0 {z}"/><geometry><box size="{text}"/></geometry></collision>'
    )


def _slider(name: str, parent: str, child: str, axis: str, ends: tuple[float, float]) -> str:
    mimic = '<mimic joint="left" multiplier="1"/>' if name == "right" else ""
    effort = 60 if child.startswith("finger") else 400
    return (
        f'<joint name="{name}" type="prismatic"><parent link="{parent}"/><child link="{child}"/>'
        f'<axis xyz="{axis}"/><limit lower="{ends[0]}" upper="{ends[1]}" velocity="1"'
        f' effort="{effort}"/>{mimic}</joint>'
    )


URDF = (
    '<robot name="gantry"><link name="rail"/>'
    f'<link name="cart">{_inertial(2)}</link><link name="palm">{_inertial(1)}{_box(PALM)}</link>'
    f'<link name="finger_left">{_inertial(0.1)}'
    f'<collision><origin xyz="0 0.005 {-FINGER_DROP}"/><geometry>'
    f'<box size="{" ".join(map(str, FINGER))}"/></geometry></collision></link>'
    f'<link name="finger_right">{_inertial(0.1)}'
    f'<collision><origin xyz="0 -0.005 {-FINGER_DROP}"/><geometry>'
    f'<box size="{" ".join(map(str, FINGER))}"/></geometry></collision></link>'
    '<link name="tcp"/>'
    + _slider("slide", "rail", "cart", "1 0 0", (-0.5, 0.5))
    + _slider("lift", "cart", "palm", "0 0 1", (0.0, 0.8))
    + _slider("left", "palm", "finger_left", "0 1 0", (0.0, 0.04))
    + _slider("right", "palm", "finger_right", "0 -1 0", (0.0, 0.04))
    + '<joint name="tool" type="fixed"><parent link="palm"/><child link="tcp"/>'
    '<origin xyz="0 0 -0.05"/></joint></robot>'
)
SRDF = """<robot name="gantry">
<group name="arm"><chain base_link="rail" tip_link="tcp"/></group>
<group name="gripper"><joint name="left"/><joint name="right"/></group>
<group_state name="ready" group="arm">
<joint name="slide" value="0"/><joint name="lift" value="0.3"/>
</group_state>
<group_state name="open" group="gripper"><joint name="left" value="0.04"/></group_state>
<group_state name="close" group="gripper"><joint name="left" value="0.0"/></group_state>
<end_effector name="hand" parent_link="tcp" group="gripper" parent_group="arm"/>
<passive_joint name="right"/>
<disable_collisions link1="finger_left" link2="palm" reason="Adjacent"/>
<disable_collisions link1="finger_right" link2="palm" reason="Adjacent"/>
<disable_collisions link1="finger_left" link2="finger_right" reason="Never"/>
</robot>"""
EXPECTATIONS = {
    "grasped": "grasped: thing",
    "lifted": "lifted: {object: thing, above: 2 cm}",
    "placed": "placed: thing",
    "on bin": "on: {object: thing, support: bin}",
    "on floor": "on: {object: thing, support: ground_plane}",
    "in bin": "in: {object: thing, container: bin}",
    "released": "released: thing",
    "collision with the thing": "eventually: {collision: {between: [robot, thing]}}",
    "collision with the wall": "eventually: {collision: {between: [robot, wall]}}",
    "thing in hand hits the wall": "eventually: {collision: {between: [thing, wall]}}",
    "clearance": "clearance: {between: [robot, wall], at_least: 0.08}",
}


@dataclass(frozen=True)
class Trial:
    """One random run.

    Attributes:
        kind: `pick`, `push`, `drop` or `throw`.
        shape: `box` or `ball`.
        size: Full sizes of the box, or three times the diameter [m].
        mass: Of the thing [kg].
        text: The scenario.
    """

    number: int
    kind: str
    shape: str
    size: tuple[float, float, float]
    mass: float
    text: str


def trial(number: int) -> Trial:
    """The run with a number, the same every time."""
    rng = np.random.default_rng(number)
    kind = KINDS[number % len(KINDS)]
    shape = str(rng.choice(["box", "ball"]))
    size = tuple(round(float(x), 4) for x in rng.uniform(0.02, 0.06, 3))
    size = size if shape == "box" else (size[0],) * 3
    mass = round(float(rng.uniform(0.02, 0.4)), 3)
    friction = round(float(rng.uniform(0.15, 1.2)), 2)
    x = -0.2 if rng.random() < 0.3 else 0.0
    rest = (BIN_FLOOR if x else 0.0) + size[2] / 2
    geometry = (
        f"box: {{size: {list(size)}}}" if shape == "box" else f"sphere: {{radius: {size[0] / 2}}}"
    )
    boards = [f"{{box: {{size: {list(a)}}}, pose: {{xyz: {list(b)}}}}}" for a, b in BOARDS]
    take = {"pick": _pick, "push": _push, "drop": _drop}
    steps = _throw(rng, x, size[1]) if kind == "throw" else take[kind](rng, x, rest)
    text = (
        f"scenario: second opinion {number}\n"
        "robot: {urdf: gantry.urdf, srdf: gantry.srdf, gripper: hand,"
        " start_state: {named_target: ready}}\nworld: empty\n"
        "objects:\n"
        f"  - {{name: wall, in: simulation, static: true, box: {{size: {list(WALL['size'])}}},"
        f" pose: {{xyz: {list(WALL['at'])}}}}}\n"
        f"  - {{name: bin, in: simulation, static: true, pose: {{xyz: {list(BIN)}}},"
        f" shapes: [{', '.join(boards)}]}}\n"
        f"  - {{name: thing, in: simulation, {geometry}, mass: {mass}, friction: {friction},"
        f" pose: {{xyz: [{x}, 0, {rest + 2e-4:.5f}]}}}}\n"
        "planning: {max_velocity_scaling_factor: 1, max_acceleration_scaling_factor: 1}\n"
        "steps:\n" + "".join(f"  - {step}\n" for step in steps) + "expect:\n"
        + "".join(f"  - {each}\n" for each in EXPECTATIONS.values())
    )  # fmt: skip
    return Trial(number, kind, shape, size, mass, text)


def _go(slide: float, lift: float) -> str:
    return f"ptp: {{joints: {{slide: {slide:.4f}, lift: {lift:.4f}}}}}"


def _close(rng: np.random.Generator) -> str:
    return f"gripper: {{position: 0.0, max_effort: {rng.uniform(1, 40):.1f}}}"


def _grip_height(rng: np.random.Generator, rest: float) -> float:
    """Height of the palm at which the tips reach below the thing's middle, mostly."""
    return max(rest + TIPS - rng.uniform(-0.004, 0.015), TIPS + 0.002)


def _taken(rng: np.random.Generator, x: float, rest: float) -> list[str]:
    above = x + rng.uniform(-0.008, 0.008)
    low = _grip_height(rng, rest)
    return [_go(above, 0.25), "gripper: open", _go(above, low), _close(rng)]


def _pick(rng: np.random.Generator, x: float, rest: float) -> list[str]:
    steps = _taken(rng, x, rest)
    high = rng.uniform(0.1, 0.35)
    steps.append(_go(x, high))
    where = rng.choice([x, 0.1, 0.2, 0.27])
    if rng.random() < 0.6:
        steps.append(_go(where, high))
    if rng.random() < 0.5:
        steps += [_go(where, TIPS + rest + 0.002), "gripper: open", _go(where, 0.3)]
    return [*steps, "wait: 0.4 s"]


def _push(rng: np.random.Generator, x: float, rest: float) -> list[str]:
    side = rng.choice([-1, 1])
    low = max(TIPS + 0.005, rest + TIPS - 0.01)
    far = rng.uniform(0.02, 0.2)
    start = x - side * 0.12
    return ["gripper: close", _go(start, 0.3), _go(start, low),
            _go(start + side * (0.08 + far), low), "wait: 0.4 s"]  # fmt: skip


def _drop(rng: np.random.Generator, x: float, rest: float) -> list[str]:
    where = rng.choice([-0.2, 0.0, 0.15])
    high = rng.uniform(0.12, 0.4)
    return [*_taken(rng, x, rest), _go(x, high), _go(where, high), "gripper: open", "wait: 0.6 s"]


def _throw(rng: np.random.Generator, x: float, width: float) -> list[str]:
    opening = rng.uniform(0.3, 1.3) * width / 2
    high = rng.uniform(0.1, 0.3)
    force = [rng.uniform(-3, 3), rng.uniform(-1, 1), rng.uniform(5, 60)]
    push = f"inject: {{push: {{thing: {[round(f, 2) for f in force]}}}, push_duration: 30 ms}}"
    after = _close(rng) if rng.random() < 0.4 else "wait: 0.3 s"
    return [_go(x, high), f"gripper: {{position: {min(opening, 0.04):.4f}}}", push, after,
            "wait: 0.6 s"]  # fmt: skip
